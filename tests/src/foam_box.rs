//! Box of charged grains with an OpenFOAM case of the same box.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use crate::foam_case::{brick, write_case};
use crate::{Answer, CsvTable, Workbench};
use rustix::process::Pid;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// Longest wait for something that takes a fraction of a second.
pub const DEADLINE: Duration = Duration::from_secs(60);
/// Box of charged grains, whose boundaries are given in `phiE` and in `[domain.boundary]`.
#[derive(Debug)]
pub struct FoamBox {
    /// Folder of the box.
    pub bench: Workbench,
}

impl FoamBox {
    /// Box with a kind and a condition for each patch, in the order x0, x1, y0, y1, z0, z1.
    ///
    /// # Panics
    /// When its folder cannot be written.
    #[must_use]
    pub fn new(sides: &[(&str, &str); 6], faces: &str, charge: &str) -> Self {
        let scene = format!(
            "[domain]\nmin_m = [0, 0, 0]\nmax_m = [0.012, 0.012, 0.01]\n[domain.boundary]\n{faces}\n\
             [[materials]]\nname = 'glass'\ndensity_kg_m3 = 2500.0\nyoung_Pa = 5e5\npoisson = 0.22\n\
             restitution = 0.6\nfriction = 0.3\n\
             [particles]\non_exit = 'delete'\n\
             generate = {{ material = 'glass', count = 3000, radius_m = 2.5e-4, seed = 3, charge_C = {{ \
             {charge} }} }}\n\
             [electric_field]\ntuning = 'model'\n[time]\nstep_s = 'auto'\nend_s = 1e-3\n\
             gravity_m_s2 = [0, 0, -9.81]\n\
             [solver]\nopenfoam_case = 'foam'\ntimeout_s = 20.0\n"
        );
        let bench = Workbench::new(&scene);
        let brick = brick([12.0, 12.0, 10.0], [12, 12, 10], sides);
        write_case(&bench, &brick.mesh, &brick.conditions, "Gauss linear");
        Self { bench }
    }

    /// Box with all faces grounded.
    #[must_use]
    pub fn grounded() -> Self {
        let wall = ("wall", "type fixedValue; value uniform 0;");
        Self::new(&[wall; 6], "x = 'grounded'\ny = 'grounded'\nz = 'grounded'", "bipolar = 1e-12")
    }

    /// Computes the field of the grains.
    #[must_use]
    pub fn field(&self, out: &str, options: &[&str]) -> Answer {
        self.bench.run(&[&["field", "scene.toml", "--out", out], options].concat())
    }

    /// Components of E in a result [V/m], first those along x of all grains.
    #[must_use]
    pub fn e(&self, out: &str) -> Vec<f64> {
        let table = CsvTable::parse(&self.bench.read(out));
        ["ex_V_per_m", "ey_V_per_m", "ez_V_per_m"].iter().flat_map(|name| table.numbers(name)).collect()
    }

    /// Removes `[solver]` from the scene.
    ///
    /// # Panics
    /// When the scene has none.
    pub fn alone(&self) {
        let scene = self.bench.read("scene.toml");
        self.bench.write("scene.toml", &scene[..scene.find("[solver]").unwrap()]);
    }

    /// Starts a run without end and waits until it has begun to step.
    ///
    /// # Panics
    /// When it does not.
    #[must_use]
    pub fn endless(&self) -> Child {
        let scene = self.bench.read("scene.toml").replace("end_s = 1e-3", "end_s = 1e3");
        self.bench.write("endless.toml", scene);
        let out =
            ["run", "endless.toml", "--out", "out", "--no-progress", "--set", "output.history_every_s=1e-5"];
        let mut child =
            self.bench.command(&out).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        self.wait_until_it_steps(&mut child);
        child
    }

    /// Waits until the run into `out` has begun to step.
    ///
    /// # Panics
    /// When it does not, or ends.
    pub fn wait_until_it_steps(&self, run: &mut Child) {
        let begun = Instant::now();
        let rows = || {
            std::fs::read_to_string(self.bench.path("out/history.csv")).map_or(0, |text| text.lines().count())
        };
        while rows() < 4 {
            assert!(begun.elapsed() < DEADLINE && run.try_wait().unwrap().is_none(), "the run must begin");
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// Process of the field solver of this box.
    ///
    /// # Panics
    /// When none runs.
    #[must_use]
    pub fn solver(&self) -> Pid {
        let case = self.bench.path("out/solver").canonicalize().unwrap().display().to_string();
        let is_it = |entry: &std::fs::DirEntry| {
            let line = std::fs::read(entry.path().join("cmdline")).unwrap_or_default();
            String::from_utf8_lossy(&line)
                .replace('\0', " ")
                .contains(&format!("electricFieldFoam -case {case}"))
        };
        let found = std::fs::read_dir("/proc").unwrap().flatten().find(is_it).expect("the solver runs");
        Pid::from_raw(found.file_name().to_string_lossy().parse().unwrap()).unwrap()
    }
}
