//! Small scenes for tests.

/// Charged grains that fall and collide between grounded plates.
pub(crate) const CHARGED: &str = r#"
[domain]
min_m = [0, 0, 0]
max_m = [2e-3, 2e-3, 4e-3]
[domain.boundary]
x = "periodic"
y = "periodic"
z = "grounded"
[[walls]]
plane = { point_m = [0, 0, 1e-5], normal = [0, 0, 1] }
[[walls]]
plane = { point_m = [0, 0, 3.99e-3], normal = [0, 0, -1] }
[[materials]]
name = "glass"
density_kg_m3 = 2500.0
young_Pa = 1e6
poisson = 0.22
restitution = 0.8
friction = 0.3
rolling_friction = 0.01
[particles.generate]
count = 60
radius_m = { uniform = { min = 8e-5, max = 1.2e-4 } }
seed = 4
velocity_m_s = [0.1, 0.05, -0.5]
charge_C = { bipolar = 1e-14 }
[time]
step_s = 2e-6
end_s = 2e-3
gravity_m_s2 = [0, 0, -9.81]
[electric_field]
tolerance = 1e-2
tuning = "model"
[output]
every_s = 2.5e-4
formats = ["vtk", "csv"]
checkpoint_every_s = 5e-4
"#;

/// Scene `CHARGED` without charge and field.
pub(crate) fn plain() -> String {
    let (before, rest) = CHARGED.split_once("[electric_field]").unwrap();
    let (_, after) = rest.split_once("[output]").unwrap();
    format!("{before}[output]{after}").replace("charge_C = { bipolar = 1e-14 }\n", "")
}

/// Scene of two charges in free space, without materials and time.
pub(crate) const PAIR: &str = "domain = { min_m = [0, 0, 0], max_m = [1, 1, 1], \
    boundary = { x = 'open', y = 'open', z = 'open' } }\n\
    particles.file = 'pair.csv'\n[electric_field]\nmethod = 'direct'\n";
/// Particles file of the scene `PAIR`: 1 nC and −2 nC, half a metre apart.
pub(crate) const PAIR_CSV: &str =
    "id,x_m,y_m,z_m,radius_m,charge_C\n5,0.25,0.5,0.5,0,1e-9\n3,0.75,0.5,0.5,0,-2e-9\n";
