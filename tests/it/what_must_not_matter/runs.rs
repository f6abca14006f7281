//! Whole runs by the binary: what is written down otherwise, and what looks on.

use amberfield_tests::{CsvTable, Workbench};
use std::collections::HashMap;
use std::fmt::Write as _;

/// Radius of the grains [m].
const RADIUS: f64 = 1e-4;

/// Agreement that is demanded of places over the radius, and of charges over the largest.
#[derive(Clone, Copy, Debug)]
enum Demand {
    /// Every bit.
    Bitwise,
    /// Rounding of an impact or two in another way.
    RoundOff,
    /// Places 1000 m away are round to 1e-13 m.
    FarAway,
    /// Forecasts of the field in between, to its tolerance.
    Tolerance,
}

impl Demand {
    fn bound(self) -> f64 {
        match self {
            Self::Bitwise => 0.0,
            Self::RoundOff => 1e-7,
            Self::FarAway => 1e-4,
            Self::Tolerance => 1e-3,
        }
    }
}

/// Grain of the file; the name stays whatever the file calls it.
#[derive(Clone, Copy, Debug)]
struct Row {
    name: usize,
    id: u64,
    place: [f64; 3],
    material: &'static str,
}

/// Grains of two materials that trade charge as they fall onto a grounded STL floor and each other.
#[derive(Clone, Debug)]
struct Bed {
    scene: String,
    grains: Vec<Row>,
    /// Places of the floor's corners [unit of `scale`].
    floor: [[f64; 3]; 4],
    shift: f64,
    arguments: Vec<&'static str>,
    /// Step at which the run stops, and goes on from its checkpoint.
    split: Option<&'static str>,
}

const SCENE: &str = r#"
[domain]
min_m = [-2e-3, -2e-3, -1e-3]
max_m = [2e-3, 2e-3, 3e-3]
boundary = { x = "open", y = "open", z = "open" }
[[walls]]
stl = "floor.stl"
material = "steel"
charging = "grounded"
[[materials]]
name = "glass"
density_kg_m3 = 2500.0
young_Pa = 1e6
poisson = 0.22
restitution = 0.8
friction = 0.3
rolling_friction = 0.01
work_function_eV = 4.5
[[materials]]
name = "steel"
density_kg_m3 = 7800.0
young_Pa = 2e6
poisson = 0.3
restitution = 0.7
friction = 0.2
rolling_friction = 0.02
work_function_eV = 4.1
[particles]
file = "g.csv"
[time]
step_s = 2e-6
end_s = 8e-4
gravity_m_s2 = [0, 0, -9.81]
[electric_field]
method = "direct"
enable_collision_charge_transfer = true
coupling_interval = 1
[output]
formats = ["csv"]
"#;

