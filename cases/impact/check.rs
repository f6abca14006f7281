//! Case of a head-on impact.

use crate::support::Case;
use amberfield_oracle::HertzImpact;

const SPEED_M_S: f64 = 0.1;
const STEP_S: f64 = 1e-7;
/// Error of the integration with about 400 steps in a contact. It falls with the step at an observed order of
/// about 1 where damping is strong (`crates/dem` tests it): 4.9e-4 at 100 steps, 1.1e-4 at 400 for e = 0.5.
const INTEGRATION: f64 = 5.6e-4;
/// Uncertainty of the contact time [steps], since the contact starts and ends within a step.
const STEPS_UNCERTAIN: f64 = 2.0;

#[test]
fn grains_leave_with_their_restitution() {
    for restitution in [1.0, 0.9, 0.5, 0.2] {
        let case = Case::new("impact");
        case.replace("scene.toml", "restitution = 0.9", &format!("restitution = {restitution:?}"));
        let speeds = case.run(&[]).last_particles().column("vx_m_s").to_vec();
        let ratio = (speeds[1] - speeds[0]) / SPEED_M_S;
        assert!((ratio - restitution).abs() < INTEGRATION, "restitution {restitution}: {ratio}");
        assert!((speeds[0] + speeds[1]).abs() < 1e-15, "momentum to round-off: {speeds:?}");
    }
}

#[test]
fn elastic_contact_lasts_as_long_as_hertz_says() {
    let case = Case::new("impact");
    case.replace("scene.toml", "restitution = 0.9", "restitution = 1.0");
    let history = case.run(&[]).history();
    let touching = history.column("contacts").iter().filter(|contacts| **contacts > 0.0).count() as f64;
    let expected = HertzImpact::equal_spheres(75e-6, 1000.0, 1e6, 0.3, SPEED_M_S).contact_time();
    let difference = touching * STEP_S - expected;
    assert!(difference.abs() <= STEPS_UNCERTAIN * STEP_S, "{} s, expected {expected} s", touching * STEP_S);
}
