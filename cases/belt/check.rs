//! Case of a ball on a belt.

use crate::support::Case;

const BELT_M_S: f64 = 0.2;
const FRICTION: f64 = 0.3;
const GRAVITY_M_S2: f64 = 9.81;
/// Swing of the load where friction begins to turn the ball, and the tangential spring's.
const SWING: f64 = 5e-3;

#[test]
fn ball_slips_and_then_rolls() {
    let case = Case::new("belt");
    let run = case.run(&[]);
    let slips_s = 2.0 * BELT_M_S / (7.0 * FRICTION * GRAVITY_M_S2);
    let rolls_m_s = 2.0 / 7.0 * BELT_M_S;
    for frame in run.frames() {
        let expected = rolls_m_s * (frame.time_s / slips_s).min(1.0);
        let found = frame.grains.column("vx_m_s")[0];
        assert!((found - expected).abs() < SWING * rolls_m_s, "{found} m/s after {} s", frame.time_s);
    }
}
