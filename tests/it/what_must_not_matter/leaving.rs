//! Grains that leave through faces: each is booked once, with the energy that it had, and how the face, the
//! run and the output are laid out does not change when and how they leave.

use amberfield_tests::{CsvTable, Workbench};

/// Grains that fly through a face of the box; the energy of a grain's image at touch is 7e-5 of its own.
const SCENE: &str = r#"
[domain]
min_m = [0, 0, 0]
max_m = [0.1, 0.1, 0.04]
[domain.boundary]
x = "open"
y = "open"
z_min = "grounded"
z_max = "open"
[[materials]]
name = "m"
density_kg_m3 = 2500
young_Pa = 1e7
poisson = 0.3
restitution = 1.0
friction = 0.0
[particles]
on_exit = "delete"
[particles.generate]
material = "m"
count = 150
radius_m = 2e-4
seed = 1
velocity_m_s = [0, 0, -2]
charge_C = 1e-12
region = { box = { min_m = [0.02, 0.02, 0.005], max_m = [0.08, 0.08, 0.02] } }
[time]
step_s = "auto"
end_s = 0.012
gravity_m_s2 = [0, 0, 0]
[electric_field]
[output]
formats = ["csv"]
checkpoint_every_s = 5e-3
"#;

/// Rows of the file of exits, and the largest kinetic energy over that at the start.
fn exits(scene: &str, arguments: &[&str]) -> (CsvTable, String, f64) {
    let bench = Workbench::new(scene);
    let answer = bench.run(&[&["run", "scene.toml", "--out", "out"], arguments].concat());
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    if let Some(checkpoint) = bench.names("out/checkpoints").into_iter().find(|name| name.ends_with(".amber"))
    {
        let before = bench.read("out/exits.csv");
        let answer = bench.run(&["run", "scene.toml", "--resume", &format!("out/checkpoints/{checkpoint}")]);
        assert_eq!(answer.code, Some(0), "{}", answer.stderr);
        assert_eq!(bench.read("out/exits.csv"), before, "a run that goes on books what the whole one did");
    }
    let kinetic = CsvTable::parse(&bench.read("out/history.csv")).numbers("kinetic_J");
    let most = kinetic.iter().copied().fold(0.0, f64::max) / kinetic[0];
    let text = bench.read("out/exits.csv");
    (CsvTable::parse(&text), text, most)
}

#[test]
fn grains_leave_through_a_conductor_as_they_touch_it() {
    let (table, text, most) = exits(SCENE, &[]);
    let [z, v, q] = ["z_m", "vz_m_s", "charge_C"].map(|column| table.numbers(column));
    assert_eq!(z.len(), 150);
    assert!(most < 1.001, "{most}");
    let step = 2.0 * 1e-5;
    assert!(z.iter().all(|z| (2e-4 - step..=2e-4).contains(z)), "{z:?}");
    assert!(v.iter().all(|v| (v + 2.0).abs() < 0.02), "{v:?}");
    assert!(q.iter().all(|q| *q == 1e-12));
    assert!(text.lines().skip(1).all(|row| row.contains(",z_min,")));
    // The same again, for any number of threads.
    assert_eq!(exits(SCENE, &["--threads", "1"]).1, text);
}

#[test]
fn faces_of_any_kind_let_grains_go_at_touch() {
    for face in ["{ potential_V = 10.0 }", "\"insulating\""] {
        let scene = SCENE.replace("z_min = \"grounded\"", &format!("z_min = {face}"));
        let scene = scene.replace("radius_m = 2e-4", "radius_m = { uniform = { min = 1e-4, max = 3e-4 } }");
        let (table, _, most) = exits(&scene, &[]);
        let [z, radius] = ["z_m", "radius_m"].map(|column| table.numbers(column));
        assert_eq!(z.len(), 150, "{face}");
        assert!(most < 1.01, "{face}: {most}");
        assert!(z.iter().zip(&radius).all(|(z, r)| (0.8 * r..=*r).contains(z)), "{face}");
    }
}

#[test]
fn grains_bounce_off_a_wall_on_the_face() {
    for place in ["0", "1e-9", "-1e-9"] {
        let wall =
            format!("[[walls]]\nplane = {{ point_m = [0, 0, {place}], normal = [0, 0, 1] }}\n[[materials]]");
        let (table, _, most) = exits(&SCENE.replace("[[materials]]", &wall), &[]);
        assert!(table.numbers("z_m").is_empty(), "wall at {place} m");
        assert!(most < 1.001, "{most}");
    }
}
