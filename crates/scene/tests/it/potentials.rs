//! Potentials and an external field that change with time.

use crate::common::{Folder, SCENE};
use amberfield_core::{Axis, Boundary, Course, CourseRow, FaceCourse, Side};
use amberfield_scene::Purpose;
use nalgebra::Vector3;

const TOP: &str = "domain.boundary.z_max";
const EXTERNAL: &str = "electric_field.external_field_V_m";

/// Folder of the good scene with two tables.
fn folder() -> Folder {
    let folder = Folder::good();
    folder.write("v.csv", "# measured\nt_s,potential_V\n0.01,5\n0.02,-7\n");
    folder.write("e.csv", "ez_V_per_m; t_s; ex_V_per_m; ey_V_per_m\n3; 0; 1; 2\n6; 1e-3; 4; 5\n");
    folder
}

#[test]
fn potentials_and_fields_over_time_are_read() {
    let read = |set: &[&str]| folder().read(set).unwrap();
    let sine = "{ potential_V = { amplitude = 1000, frequency_Hz = 50, phase_rad = 0.5, offset = 20 } }";
    let scene = read(&[&format!("{TOP}={sine}")]);
    let course = Course::Sine { amplitude: 1000.0, frequency_hz: 50.0, phase: 0.5, offset: 20.0 };
    let domain = scene.domain.unwrap();
    assert_eq!(domain.faces()[2][1], Boundary::Potential(1000.0 * 0.5_f64.sin() + 20.0));
    assert_eq!(domain.courses(), [FaceCourse { axis: Axis::Z, side: Side::Max, course }]);

    let domain = read(&[&format!("{TOP}={{ potential_V = {{ table = \"v.csv\" }} }}")]).domain.unwrap();
    let rows = [(0.01, 5.0), (0.02, -7.0)].map(|(time_s, value)| CourseRow { time_s, value }).to_vec();
    assert_eq!(domain.courses()[0].course, Course::Table { name: "v.csv".into(), rows });
    assert_eq!(domain.faces()[2][1], Boundary::Potential(5.0));

    let field = read(&[&format!("{EXTERNAL}={{ amplitude = [0, 0, 1e5], frequency_Hz = 50 }}")]);
    let field = field.electric_field.unwrap().field;
    assert_eq!(field.external_field_v_m, Vector3::zeros());
    assert_eq!(field.external_course.unwrap().at(0.005), Vector3::new(0.0, 0.0, 1e5));
    let field = read(&[&format!("{EXTERNAL}={{ table = \"e.csv\" }}")]).electric_field.unwrap().field;
    assert_eq!(field.external_field_v_m, Vector3::new(1.0, 2.0, 3.0));
    assert_eq!(field.external_course.unwrap().at(0.5), Vector3::new(4.0, 5.0, 6.0));
}

#[test]
fn offset_alone_is_a_constant_and_the_order_of_faces_does_not_matter() {
    let plain = folder().read(&[]).unwrap();
    let offset = "{ potential_V = { amplitude = 0, frequency_Hz = 50, offset = 100 } }";
    assert_eq!(folder().read(&[&format!("{TOP}={offset}")]).unwrap().domain, plain.domain);
    let field = "{ amplitude = [0, 0, 0], frequency_Hz = 50, offset = [1, 2, 3] }";
    let alone = folder().read(&[&format!("{EXTERNAL}={field}")]).unwrap();
    assert_eq!(
        alone.electric_field,
        folder().read(&[&format!("{EXTERNAL}=[1, 2, 3]")]).unwrap().electric_field
    );

    let faces = [
        "z_min = { potential_V = { table = \"v.csv\" } }",
        "z_max = { potential_V = { table = \"v.csv\" } }",
    ];
    let written = |lines: [&str; 2]| {
        let folder = folder();
        let lines = lines.join("\n");
        let from = "z_min = \"grounded\"\nz_max = { potential_V = 100.0 }";
        assert!(SCENE.contains(from));
        folder.write("scene.toml", SCENE.replacen(from, &lines, 1));
        folder.read(&[]).unwrap().domain
    };
    let both = folder().read(&["domain.boundary={ x = \"periodic\", y = \"periodic\", z = { potential_V = \
                                { table = \"v.csv\" } } }"]);
    assert_eq!(written(faces), written([faces[1], faces[0]]));
    assert_eq!(written(faces), both.unwrap().domain);
}

#[test]
fn tables_are_found_from_anywhere_and_belong_to_the_physics() {
    let set = [
        format!("{TOP}={{ potential_V = {{ table = \"v.csv\" }} }}"),
        format!("{EXTERNAL}={{ table = \"e.csv\" }}"),
    ];
    let set = [set[0].as_str(), set[1].as_str()];
    let folder = folder();
    let scene = folder.read(&set).unwrap();
    let elsewhere = tempfile::tempdir().unwrap();
    let path = elsewhere.path().join("scene.toml");
    std::fs::write(&path, scene.resolved()).unwrap();
    let again = amberfield_scene::read_scene(&path, &[], Purpose::Run).unwrap();
    assert_eq!(again.physics().changes_since(scene.physics()), [""; 0]);
    folder.write("v.csv", "t_s,potential_V\n0.01,5\n0.02,-8\n");
    assert_eq!(folder.read(&set).unwrap().physics().changes_since(scene.physics()).len(), 1);
}