impl Bed {
    fn new() -> Self {
        let spacing = 2.3 * RADIUS;
        let grains = (0..12)
            .map(|n| {
                let cell = [n % 3, n / 3 % 2, n / 6].map(|c| f64::from(c as u8));
                let lean = [0.1 * RADIUS * cell[2], -0.07 * RADIUS * cell[2], 0.0];
                let place = [0, 1, 2].map(|a| lean[a] + spacing * cell[a] + [0.0, 0.0, 1.2 * RADIUS][a]);
                Row { name: n, id: n as u64, place, material: if n % 2 == 0 { "glass" } else { "steel" } }
            })
            .collect();
        let floor =
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| [1e-3 * x, 1e-3 * y, 0.0]);
        Self { scene: SCENE.to_owned(), grains, floor, shift: 0.0, arguments: Vec::new(), split: None }
    }

    fn replace(&mut self, from: &str, to: &str) {
        assert!(self.scene.contains(from), "{from:?}");
        self.scene = self.scene.replace(from, to);
    }

    /// Places and charges at the end, by name: x, y, z [m], charge [C].
    fn end(&self) -> HashMap<usize, [f64; 4]> {
        let bench = Workbench::new(&self.scene);
        let mut rows = "id,x_m,y_m,z_m,radius_m,charge_C,material,vx_m_s,vz_m_s\n".to_owned();
        for Row { name, id, place: [x, y, z], material } in &self.grains {
            let charge = charge(*name);
            let x = x + self.shift;
            let _ = writeln!(rows, "{id},{x:e},{y:e},{z:e},{RADIUS:e},{charge:e},{material},0.05,-0.4");
        }
        bench.write("g.csv", rows);
        let mut stl = "solid floor\n".to_owned();
        for corners in [[0, 1, 2], [0, 2, 3]] {
            stl += "facet normal 0 0 1\nouter loop\n";
            for [x, y, z] in corners.map(|corner| self.floor[corner]) {
                let _ = writeln!(stl, "vertex {:e} {y:e} {z:e}", x + self.shift);
            }
            stl += "endloop\nendfacet\n";
        }
        bench.write("floor.stl", stl + "endsolid floor\n");
        let run = |arguments: &[&str]| {
            let answer = bench.run(&[&["run", "scene.toml"], arguments, &self.arguments[..]].concat());
            assert_eq!(answer.code, Some(0), "{}", answer.stderr);
        };
        match self.split {
            None => run(&["--out", "out"]),
            Some(step) => {
                run(&["--out", "out", "--steps", step]);
                run(&["--resume", &format!("out/checkpoints/step_{step:0>12}.amber")]);
            }
        }
        let last = bench.names("out/particles").into_iter().rfind(|name| name.ends_with(".csv")).unwrap();
        let table = CsvTable::parse(&bench.read(&format!("out/particles/{last}")));
        let [id, x, y, z, q] = ["id", "x_m", "y_m", "z_m", "charge_C"].map(|column| table.numbers(column));
        let name_of = |id: f64| self.grains.iter().find(|row| row.id as f64 == id).expect("a known id").name;
        (0..id.len()).map(|n| (name_of(id[n]), [x[n] - self.shift, y[n], z[n], q[n]])).collect()
    }
}

/// Charge of a grain at the start [C].
fn charge(name: usize) -> f64 {
    1e-14 * (name as f64 - 5.0)
}

/// Largest difference of places over the radius, and of charges over the largest.
fn difference(a: &HashMap<usize, [f64; 4]>, b: &HashMap<usize, [f64; 4]>) -> f64 {
    assert_eq!(a.len(), b.len());
    let charge = a.values().map(|row| row[3].abs()).fold(0.0, f64::max);
    let scale = [RADIUS, RADIUS, RADIUS, charge];
    let apart = |name: &usize| (0..4).map(|k| (a[name][k] - b[name][k]).abs() / scale[k]).fold(0.0, f64::max);
    a.keys().map(apart).fold(0.0, f64::max)
}

/// Change that physics does not see.
struct Line {
    name: &'static str,
    demand: Demand,
    change: fn(&mut Bed),
}

