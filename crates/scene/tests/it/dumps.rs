//! Dumps of LAMMPS and LIGGGHTS: whatever form they have, the grains are the same.

use crate::common::Folder;
use crate::dialects::gzip;
use amberfield_core::{Particles, Vector3};
use amberfield_scene::{Purpose, Snapshot, SnapshotOptions, Units};

/// Rounding of a few factors, and of a place that was scaled with a box.
const ROUND_OFF: f64 = 1e-12;

/// Dump of two frames in SI units, of the form that LAMMPS writes.
const DUMP: &str = "ITEM: UNITS\nsi\nITEM: TIME\n0\nITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\n\
    ITEM: BOX BOUNDS pp pp ff\n0 2e-2\n0 2e-2\n0 4e-2\n\
    ITEM: ATOMS id type x y z\n9 1 0.001 0.001 0.001\n\
    ITEM: TIME\n0.5\nITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n3\n\
    ITEM: BOX BOUNDS pp pp ff\n0.0000000000000000e+00 2.0000000000000000e-02\n0 2e-2\n0 4e-2\n\
    ITEM: ATOMS id type x y z ix iy iz vx vy vz fx omegax omegay omegaz radius mass q\n\
    1 1 0.001 0.002 0.003 0 0 0 0.1 0.2 0.3 7 1 2 3 0.0002 1e-7 -2e-12 \n\
    3 2 0.004 0.005 0.006 0 1 0 -0.1 -0.2 -0.3 7 -1 -2 -3 0.00025 2e-7 3e-12 \n\
    2 1 0.007 0.008 0.030 0 0 0 0 0 0 7 0 0 0 0.0002 1e-7 0 \n";

/// Key with which the scene reads types.
const TYPES: &str = "particles.materials_by_type=['glass', 'steel']";

fn read(folder: &Folder, dump: impl AsRef<[u8]>, overrides: &[&str]) -> Particles {
    folder.write("grains.dump", dump);
    let overrides = [&["particles.file=grains.dump", TYPES], overrides].concat();
    folder.read(&overrides).unwrap_or_else(|error| panic!("{error}")).particles
}

fn refusal(folder: &Folder, dump: &str, overrides: &[&str]) -> String {
    folder.write("grains.dump", dump);
    folder.refusal(&[&["particles.file=grains.dump"], overrides].concat())
}

fn assert_close(found: &Particles, expected: &Particles, what: &str) {
    assert_eq!(found.id, expected.id, "{what}");
    assert_eq!(found.material, expected.material, "{what}");
    let numbers = |grains: &Particles| {
        let vectors = [&grains.position, &grains.velocity, &grains.angular_velocity].into_iter();
        let vectors = vectors.flat_map(|list| list.iter().flatten().copied().collect::<Vec<_>>());
        let scalars = [&grains.radius, &grains.density, &grains.charge].into_iter().flatten().copied();
        vectors.chain(scalars).collect::<Vec<f64>>()
    };
    for (index, (found, expected)) in numbers(found).into_iter().zip(numbers(expected)).enumerate() {
        let error = (found - expected).abs();
        assert!(error <= ROUND_OFF * expected.abs().max(1e-20), "{what}: number {index}: {found} {expected}");
    }
}

/// Dump with changed columns: each row of numbers is given by a function of its cells.
fn changed(columns: &str, row: impl Fn(&[f64]) -> Vec<f64>) -> String {
    let (before, last) = DUMP.rsplit_once("ITEM: ATOMS").unwrap();
    let rows = last.lines().skip(1).map(|line| {
        let cells: Vec<f64> = line.split_whitespace().map(|cell| cell.parse().unwrap()).collect();
        let cells: Vec<String> = row(&cells).into_iter().map(|number| format!("{number}")).collect();
        cells.join(" ") + "\n"
    });
    format!("{before}ITEM: ATOMS {columns}\n{}", rows.collect::<String>())
}

