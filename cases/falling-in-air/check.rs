//! Case of terminal speeds in still air.

use crate::support::Case;

/// Terminal speeds in the README, from the balance of weight, buoyancy and drag, solved without the program
/// [m/s].
const SPEEDS_M_S: [f64; 3] = [0.169_911, 1.411_443, 3.689_976];
/// Largest allowed relative difference.
const AGREEMENT: f64 = 5e-3;

#[test]
fn beads_fall_at_their_terminal_speeds() {
    let speeds = Case::new("falling-in-air").run(&[]).last_particles().column("vz_m_s").to_vec();
    for (speed, expected) in speeds.iter().zip(SPEEDS_M_S) {
        assert!((-speed / expected - 1.0).abs() < AGREEMENT, "{speeds:?}");
    }
}