const LINES: [Line; 15] = [
    Line {
        name: "other ids",
        demand: Demand::Bitwise,
        change: |bed| bed.grains.iter_mut().for_each(|row| row.id = 1000 - 7 * row.id),
    },
    Line {
        name: "grains in another order",
        demand: Demand::RoundOff,
        change: |bed| bed.grains.sort_by_key(|row| 5 * row.name % 12),
    },
    Line { name: "split by a checkpoint", demand: Demand::Bitwise, change: |bed| bed.split = Some("177") },
    Line {
        name: "a row of the history in every step",
        demand: Demand::Bitwise,
        change: |bed| bed.arguments.extend(["--set", "output.history_every_s=2e-6"]),
    },
    Line {
        name: "frames, pictures and checkpoints",
        demand: Demand::Bitwise,
        change: |bed| {
            bed.replace("formats = [\"csv\"]", "formats = [\"vtk\", \"csv\", \"png\"]\nevery_s = 2e-4");
            bed.replace("[output]", "[output]\ncheckpoint_every_s = 1e-4");
        },
    },
    Line {
        name: "one thread",
        demand: Demand::Bitwise,
        change: |bed| bed.arguments.extend(["--threads", "1"]),
    },
    Line {
        name: "three threads",
        demand: Demand::Bitwise,
        change: |bed| bed.arguments.extend(["--threads", "3"]),
    },
    Line {
        name: "materials with other names",
        demand: Demand::Bitwise,
        change: |bed| {
            bed.scene = bed.scene.replace("glass", "quartz glass").replace("steel", "a");
            for row in &mut bed.grains {
                row.material = if row.material == "glass" { "quartz glass" } else { "a" };
            }
        },
    },
    Line {
        name: "materials in another order",
        demand: Demand::Bitwise,
        change: |bed| {
            let (head, rest) = bed.scene.split_once("[[materials]]").expect("a material");
            let (first, rest) = rest.split_once("[[materials]]").expect("another");
            let (second, rest) = rest.split_once("[particles]").expect("particles");
            bed.scene = format!("{head}[[materials]]{second}[[materials]]{first}[particles]{rest}");
        },
    },
    Line {
        name: "an STL in millimetres",
        demand: Demand::RoundOff,
        change: |bed| {
            bed.floor.iter_mut().flatten().for_each(|x| *x *= 1e3);
            bed.replace("\"floor.stl\"", "\"floor.stl\"\nscale = 1e-3");
        },
    },
    Line {
        name: "a larger box in open space",
        demand: Demand::RoundOff,
        change: |bed| bed.replace("max_m = [2e-3, 2e-3, 3e-3]", "max_m = [5e-3, 2.7e-3, 9e-3]"),
    },
    Line {
        name: "1000 m away",
        demand: Demand::FarAway,
        change: |bed| {
            bed.shift = 1000.0;
            bed.replace("[-2e-3, -2e-3, -1e-3]", "[999.998, -2e-3, -1e-3]");
            bed.replace("[2e-3, 2e-3, 3e-3]", "[1000.002, 2e-3, 3e-3]");
        },
    },
    Line {
        name: "a wall that nothing touches",
        demand: Demand::RoundOff,
        change: |bed| {
            let place = "point_m = [0, 0, 2.9e-3], normal = [0, 0, -1]";
            let lid = format!("[[walls]]\nplane = {{ {place} }}\nmaterial = \"glass\"\n");
            bed.replace("[[materials]]\nname = \"glass\"", &format!("{lid}[[materials]]\nname = \"glass\""));
        },
    },
    Line {
        name: "the rolling model that is the default, by name",
        demand: Demand::Bitwise,
        change: |bed| bed.scene += "[contacts]\nrolling_model = \"epsd\"\n",
    },
    Line {
        name: "the field in every other step",
        demand: Demand::Tolerance,
        change: |bed| bed.replace("coupling_interval = 1", "coupling_interval = 2"),
    },
];

#[test]
fn how_a_run_is_written_down_and_looked_at_does_not_matter() {
    let known = Bed::new().end();
    let moved = known.iter().map(|(name, row)| (row[3] - charge(*name)).abs()).fold(0.0, f64::max);
    assert!(moved > 1e-14, "charge moves: {known:?}");
    let mut seen = Vec::new();
    for Line { name, demand, change } in &LINES {
        let mut bed = Bed::new();
        change(&mut bed);
        let found = difference(&known, &bed.end());
        if found.is_nan() || found > demand.bound() {
            seen.push(format!("{name}: {found:.2e} is above {:.0e}", demand.bound()));
        }
    }
    assert!(seen.is_empty(), "{}", seen.join("\n"));
}

#[test]
fn finer_steps_change_less_and_less() {
    let ends: Vec<_> = ["2e-6", "1e-6", "5e-7", "2.5e-7"]
        .iter()
        .map(|step| {
            let mut bed = Bed::new();
            bed.replace("step_s = 2e-6", &format!("step_s = {step}"));
            bed.end()
        })
        .collect();
    let changes: Vec<f64> = ends.windows(2).map(|pair| difference(&pair[0], &pair[1])).collect();
    // Friction and tangential dashpots are of first order.
    let order = (changes[0] / changes[2]).log2() / 2.0;
    assert!(order > 0.8 && changes[2] < 0.01, "observed order {order:.2}: {changes:?}");
}