#[test]
fn the_last_frame_is_read_with_all_that_a_grain_has() {
    let folder = Folder::good();
    let grains = read(&folder, DUMP, &[]);
    assert_eq!(grains.id, [1, 3, 2]);
    assert_eq!(grains.position[1], Vector3::new(0.004, 0.005, 0.006));
    assert_eq!(grains.velocity[1], Vector3::new(-0.1, -0.2, -0.3));
    assert_eq!(grains.angular_velocity[0], Vector3::new(1.0, 2.0, 3.0));
    assert_eq!(grains.charge, [-2e-12, 3e-12, 0.0]);
    assert_eq!(grains.radius, [2e-4, 2.5e-4, 2e-4]);
    assert_eq!(grains.material.iter().map(|material| material.0).collect::<Vec<_>>(), [0, 1, 0]);
    let mass = 4.0 / 3.0 * std::f64::consts::PI * 2.5e-4_f64.powi(3) * grains.density[1];
    assert!((mass / 2e-7 - 1.0).abs() < ROUND_OFF, "{mass}");
}

#[test]
fn the_form_of_a_dump_does_not_matter() {
    let folder = Folder::good();
    let plain = read(&folder, DUMP, &[]);
    let all = |c: &[f64], place: [f64; 3]| {
        vec![
            c[17],
            place[0],
            place[1],
            place[2],
            2.0 * c[15],
            c[16],
            c[0],
            c[1],
            c[8],
            c[9],
            c[10],
            c[12],
            c[13],
            c[14],
        ]
    };
    let names = |place: &str| format!("q {place} diameter mass id type vx vy vz omegax omegay omegaz");
    let scaled = |c: &[f64]| [c[2] / 0.02, c[3] / 0.02, c[4] / 0.04];
    let dumps = [
        ("order and diameter", changed(&names("x y z"), |c| all(c, [c[2], c[3], c[4]]))),
        ("scaled", changed(&names("xs ys zs"), |c| all(c, scaled(c)))),
        ("unwrapped", changed(&names("xu yu zu"), |c| all(c, [c[2] + 0.04, c[3] - 0.02, c[4]]))),
        (
            "scaled, unwrapped",
            changed(&names("xsu ysu zsu"), |c| {
                let [x, y, z] = scaled(c);
                all(c, [x - 3.0, y + 1.0, z])
            }),
        ),
        (
            "names twice",
            DUMP.replace("id type x", "id id type type x")
                .replace("\n1 1 ", "\n1 1 1 1 ")
                .replace("\n3 2 ", "\n3 3 2 2 ")
                .replace("\n2 1 0.007", "\n2 2 1 1 0.007")
                .replace("9 1", "9 9 1 1"),
        ),
        ("both places", DUMP.replace("fx", "xu")),
        ("line ends", DUMP.replace('\n', "\r\n")),
        ("a box without tilt", DUMP.replace("BOUNDS pp", "BOUNDS xy xz yz pp").replace("e-2\n", "e-2 0\n")),
        ("a further section", DUMP.replace("ITEM: TIME\n", "ITEM: LABEL\na\nb\nITEM: TIME\n")),
        ("old, without flags", DUMP.replace(" pp pp ff", "")),
    ];
    for (name, dump) in dumps {
        assert_close(&read(&folder, dump, &[]), &plain, name);
    }
    assert_eq!(read(&folder, gzip(DUMP.as_bytes()), &[]), plain);
    assert_eq!(read(&folder, DUMP, &["particles.step=100", "particles.units=si"]), plain);
    let doubled = format!("{DUMP}{}", &DUMP[DUMP.find("ITEM: TIME\n0\n").unwrap()..]);
    assert_eq!(read(&folder, doubled, &[]), plain);
}

