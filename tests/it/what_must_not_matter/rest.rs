//! Charges that start from rest: whatever the scale, the box and the field's parameters, they gain the speed
//! that Coulomb's law gives them, and no run ends because a check mistakes rounding for energy.

use amberfield_tests::{CsvTable, Workbench};
use std::f64::consts::PI;
use std::fmt::Write as _;

/// 1/(4πε₀) [m/F].
const COULOMB: f64 = 8.987_551_79e9;
/// Density of the grains [kg/m³].
const DENSITY: f64 = 2500.0;
/// Relative error of the speed by walls ten distances away, and by the field's tolerance.
const AGREES: f64 = 0.02;

/// Two charges at rest in a box, in units of their distance and charge.
#[derive(Clone, Debug)]
struct Pair {
    /// Distance [m].
    distance: f64,
    /// Charges [C].
    charges: [f64; 2],
    boundary: &'static str,
    arguments: Vec<&'static str>,
    /// Grains without charge at random places.
    bystanders: usize,
}

impl Pair {
    fn new() -> Self {
        Self {
            distance: 0.01,
            charges: [1e-12; 2],
            boundary: "x = 'grounded'\ny = 'grounded'\nz = 'grounded'",
            arguments: Vec::new(),
            bystanders: 0,
        }
    }

    /// Speed of the first grain at the end, over that of Coulomb's law. The grains move by 1e-4 of their
    /// distance.
    fn speed(&self) -> f64 {
        let Self { distance, charges: [one, other], boundary, .. } = self;
        let radius = 0.1 * distance;
        let mass = 4.0 / 3.0 * PI * radius.powi(3) * DENSITY;
        let acceleration = COULOMB * (one * other).abs() / (distance * distance * mass);
        let end = (2e-4 * distance / acceleration).sqrt();
        let half = 10.0 * distance;
        let bench = Workbench::new(&format!(
            "[domain]\nmin_m = [-{half:e}, -{half:e}, -{half:e}]\nmax_m = [{half:e}, {half:e}, {half:e}]\n\
             [domain.boundary]\n{boundary}\n\
             [[materials]]\nname = 'm'\ndensity_kg_m3 = {DENSITY}\nyoung_Pa = 1e7\npoisson = 0.3\n\
             restitution = 0.5\nfriction = 0.0\n[particles]\nfile = 'g.csv'\n\
             [time]\nstep_s = {:e}\nend_s = {end:e}\ngravity_m_s2 = [0, 0, 0]\nallow_unstable = true\n\
             [electric_field]\n[output]\nformats = ['csv']\n",
            end / 2000.0
        ));
        let mut rows = "id,x_m,y_m,z_m,radius_m,charge_C\n".to_owned();
        for (id, (x, charge)) in [(0.0, one), (*distance, other)].into_iter().enumerate() {
            let _ = writeln!(rows, "{id},{x:e},0,0,{radius:e},{charge:e}");
        }
        for n in 0..self.bystanders {
            let [x, y] = [0.618, 0.414].map(|k| (1.6 * (n as f64 * k).fract() - 0.8) * half);
            let _ = writeln!(rows, "{},{x:e},{y:e},{:e},{radius:e},0", 2 + n, 0.3 * half);
        }
        bench.write("g.csv", rows);
        let answer = bench.run(&[&["run", "scene.toml", "--out", "out"], &self.arguments[..]].concat());
        assert_eq!(answer.code, Some(0), "{self:?}: {}", answer.stderr);
        let last = bench.names("out/particles").into_iter().rfind(|name| name.ends_with(".csv")).unwrap();
        let table = CsvTable::parse(&bench.read(&format!("out/particles/{last}")));
        table.numbers("vx_m_s")[0].abs() / (acceleration * end)
    }
}

