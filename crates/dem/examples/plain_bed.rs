//! The plain bed as a run: `cargo xtask leaving-out` compares its instructions with those of `bare_bed`.

mod bed;

use amberfield_core::{OnExit, Skin, Step, TimeSettings, Vector3};
use amberfield_dem::{Setup, Simulation};

fn main() {
    let setup = Setup {
        domain: bed::domain(),
        materials: bed::materials(),
        rolling_model: Default::default(),
        cohesion: Default::default(),
        pairs: Vec::new(),
        particles: bed::particles(),
        walls: Vec::new(),
        time: TimeSettings {
            step: Step::Seconds(bed::STEP_S),
            end_s: 1.0,
            gravity_m_s2: Vector3::zeros(),
            skin: Skin::Metres(bed::SKIN_M),
            allow_unstable: false,
            on_exit: OnExit::Stop,
            allow_overlap: false,
        },
        gas: None,
        field: None,
        feeds: Default::default(),
        outlets: Vec::new(),
    };
    let mut simulation = Simulation::new(setup).expect("a good scene");
    for _ in 0..bed::STEPS {
        simulation.step().expect("a periodic box");
    }
    bed::tell(simulation.contacts(), simulation.particles().velocity.into_iter());
}
