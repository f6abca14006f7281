//! Automatic time step: what it knows of a run before it begins.

use crate::common::material;
use crate::feeds::{STEP, charged, feed, feeds, high, scene};
use amberfield_core::{CouplingInterval, Feed, Grain, Particles, Step, Vector3};
use amberfield_dem::Simulation;

#[test]
fn an_automatic_step_knows_the_charges_that_feeds_bring() {
    // At a fixed interval the plasma limit is the tightest, and nothing charged is there at the start.
    let make = |step: Step, charge: f64, velocity: f64| {
        let charged_of = |k: usize, grain: &mut Grain| {
            grain.charge = if k.is_multiple_of(2) { charge } else { -0.7 * charge };
            grain.velocity.z = velocity;
        };
        let packed = Feed { velocity: Vector3::z() * velocity, ..feed("a", high()) };
        let mut scene = scene(feeds(vec![packed], 120, 2.0 * STEP, charged_of), material(0.8, 0.0, 0.0));
        scene.particles = Particles::default();
        let mut scene = charged(scene, None);
        if let Some(field) = &mut scene.field {
            field.settings.coupling_interval = CouplingInterval::Steps(100);
        }
        scene.time.step = step;
        scene
    };
    let step_of = |charge: f64| Simulation::new(make(Step::Auto, charge, -1.0)).unwrap().step_s();
    let (weak, strong) = (step_of(1e-13), step_of(5e-10));
    assert!(strong < 0.5 * weak, "{strong:e} {weak:e}");
    for velocity in [-1.0, -0.1] {
        let mut simulation = Simulation::new(make(Step::Auto, 5e-10, velocity)).unwrap();
        while simulation.time_s() < 300.0 * STEP {
            simulation.step().unwrap_or_else(|error| panic!("{velocity}: {error}"));
        }
        assert!(simulation.feeds()[0].fed.grains > 100);
    }
    // What a run with a number has to be told.
    let mut simulation = Simulation::new(make(Step::Seconds(weak), 5e-10, -1.0)).unwrap();
    let error = (0..300).find_map(|_| simulation.step().err()).expect("the step is too long");
    let said = error.to_string();
    for words in ["plasma limit", "time.step_s", "coupling_interval", "what feeds bring"] {
        assert!(said.contains(words), "no {words:?} in {said}");
    }
}
