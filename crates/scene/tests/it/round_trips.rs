//! Snapshots written in one form and read back: the numbers are the same, bit for bit in SI units.

use crate::common::Folder;
use amberfield_core::{Grain, GroupId, MaterialId, Vector3};
use amberfield_scene::{Snapshot, SnapshotBox, SnapshotOptions, Units, write_snapshot};

/// Relative error of a factor and its inverse.
const ROUND_OFF: f64 = 4e-16;

/// Snapshot whose numbers use all digits.
fn snapshot() -> Snapshot {
    let grain = |index: u64| {
        let number = index as f64 / 3.0;
        Grain {
            id: 9 - index,
            position: Vector3::new(1e-3 + 1e-3 * number, 2e-3 * number.exp(), 0.01 / 7.0),
            velocity: Vector3::new(-0.1 * number, 1.0 / 3.0, -2e-30),
            angular_velocity: Vector3::new(number.sqrt(), 100.0 / 3.0, -0.0),
            radius: 1e-4 / (1.0 + number),
            density: 2500.0 * (1.0 + number / 7.0),
            charge: (number - 0.5) * 1e-13,
            material: MaterialId(u16::from(index == 1)),
            group: GroupId(u16::try_from(index % 3).unwrap()),
        }
    };
    let mut snapshot = Snapshot::of((0..5).map(grain).collect());
    snapshot.materials = vec!["soda lime".to_owned(), "stahl, \"weiß\"".to_owned()];
    snapshot.groups = ["all", "fine", "coarse"].map(ToOwned::to_owned).to_vec();
    snapshot.step = Some(1200);
    snapshot.time_s = Some(0.1 / 3.0);
    snapshot.bounds = Some(SnapshotBox {
        min_m: Vector3::new(-0.01 / 3.0, 0.0, 0.0),
        max_m: Vector3::repeat(0.1 / 3.0),
        is_periodic: [true, false, true],
    });
    snapshot
}

