//! Robustness: any bytes have an answer, never a panic, and settings survive being written out.

use crate::common::{Folder, GRAINS, PLATE, SCENE};
use amberfield_core::{CouplingInterval, ForceLimit, Method, Permittivity, Tuning};
use amberfield_scene::{
    ElectricFieldSettings, Physics, Purpose, SavedGrains, parse_scene, read_checkpoint, write_checkpoint,
};
use nalgebra::Vector3;
use proptest::prelude::*;
use proptest::sample::Index;

/// Change of one byte.
#[derive(Clone, Debug)]
struct Change {
    /// Place of the byte.
    place: Index,
    /// Kind: 0 replaces, 1 removes, 2 inserts, 3 cuts the rest off.
    kind: u8,
    /// New byte.
    byte: u8,
}

/// Replaces, removes and inserts bytes, and cuts the rest off.
fn mutate(text: &str, changes: &[Change]) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    for Change { place, kind, byte } in changes {
        let at = place.index(bytes.len());
        match kind {
            0 => bytes[at] = *byte,
            1 => drop(bytes.remove(at)),
            2 => bytes.insert(at, *byte),
            _ => bytes.truncate(at.max(1)),
        }
        if bytes.is_empty() {
            bytes.push(b' ');
        }
    }
    bytes
}

fn changes() -> impl Strategy<Value = Vec<Change>> {
    // Most bytes are printable, since they get further than others, and few changes cut the rest off.
    prop::collection::vec((any::<Index>(), 0..12_u8, prop_oneof![4 => 32..127_u8, 1 => any::<u8>()]), 1..6)
        .prop_map(|list| {
            list.into_iter()
                .map(|(place, kind, byte)| Change {
                    place,
                    kind: if kind == 11 { 3 } else { kind % 3 },
                    byte,
                })
                .collect()
        })
}

fn settings() -> impl Strategy<Value = ElectricFieldSettings> {
    let field = (
        prop::sample::select(Method::ALL.to_vec()),
        1e-12..=1.0_f64,
        prop::option::of(1e-9..1e3_f64),
        1.0..1e3_f64,
        prop::array::uniform3(prop_oneof![Just(0.0), -1e6..1e6_f64]),
        prop::option::of(prop::array::uniform3(1..280_usize)),
        prop::option::of(1..u32::MAX),
    );
    let more = (
        any::<[bool; 7]>(),
        1e-9..1e-3_f64,
        0.0..=1.0_f64,
        prop::option::of(1e-12..=1.0_f64),
        "[a-z][a-z0-9_ \"]{0,8}",
    );
    (field, more).prop_map(|(field, more)| {
        let mut settings = ElectricFieldSettings::default();
        let (method, tolerance, radius, permittivity, external, cells, steps) = field;
        let ([uncoupled, transfer, limit, overlap, background, model, plain], cutoff, factor, far, id) = more;
        settings.field.method = method;
        settings.field.tolerance = tolerance;
        let needed = matches!(method, Method::Kolehmainen | Method::Cutoff);
        settings.field.cutoff_radius_m = radius.or(needed.then_some(1e-3));
        settings.field.permittivity = Permittivity::from_relative(permittivity);
        settings.use_without_cfd_coupling = uncoupled;
        settings.enable_collision_charge_transfer = transfer;
        settings.limit_field_force = limit;
        settings.field_force_limit_factor = factor;
        settings.field.force_limit = limit.then_some(ForceLimit { factor });
        settings.charge_transfer_cutoff_m = cutoff;
        settings.id = id;
        if !plain {
            settings.field.external_field_v_m = Vector3::from(external);
            settings.field.grid_cells = cells;
            settings.field.coupling_interval = steps.map_or(CouplingInterval::Auto, CouplingInterval::Steps);
            settings.field.neutralising_background = background;
            settings.field.tuning = if model { Tuning::Model } else { Tuning::Timed };
            settings.field.overlap = overlap;
            settings.far_tolerance = far;
        }
        settings
    })
}