#[test]
fn units_do_not_matter() {
    let folder = Folder::good();
    let plain = read(&folder, DUMP, &[]);
    // Metre, second, kilogram and coulomb in units of each style, by the manual of LAMMPS and CODATA 2018.
    let styles = [
        ("si", [1.0, 1.0, 1.0, 1.0, 1.0]),
        ("cgs", [1e2, 1.0, 1e3, 2_997_924_580.0, 1e2]),
        ("micro", [1e6, 1e6, 1e15, 1e12, 1.0]),
        ("nano", [1e9, 1e9, 1e21, 1.0 / 1.602_176_634e-19, 1.0]),
        ("real", [1e10, 1e15, 6.022_140_76e26, 1.0 / 1.602_176_634e-19, 1e-5]),
        ("metal", [1e10, 1e12, 6.022_140_76e26, 1.0 / 1.602_176_634e-19, 1e-2]),
    ];
    for (style, [metre, second, kilogram, coulomb, speed]) in styles {
        let names = "id type x y z ix iy iz vx vy vz fx omegax omegay omegaz radius mass q";
        let dump = changed(names, |c| {
            let factors = [
                1.0,
                1.0,
                metre,
                metre,
                metre,
                1.0,
                1.0,
                1.0,
                speed,
                speed,
                speed,
                1.0,
                1.0 / second,
                1.0 / second,
                1.0 / second,
                metre,
                kilogram,
                coulomb,
            ];
            c.iter().zip(factors).map(|(cell, factor)| cell * factor).collect()
        });
        let length = |metres: f64| format!("{:e}", metres * metre);
        let dump =
            dump.replace("0.0000000000000000e+00 2.0000000000000000e-02", &format!("0 {}", length(2e-2)));
        let dump = dump
            .replace("0 2e-2", &format!("0 {}", length(2e-2)))
            .replace("0 4e-2", &format!("0 {}", length(4e-2)));
        let named = dump.replace("UNITS\nsi", &format!("UNITS\n{style}"));
        assert_close(&read(&folder, named, &[]), &plain, style);
        let unnamed = dump.replace("ITEM: UNITS\nsi\n", "");
        assert_close(&read(&folder, unnamed, &[&format!("particles.units={style}")]), &plain, style);
    }
}

#[test]
fn what_a_dump_does_not_say_is_asked_for() {
    let folder = Folder::good();
    let nameless = DUMP.replace("ITEM: UNITS\nsi\n", "");
    let oblique = DUMP.replace("BOUNDS pp", "BOUNDS xy xz yz pp").replace("e-2\n", "e-2 1e-3\n");
    for (dump, overrides, said) in [
        (nameless.clone(), &[TYPES][..], "does not say its units; give units, one of \"si\", \"cgs\""),
        (
            DUMP.to_owned(),
            &[TYPES, "particles.units=micro"],
            "it says units si, but units = \"micro\" was given",
        ),
        (DUMP.replace("\nsi", "\nlj"), &[TYPES], "lj has no units"),
        (DUMP.replace("\nsi", "\nmetric"), &[TYPES], "no unit style; give one of si, cgs"),
        (
            DUMP.to_owned(),
            &[],
            "grains.dump:26: type = \"1\": the scene has 2 materials; name those of types 1, 2",
        ),
        (DUMP.to_owned(), &["particles.materials_by_type=['glass']"], "names 1 materials, from type 1 on"),
        (
            DUMP.to_owned(),
            &[TYPES, "particles.step=50"],
            "no frame of step 50; its frames are of steps 0, 100",
        ),
        (DUMP.to_owned(), &[TYPES, "particles.step=0"], "no radius or diameter among id, type, x, y, z"),
        (DUMP.replace("x y z ix", "a b c ix"), &[TYPES], "no column x, xs, xu or xsu among"),
        (
            DUMP.replace("0.030 0", "0.050 0"),
            &[TYPES],
            "grains.dump:28: z = \"0.050\": outside the domain, 0 to 0.04",
        ),
        (DUMP.replace("0.030 0", "nan 0"), &[TYPES], "z = \"nan\": not finite"),
        (DUMP.replace("\n2 1 0.007", "\n1 1 0.007"), &[TYPES], "id = \"1\": line 26 has this id already"),
        (
            DUMP.replace("ATOMS\n3", "ATOMS\n4"),
            &[TYPES],
            "ends before row 4 of 4 of its last frame: cut short",
        ),
        (DUMP.replace("ATOMS\n3", "ATOMS\n2"), &[TYPES], "grains.dump:28: \"2 1 0.007"),
        (DUMP.replace("ATOMS\n1\n", "ATOMS\n2\n"), &[TYPES], "a section begins after 1 of 2 rows"),
        (
            DUMP.replace("ATOMS\n3", "ATOMS\n-3"),
            &[TYPES],
            "the number of atoms is \"-3\", not a whole number",
        ),
        (DUMP.replace(" 0 \n", " \n"), &[TYPES], "17 values in a row of 18 columns"),
        (oblique, &[TYPES], "oblique axes (xy, xz or yz is not 0)"),
        (
            DUMP.replace("0 4e-2\n", "0 x\n"),
            &[TYPES],
            "the box is \"0 x\"; it needs a lower and an upper end",
        ),
        (DUMP.replace("ITEM: ATOMS", "ITEM: ENTRIES"), &[TYPES], "a dump of pairs or of a grid"),
        (DUMP[..DUMP.len() - 250].to_owned(), &[TYPES], "cut short; choose an earlier frame by step"),
        (DUMP[..DUMP.find("ITEM: TIME\n0.5").unwrap() + 15].to_owned(), &[TYPES], "cut short"),
    ] {
        let refused = refusal(&folder, &dump, overrides);
        assert!(refused.contains(said), "{said}: {refused}");
    }
}