fn write_and_read(folder: &Folder, name: &str, snapshot: &Snapshot, units: Units) -> Snapshot {
    let path = folder.file(name);
    write_snapshot(&path, snapshot, units).unwrap_or_else(|error| panic!("{error}"));
    Snapshot::read(&path, &SnapshotOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// Numbers of all grains.
fn numbers(snapshot: &Snapshot) -> Vec<f64> {
    let grains = snapshot.particles();
    let vectors = [&grains.position, &grains.velocity, &grains.angular_velocity].into_iter().flatten();
    let scalars = [&grains.radius, &grains.density, &grains.charge].into_iter().flatten();
    vectors.flatten().chain(scalars).copied().collect()
}

fn bits(snapshot: &Snapshot) -> Vec<u64> {
    numbers(snapshot).into_iter().map(f64::to_bits).collect()
}

#[test]
fn every_form_gives_back_every_number_of_every_other() {
    let (folder, start) = (Folder::good(), snapshot());
    let forms = ["a.csv", "a.vtu", "a.dump"];
    for first in forms {
        let once = write_and_read(&folder, first, &start, Units::Si);
        for second in forms {
            let twice = write_and_read(&folder, second, &once, Units::Si);
            assert_eq!(bits(&twice), bits(&start), "{first} {second}");
            assert_eq!(twice.ids(), start.ids(), "{first} {second}");
            assert_eq!(twice.material_ids(), start.material_ids(), "{first} {second}");
            if first != "a.dump" && second != "a.dump" {
                assert_eq!(
                    (&twice.materials, &twice.groups),
                    (&start.materials, &start.groups),
                    "{first} {second}"
                );
                assert_eq!(twice.group_ids(), start.group_ids(), "{first} {second}");
            }
        }
    }
    let dump = write_and_read(&folder, "a.lammpstrj", &start, Units::Si);
    assert_eq!((dump.step, dump.time_s, dump.bounds), (start.step, start.time_s, start.bounds));
}

#[test]
fn units_of_a_dump_do_not_matter() {
    let (folder, start) = (Folder::good(), snapshot());
    for units in Units::ALL {
        let read = write_and_read(&folder, "a.dump", &start, units);
        for (found, expected) in numbers(&read).into_iter().zip(numbers(&start)) {
            assert!((found - expected).abs() <= ROUND_OFF * expected.abs(), "{units:?}: {found} {expected}");
        }
    }
}

#[test]
fn what_a_snapshot_lacks_is_left_out() {
    let folder = Folder::good();
    folder.write("few.csv", "id,x_m,y_m,z_m,radius_m\n4,1,2,3,0.5\n2,-1,0,0,0.25\n");
    let few = Snapshot::read(&folder.file("few.csv"), &SnapshotOptions::default()).unwrap();
    for name in ["a.csv", "a.vtu", "a.dump"] {
        let read = write_and_read(&folder, name, &few, Units::Si);
        assert_eq!(read.radii_m(), few.radii_m(), "{name}");
        assert_eq!((read.charges_c(), read.densities_kg_m3()), (None, None), "{name}");
        assert_eq!((read.velocities_m_s(), read.angular_velocities_rad_s()), (None, None), "{name}");
    }
    let dump = write_and_read(&folder, "a.dump", &few, Units::Si);
    let bounds = dump.bounds.unwrap();
    assert_eq!(
        (bounds.min_m, bounds.max_m),
        (Vector3::new(-1.25, -0.25, -0.25), Vector3::new(1.5, 2.5, 3.5))
    );
    let refused = |name: &str, snapshot: &Snapshot, units: Units| {
        write_snapshot(&folder.file(name), snapshot, units).unwrap_err().to_string()
    };
    assert!(refused("a.data", &few, Units::Si).contains("needs radii and densities or masses"));
    assert!(refused("a.csv", &few, Units::Micro).contains("is in SI units, not micro"));
    assert!(refused("a.txt", &few, Units::Si).contains("name a file .csv (table), .vtu"));
    assert!(refused("a", &few, Units::Si).contains("its ending says no form"));
}

#[test]
fn data_files_have_what_lammps_reads() {
    let (folder, start) = (Folder::good(), snapshot());
    write_snapshot(&folder.file("a.data"), &start, Units::Cgs).unwrap();
    let text = std::fs::read_to_string(folder.file("a.data")).unwrap();
    assert!(text.contains("\n5 atoms\n2 atom types\n"), "{text}");
    let rows = |section: &str| -> Vec<Vec<f64>> {
        let (_, rows) = text.split_once(section).unwrap();
        let rows = rows.trim_start().lines().take_while(|line| !line.is_empty());
        rows.map(|line| line.split(' ').map(|word| word.parse().unwrap()).collect()).collect()
    };
    let (atoms, velocities, grains) = (rows("Atoms # hybrid\n"), rows("Velocities\n"), start.particles());
    for (index, atom) in atoms.iter().enumerate() {
        let grain = grains.grain(index);
        let diameter_density_charge =
            [200.0 * grain.radius, 1e-3 * grain.density, 2_997_924_580.0 * grain.charge];
        assert_eq!((atom[0], atom[1]), (grain.id as f64, f64::from(grain.material.0) + 1.0));
        for (found, expected) in atom[5..].iter().zip(diameter_density_charge) {
            assert!((found - expected).abs() <= ROUND_OFF * expected.abs(), "{found} {expected}");
        }
        assert_eq!(velocities[index][0], grain.id as f64);
        assert_eq!(velocities[index][5], grain.angular_velocity.y);
    }
    let mut other = start.clone().into_particles();
    other.id[2] = 0;
    let refused = write_snapshot(&folder.file("a.data"), &Snapshot::of(other), Units::Si).unwrap_err();
    assert!(refused.to_string().contains("ids from 1 to 2147483647, and a grain has 0"), "{refused}");
}