#[test]
fn text_of_the_settings_is_read_as_the_same() {
    for field in ["{ amplitude = [0, 0, 1e5], frequency_Hz = 50, phase_rad = 0.25 }", "{ table = \"e.csv\" }"]
    {
        let folder = folder();
        let scene = folder.read(&[&format!("{EXTERNAL}={field}")]).unwrap();
        let settings = scene.electric_field.unwrap();
        assert!(settings.as_command().is_err());
        folder.write(
            "scene.toml",
            SCENE.replacen("[electric_field]\ntolerance = 1e-2\n", &settings.as_section(), 1),
        );
        assert_eq!(folder.read(&[]).unwrap().electric_field.unwrap(), settings);
    }
}

/// Bad values, and words of the answer.
const BAD: &[(&str, &str, &[&str])] = &[
    (TOP, "{ potential_V = { amplitude = 1, frequency_Hz = 0 } }", &["z_max.potential_V.frequency_Hz", "0"]),
    (TOP, "{ potential_V = { amplitude = 1, frequency_Hz = -50 } }", &["frequency_Hz", "-50"]),
    (TOP, "{ potential_V = { amplitude = nan, frequency_Hz = 50 } }", &["amplitude", "not finite"]),
    (TOP, "{ potential_V = { amplitude = 1 } }", &["frequency_Hz"]),
    (TOP, "{ potential_V = { frequency_Hz = 50 } }", &["amplitude", "table"]),
    (TOP, "{ potential_V = { } }", &["amplitude", "table"]),
    (TOP, "{ potential_V = { amplitude = 1, frequency = 50 } }", &["frequency_Hz"]),
    (TOP, "{ potential_V = { amplitude = 1, frequency_Hz = 50, ofset = 3 } }", &["ofset", "offset"]),
    (TOP, "{ potential_V = { amplitude = 1, frequency_Hz = 50, table = \"v.csv\" } }", &["remove one"]),
    (TOP, "{ potential_V = { table = \"w.csv\" } }", &["w.csv", "potential_V.table"]),
    (TOP, "{ potential_V = \"v.csv\" }", &["potential_V", "a number", "table"]),
    (
        TOP,
        "{ potential_V = { amplitude = 1, frequency_Hz = 1e5 } }",
        &["time.step_s", "1.000e5 Hz", "5e-7 s"],
    ),
    (TOP, "{ potential_V = { amplitude = 1, frequency_Hz = 50 }, normal_field_V_m = 1.0 }", &["exactly one"]),
    (EXTERNAL, "{ amplitude = 1e5, frequency_Hz = 50 }", &["amplitude", "[x, y, z]"]),
    (EXTERNAL, "{ amplitude = [0, 0, 1e5], frequency_Hz = 1e5 }", &["time.step_s", "5e-7 s"]),
    (EXTERNAL, "{ table = \"v.csv\" }", &["v.csv:2", "potential_V", "ex_V_per_m"]),
];

#[test]
fn bad_courses_are_refused_with_their_place() {
    for (key, value, words) in BAD {
        let said = folder().refusal(&[&format!("{key}={value}")]);
        assert!(words.iter().all(|word| said.contains(word)), "{value}: {said}");
    }
    let set = [
        &format!("{TOP}={{ potential_V = {{ table = \"v.csv\" }} }}"),
        "electric_field.method=kolehmainen",
        "electric_field.field_cutoff_radius=1e-3",
    ];
    let said = folder().refusal(&set);
    assert!(said.contains("electric_field.method") && said.contains("p3m"), "{said}");
}

#[test]
fn bad_tables_are_refused_with_their_line() {
    for (text, words) in [
        ("t_s,potential_V\n0,1\n0,2\n", "v.csv:3: t_s = 0 follows"),
        ("t_s,potential_V\n1,1\n0,2\n", "v.csv:3: t_s = 0 follows t_s = 1"),
        ("t_s,potential_V\n0,1\n", "1 row(s)"),
        ("t_s,potential\n0,1\n1,2\n", "v.csv:1: unknown column \"potential\""),
        ("t_s\n0\n1\n", "v.csv:1: the header row needs t_s and potential_V"),
        ("potential_V\n0\n1\n", "v.csv:1: the header row needs t_s"),
        ("t_s,potential_V\n0,1\n1,inf\n", "v.csv:3: potential_V = \"inf\""),
        ("t_s,potential_V\n0,1\nnan,1\n", "v.csv:3: t_s = \"nan\""),
        ("t_s,potential_V\n0,1\n1\n", "v.csv:3: 1 cells"),
        ("", "empty"),
    ] {
        let folder = folder();
        folder.write("v.csv", text);
        let said = folder.refusal(&[&format!("{TOP}={{ potential_V = {{ table = \"v.csv\" }} }}")]);
        assert!(said.contains(words), "{text}: {said}");
    }
}