#[test]
fn boxes_that_repeat_otherwise_and_unread_columns_are_told() {
    let folder = Folder::good();
    let dump =
        DUMP.replace("0.0000000000000000e+00 2.0000000000000000e-02", "0 1.5e-2").replace("fx", "f_heat[0]");
    folder.write("grains.dump", dump);
    let scene = folder.read(&["particles.file=grains.dump", TYPES]).unwrap();
    let told = scene.warnings.join("\n");
    assert!(told.contains("its box repeats along x every 0.015 m, the domain every 0.02 m"), "{told}");
    assert!(told.contains("columns that are not read: f_heat[0]"), "{told}");
    folder.write("grains.dump", DUMP);
    assert!(
        folder.read(&["particles.file=grains.dump", TYPES]).unwrap().warnings.len() + 2
            <= scene.warnings.len()
    );
}

#[test]
fn a_field_needs_no_sizes_of_a_dump() {
    let folder = Folder::good();
    folder.write(
        "scene.toml",
        "domain = { min_m = [0, 0, 0], max_m = [1, 1, 1], \
         boundary = { x = 'open', y = 'open', z = 'open' } }\n\
         particles = { file = 'grains.dump', units = 'nano' }\n[electric_field]\n",
    );
    folder.write(
        "grains.dump",
        "ITEM: TIMESTEP\n7\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS ff ff ff\n0 1e9\n0 1e9\n0 1e9\n\
         ITEM: ATOMS x y z q\n5e8 5e8 5e8 1\n6e8 5e8 5e8 -2\n",
    );
    let grains = folder.read_for(Purpose::Field, &[]).unwrap().particles;
    assert_eq!((&grains.id[..], &grains.radius[..]), (&[1, 2][..], &[0.0, 0.0][..]));
    assert!((grains.charge[1] / -3.204_353_268e-19 - 1.0).abs() < ROUND_OFF);
}

#[test]
fn snapshots_are_read_without_a_scene() {
    let folder = Folder::good();
    folder.write("a.dump", DUMP);
    let snapshot = Snapshot::read(&folder.file("a.dump"), &SnapshotOptions::default()).unwrap();
    assert_eq!((snapshot.step, snapshot.time_s, snapshot.len()), (Some(100), Some(0.5), 3));
    let bounds = snapshot.bounds.unwrap();
    assert_eq!((bounds.min_m, bounds.max_m), (Vector3::zeros(), Vector3::new(0.02, 0.02, 0.04)));
    assert_eq!(bounds.is_periodic, [true, true, false]);
    assert_eq!(snapshot.charges_c().unwrap(), [-2e-12, 3e-12, 0.0]);
    assert_eq!(snapshot.materials, ["type1", "type2"]);
    assert!(snapshot.unused.contains(&"fx".to_owned()));
    let first = SnapshotOptions { step: Some(0), units: Some(Units::Si), ..SnapshotOptions::default() };
    let first = Snapshot::read(&folder.file("a.dump"), &first).unwrap();
    assert_eq!(
        (first.ids(), first.charges_c(), first.radii_m(), first.densities_kg_m3()),
        (&[9][..], None, None, None)
    );
    let table = Snapshot::read(&folder.file("grains.csv"), &SnapshotOptions::default()).unwrap();
    assert_eq!(
        (&table.materials[..], &table.groups[..]),
        (
            &["glass".to_owned(), "steel".to_owned()][..],
            &["all".to_owned(), "fine".to_owned(), "coarse".to_owned()][..],
        )
    );
    assert!(table.velocities_m_s().is_none() && table.bounds.is_none());
    let absent = Snapshot::read(&folder.file("absent"), &SnapshotOptions::default()).unwrap_err();
    assert!(absent.to_string().contains("check the path"), "{absent}");
}