/// Change that physics does not see, in these units.
type Line = (&'static str, fn(&mut Pair));

const LINES: [Line; 11] = [
    ("as it is", |_| {}),
    ("opposite signs", |pair| pair.charges[1] = -1e-12),
    ("a micrometre and a few electrons", |pair| {
        pair.distance = 1e-5;
        pair.charges = [1e-18; 2];
    }),
    ("ten metres apart", |pair| {
        pair.distance = 10.0;
        pair.charges = [1e-9; 2];
    }),
    ("a large charge", |pair| pair.charges = [1e-9; 2]),
    ("tolerance 1e-4", |pair| pair.arguments.extend(["--set", "electric_field.tolerance=1e-4"])),
    ("tolerance 1e-6", |pair| pair.arguments.extend(["--set", "electric_field.tolerance=1e-6"])),
    ("every pair by itself", |pair| pair.arguments.extend(["--set", "electric_field.method=direct"])),
    ("open", |pair| pair.boundary = "x = 'open'\ny = 'open'\nz = 'open'"),
    ("periodic beside grounded plates", |pair| {
        pair.boundary = "x = 'periodic'\ny = 'periodic'\nz = 'grounded'";
    }),
    ("neutral bystanders", |pair| pair.bystanders = 12),
];

#[test]
fn charges_at_rest_fly_apart_as_coulomb_has_it_at_any_scale() {
    let mut seen = Vec::new();
    for (name, change) in LINES {
        let mut pair = Pair::new();
        change(&mut pair);
        let speed = pair.speed();
        if (speed - 1.0).abs() > AGREES {
            seen.push(format!("{name}: {speed}"));
        }
    }
    assert!(seen.is_empty(), "{}", seen.join("\n"));
}

/// Two charges that oscillate about the sites of a body-centred lattice, from rest.
const LATTICE: &str = "domain = { min_m = [0, 0, 0], max_m = [4e-3, 4e-3, 4e-3], \
    boundary = { x = 'periodic', y = 'periodic', z = 'periodic' } }\n\
    [[materials]]\nname = 'm'\ndensity_kg_m3 = 1000.0\nyoung_Pa = 1e6\npoisson = 0.3\nrestitution = 0.9\n\
    friction = 0.3\n[particles]\nfile = 'g.csv'\n[time]\nstep_s = 7.5e-6\nend_s = 0.0375\n\
    gravity_m_s2 = [0, 0, 0]\n[electric_field]\ntolerance = 1e-4\ncoupling_interval = 1\n\
    neutralising_background = true\n[output]\nhistory_every_s = 7.5e-5\n";

#[test]
fn turning_points_are_no_fault() {
    let bench = Workbench::new(LATTICE);
    bench.write(
        "g.csv",
        "id,x_m,y_m,z_m,radius_m,charge_C\n1,0.98e-3,1e-3,1e-3,1e-4,5e-11\n2,3.02e-3,3e-3,3e-3,1e-4,5e-11\n",
    );
    for tolerance in ["1e-2", "1e-3", "1e-4", "1e-5"] {
        let set = format!("electric_field.tolerance={tolerance}");
        let answer = bench.run(&["run", "scene.toml", "--out", tolerance, "--set", &set]);
        assert_eq!(answer.code, Some(0), "{tolerance}: {}", answer.stderr);
    }
    // Half a period is 2π √((m/2)/(4πk q²/(3L³)))/2: the fifth turning point lies at 18.75 ms.
    let history = CsvTable::parse(&bench.read("1e-4/history.csv"));
    let (time, kinetic) = (history.numbers("time_s"), history.numbers("kinetic_J"));
    let most = kinetic.iter().copied().fold(0.0, f64::max);
    let mass = 4.0 / 3.0 * PI * 1e-12 * 1000.0;
    let spring = 4.0 * PI * COULOMB * 2.5e-21 / (3.0 * 6.4e-8);
    let period = 2.0 * PI * (0.5 * mass / spring).sqrt();
    let turns = |n: usize| n > 0 && n + 1 < time.len() && kinetic[n] < kinetic[n - 1].min(kinetic[n + 1]);
    let turning: Vec<f64> = (0..time.len()).filter(|n| turns(*n)).map(|n| time[n]).collect();
    assert!((turning[4] / (2.5 * period) - 1.0).abs() < 5e-3, "{turning:?}, period {period:e}");
    assert!((most / 1.2e-12 - 1.0).abs() < 0.1, "{most:e}");
}
