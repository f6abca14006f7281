//! Scenes that begin with the grains of another run, and groups that never move.

use crate::common::Folder;
use amberfield_core::{ContactRules, GroupId, Material, MaterialId, Particles, Vector3};
use amberfield_scene::{Purpose, SavedGrains, Scene, parse_scene, write_checkpoint};
use std::path::Path;

/// Grains of the other run: its materials stand in another order, with one that this scene does not have.
fn saved(scene: &Scene) -> SavedGrains {
    let named = |name: &str| Material { name: name.into(), ..scene.materials[0].clone() };
    let material = [1, 1, 0].map(MaterialId).to_vec();
    let particles = Particles {
        velocity: vec![Vector3::new(0.1, -0.2, 0.3); 3],
        angular_velocity: vec![Vector3::new(4.0, 5.0, 6.0); 3],
        density: vec![1234.0; 3],
        material,
        // What never moved in that run.
        fixed_groups: vec![GroupId(2)],
        ..scene.particles.clone()
    };
    let rules =
        ContactRules { materials: ["steel", "glass", "sand"].map(named).to_vec(), ..ContactRules::default() };
    SavedGrains { particles, groups: scene.groups.clone(), rules }
}

fn write(scene: &Scene, grains: &SavedGrains, path: &Path) {
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    write_checkpoint(path, scene.physics(), grains, &"a state").unwrap();
}

/// Folder with a scene that begins with the grains of `runs/filled`, which the good scene wrote, and with its
/// grains.
fn begun() -> (Folder, SavedGrains) {
    let folder = Folder::good();
    let scene = folder.read(&[]).unwrap();
    let grains = saved(&scene);
    write(&scene, &grains, &folder.file("runs/filled/checkpoints/step_000000000100.amber"));
    let text = crate::common::SCENE.replace("file = \"grains.csv\"", "from = \"runs/filled\"");
    folder.write("scene.toml", text);
    (folder, grains)
}

#[test]
fn grains_are_those_of_the_checkpoint_with_materials_by_name() {
    let (folder, grains) = begun();
    let scene = folder.read(&[]).unwrap();
    let expected = Particles {
        material: [0, 0, 1].map(MaterialId).to_vec(),
        fixed_groups: Vec::new(),
        ..grains.particles
    };
    assert_eq!(scene.particles, expected);
    assert_eq!(scene.groups, ["all", "fine", "coarse"]);
    let filled = scene.filled.unwrap();
    assert_eq!(filled.rules, grains.rules);
    assert!(filled.is_same);
    assert!(filled.checkpoint.ends_with("runs/filled/checkpoints/step_000000000100.amber"));
}

#[test]
fn folders_stand_for_their_newest_checkpoint_and_the_scene_of_the_run_names_it() {
    let (folder, mut grains) = begun();
    let first = folder.read(&[]).unwrap();
    // A longer run has been continued since.
    grains.particles.charge[0] = 5e-14;
    write(&first, &grains, &folder.file("runs/filled/checkpoints/step_000000000200.amber"));
    for from in ["runs/filled", "runs/filled/checkpoints"] {
        let scene = folder.read(&[&format!("particles.from={from}")]).unwrap();
        assert_eq!(scene.particles.charge[0], 5e-14, "{from}");
        let changes = scene.physics().changes_since(first.physics());
        assert_eq!(changes, [format!("{from} has other contents")]);
    }
    // The resolved scene still is the first one, from anywhere.
    let elsewhere = tempfile::tempdir().unwrap();
    let again = parse_scene(first.resolved(), "scene.toml", elsewhere.path(), &[], Purpose::Run).unwrap();
    assert_eq!(again.particles, first.particles);
    assert!(again.physics().changes_since(first.physics()).is_empty());
}

#[test]
fn scenes_differ_in_more_than_their_grains_or_do_not() {
    let (folder, _) = begun();
    let is_same = |overrides: &[&str]| folder.read(overrides).unwrap().filled.unwrap().is_same;
    assert!(is_same(&["time.end_s=0.5", "particles.allow_overlap=true", "output.formats=[\"csv\"]"]));
    for change in [
        "time.gravity_m_s2=[0,0,-1]",
        "materials[0].restitution=0.7",
        "particles.fixed_groups=[\"fine\"]",
        "walls[1].scale=2e-3",
        "walls[0].motion=[{ vibrate = { amplitude_m = [0,0,1e-4], frequency_Hz = 50 } }]",
    ] {
        assert!(!is_same(&[change]), "{change}");
    }
    let plate = crate::common::PLATE.replace("20 0 1", "21 0 1");
    folder.write("plate.stl", plate);
    assert!(!is_same(&[]), "other contents of a wall");
}