/// Settings that a scene around a section has.
fn parse(section: &str) -> ElectricFieldSettings {
    let text = format!(
        "{section}\n\
         [domain]\nmin_m = [0, 0, 0]\nmax_m = [1, 1, 1]\n\
         boundary = {{ x = 'open', y = 'open', z = 'open' }}\n\
         [particles.generate]\ncount = 1\nradius_m = 0.1\ncharge_C = 0\n\
         [[materials]]\nname = 'a'\ndensity_kg_m3 = 1\nyoung_Pa = 1\n\
         poisson = 0\nrestitution = 1\nfriction = 0\n\
         work_function_eV = 1\n\
         [solver]\nopenfoam_case = '.'\n",
    );
    let scene = parse_scene(&text, "s.toml", std::path::Path::new("."), &[], Purpose::Explain);
    scene.unwrap_or_else(|error| panic!("{error}\n{text}")).electric_field.unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn settings_survive_both_forms(settings in settings()) {
        prop_assert_eq!(&parse(&settings.as_section()), &settings);
        if let Ok(line) = settings.as_command() {
            prop_assert_eq!(&parse(&line), &settings);
        }
    }

    #[test]
    fn random_bytes_are_answered(bytes in prop::collection::vec(any::<u8>(), 0..300), which in 0..3_usize) {
        let folder = Folder::good();
        folder.write(["scene.toml", "grains.csv", "plate.stl"][which], &bytes);
        prop_assert!(folder.read(&[]).is_err());
    }

    #[test]
    fn mutated_scenes_are_answered(changes in changes()) {
        let folder = Folder::good();
        folder.write("scene.toml", mutate(SCENE, &changes));
        if let Err(error) = folder.read(&[]) {
            let message = error.to_string();
            prop_assert!(message.contains("scene.toml") || message.contains("grains.csv"), "{message}");
        }
    }

    #[test]
    fn mutated_grains_are_answered(changes in changes()) {
        let folder = Folder::good();
        folder.write("grains.csv", mutate(GRAINS, &changes));
        if let Ok(scene) = folder.read(&[]) {
            let finite = scene.particles.position.iter().flatten().all(|number| number.is_finite());
            prop_assert!(finite && scene.particles.radius.iter().all(|radius| *radius > 0.0));
        }
    }

    #[test]
    fn mutated_surfaces_are_answered(changes in changes(), binary in any::<bool>()) {
        let folder = Folder::good();
        let text = if binary { PLATE.replacen("solid", "salad", 1) } else { PLATE.to_owned() };
        folder.write("plate.stl", mutate(&text, &changes));
        let _ = folder.read(&[]);
    }

    #[test]
    fn any_override_is_answered(key in "[a-z_.0-9]{0,20}", value in "\\PC{0,20}") {
        let _ = Folder::good().read(&[&format!("{key}={value}")]);
    }

    #[test]
    fn damaged_checkpoints_are_answered(
        changes in changes(),
        bytes in prop::collection::vec(any::<u8>(), 0..100),
    ) {
        let folder = Folder::good();
        let path = folder.file("a.amber");
        write_checkpoint(&path, &Physics::default(), &SavedGrains::default(), &vec![1.0_f64; 20]).unwrap();
        let good = std::fs::read(&path).unwrap();
        let mut damaged = good.clone();
        for Change { place, byte, .. } in &changes {
            let at = place.index(damaged.len());
            damaged[at] = *byte;
        }
        std::fs::write(&path, &damaged).unwrap();
        prop_assert_eq!(read_checkpoint::<Vec<f64>>(&path, &Physics::default()).is_ok(), damaged == good);
        std::fs::write(&path, &bytes).unwrap();
        prop_assert!(read_checkpoint::<Vec<f64>>(&path, &Physics::default()).is_err());
    }
}
