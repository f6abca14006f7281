//! A box of charged grains with a case of OpenFOAM's around it.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use crate::foam_case::{brick, write_case};
use crate::{Answer, Bench, Table};
use rustix::process::Pid;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// Longest wait for something that takes a fraction of a second.
pub const DEADLINE: Duration = Duration::from_secs(60);
/// Half-and-half charged grains in a box; every boundary as `phiE` and `[domain.boundary]` say it.
#[derive(Debug)]
pub struct FoamBox {
    /// Its folder.
    pub bench: Bench,
}

impl FoamBox {
    /// A box whose patches have a kind and a condition each, in the order x0, x1, y0, y1, z0, z1.
    ///
    /// # Panics
    /// When its folder cannot be written.
    #[must_use]
    pub fn new(sides: &[(&str, &str); 6], faces: &str, charge: &str) -> Self {
        let scene = format!(
            "[domain]\nmin_m = [0, 0, 0]\nmax_m = [0.012, 0.012, 0.01]\n[domain.boundary]\n{faces}\n\
             [[materials]]\nname = 'glass'\ndensity_kg_m3 = 2500.0\nyoung_Pa = 5e5\npoisson = 0.22\nrestitution = 0.6\nfriction = 0.3\n\
             [particles]\non_exit = 'delete'\ngenerate = {{ material = 'glass', count = 3000, radius_m = 2.5e-4, seed = 3, charge_C = {{ {charge} }} }}\n\
             [electric_field]\ntuning = 'model'\n[time]\nstep_s = 'auto'\nend_s = 1e-3\ngravity_m_s2 = [0, 0, -9.81]\n\
             [solver]\nopenfoam_case = 'foam'\ntimeout_s = 20.0\n"
        );
        let bench = Bench::new(&scene);
        let (mesh, conditions) = brick([12.0, 12.0, 10.0], [12, 12, 10], sides);
        write_case(&bench, &mesh, &conditions, "Gauss linear");
        Self { bench }
    }

    /// All faces grounded.
    #[must_use]
    pub fn grounded() -> Self {
        let wall = ("wall", "type fixedValue; value uniform 0;");
        Self::new(&[wall; 6], "x = 'grounded'\ny = 'grounded'\nz = 'grounded'", "bipolar = 1e-12")
    }

    /// The field of its grains.
    #[must_use]
    pub fn field(&self, out: &str, options: &[&str]) -> Answer {
        self.bench.run(&[&["field", "scene.toml", "--out", out], options].concat())
    }

    /// E of a result.
    #[must_use]
    pub fn e(&self, out: &str) -> Vec<f64> {
        let table = Table::parse(&self.bench.read(out));
        ["ex_V_per_m", "ey_V_per_m", "ez_V_per_m"].iter().flat_map(|name| table.numbers(name)).collect()
    }

    /// Without `[solver]` from now on.
    ///
    /// # Panics
    /// When there was none.
    pub fn alone(&self) {
        let scene = self.bench.read("scene.toml");
        self.bench.write("scene.toml", &scene[..scene.find("[solver]").unwrap()]);
    }

    /// Starts a run that goes on for ever and waits until it has begun to step.
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

    /// The field solver of this folder's case.
    ///
    /// # Panics
    /// When none runs.
    #[must_use]
    pub fn solver(&self) -> Pid {
        let case = self.bench.path("foam").canonicalize().unwrap().display().to_string();
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