#[test]
fn bad_origins_are_refused_with_advice() {
    let (folder, grains) = begun();
    let scene = folder.read(&[]).unwrap();
    let bytes = std::fs::read(folder.file("runs/filled/checkpoints/step_000000000100.amber")).unwrap();
    folder.write("cut.amber", &bytes[..bytes.len() / 2]);
    let mut other = bytes.clone();
    other[8] = 4;
    folder.write("format.amber", &other);
    let mut damaged = bytes;
    damaged[60] ^= 1;
    folder.write("damaged.amber", &damaged);
    folder.write("empty.amber", "");
    let sand = Particles { material: [1, 2, 0].map(MaterialId).to_vec(), ..grains.particles.clone() };
    write(&scene, &SavedGrains { particles: sand, ..grains.clone() }, &folder.file("sand.amber"));
    let none = SavedGrains { particles: Particles::default(), ..grains.clone() };
    write(&scene, &none, &folder.file("none.amber"));
    let short = Particles { charge: vec![0.0], ..grains.particles.clone() };
    write(&scene, &SavedGrains { particles: short, ..grains }, &folder.file("short.amber"));
    for (overrides, words) in [
        (&["particles.from=grains.csv"][..], &["particles.from = \"grains.csv\"", "not a checkpoint"][..]),
        (&["particles.from=cut.amber"], &["cut.amber", "cut short"]),
        (&["particles.from=damaged.amber"], &["damaged.amber", "take an earlier checkpoint"]),
        (&["particles.from=empty.amber"], &["empty.amber is empty"]),
        (&["particles.from=format.amber"], &["has format 4, this version reads "]),
        (&["particles.from=nowhere.amber"], &["there is no file nowhere.amber"]),
        (&["particles.from=runs"], &["runs has no checkpoints/*.amber; name a run folder"]),
        (&["particles.from=none.amber"], &["has no grains"]),
        (&["particles.from=short.amber"], &["do not fit together"]),
        (&["particles.from=sand.amber"], &["sand.amber: grain 2 is of \"sand\"", "[[materials]]"]),
        (&["particles.file=grains.csv"], &["particles.from", "file is given too", "exactly one"]),
        (
            &["particles.generate={ count = 1, radius_m = 1e-4, material = \"glass\" }"],
            &["particles.from", "generate is given too"],
        ),
        (&["particles.units=si"], &["particles.units", "leave it out"]),
        (
            &["domain.max_m=[0.0025, 0.02, 0.04]"],
            &["1 grain(s) lie outside the domain", "grain 7 at (0.003, 0.001, 0.001) m", "enlarge"],
        ),
    ] {
        let said = folder.refusal(overrides);
        for word in words {
            assert!(said.contains(word), "{overrides:?}: no {word:?} in {said}");
        }
    }
}

#[test]
fn groups_that_never_move_are_named() {
    let folder = Folder::good();
    let fixed = |overrides: &[&str]| folder.read(overrides).unwrap().particles.fixed_groups;
    assert_eq!(fixed(&[]), []);
    assert_eq!(fixed(&["particles.fixed_groups=[\"coarse\"]"]), [GroupId(2)]);
    assert_eq!(fixed(&["particles.fixed_groups=[\"fine\", \"coarse\"]"]), [GroupId(1), GroupId(2)]);
    assert_eq!(fixed(&["particles.fixed_groups=[\"all\"]"]), [0, 1, 2].map(GroupId));
    let said = folder.refusal(&["particles.fixed_groups=[\"coars\"]"]);
    for word in
        ["particles.fixed_groups", "no grain is in the group \"coars\"", "nearest group is \"coarse\""]
    {
        assert!(said.contains(word), "no {word:?} in {said}");
    }
    // Another set of groups is other physics.
    let [free, bound] =
        [&[][..], &["particles.fixed_groups=[\"coarse\"]"]].map(|overrides| folder.read(overrides).unwrap());
    assert_eq!(bound.physics().changes_since(free.physics()).len(), 1);
}

#[test]
fn fixed_grains_have_no_velocity_and_come_from_no_feed() {
    let folder = Folder::good();
    folder.write(
        "grains.csv",
        "id,x_m,y_m,z_m,radius_m,charge_C,material,group,vx_m_s\n\
         1,0.001,0.001,0.001,1e-4,1e-14,glass,fine,0.1\n\
         2,0.002,0.001,0.001,1e-4,-1e-14,glass,bed,0\n",
    );
    assert!(folder.read(&["particles.fixed_groups=[\"bed\"]"]).is_ok());
    let said = folder.refusal(&["particles.fixed_groups=[\"fine\", \"bed\"]"]);
    assert!(said.contains("grain 1 of group \"fine\" has a velocity"), "{said}");
    // Grains that were filled come to rest.
    let (folder, grains) = begun();
    let particles = folder.read(&["particles.fixed_groups=[\"fine\"]"]).unwrap().particles;
    assert_eq!((particles.velocity[0], particles.angular_velocity[0]), (Vector3::zeros(), Vector3::zeros()));
    assert_eq!(particles.velocity[1..], grains.particles.velocity[1..]);
    let region = "{ box = { min_m = [0.01, 0.01, 0.02], max_m = [0.015, 0.015, 0.03] } }";
    let feed = format!(
        "feeds=[{{ name = \"f\", region = {region}, rate_per_s = 100, radius_m = 1e-4, material = \"glass\", \
         velocity_m_s = [0, 0, -1]"
    );
    let bound = format!("{feed}, group = \"fine\" }}]");
    let said = folder.refusal(&["particles.fixed_groups=[\"fine\"]", &bound]);
    assert!(said.contains("feeds[0].group") && said.contains("never move"), "{said}");
    assert!(folder.read(&["particles.fixed_groups=[\"coarse\"]", &bound]).is_ok());
    let said = folder.refusal(&["particles.fixed_groups=[\"all\"]", &format!("{feed} }}]")]);
    assert!(said.contains("feeds[0].group") && said.contains("never move"), "{said}");
}
