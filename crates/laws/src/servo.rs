//! Speed of a wall that grains shall press with a force F₀:
//! v = (F₀ − F) min(v_most/F₀, 1/(n k Δt)), at most v_most either way.
//!
//! F force of the grains against the wall's direction [N]; k stiffness of the contacts that bear it [N/m]; Δt
//! step [s]; n = 20 steps in which the contacts would take up the difference, were the grains fixed. The wall
//! has no mass. Far from the aim it moves at v_most, and it gives way where F > F₀.
//! Range: F₀ > 0, v_most > 0. The second bound keeps stiff contacts from being overshot.
//! Source: a proportional controller with a limited rate, as those of LIGGGHTS's servo walls and of triaxial
//! cells (Cundall & Strack, Géotechnique 29, 47 (1979), §8).
//!
//! ```
//! use amberfield_laws::servo::speed;
//! assert_eq!(speed(10.0, 0.1, 0.0, 0.0, 1e-6), 0.1);
//! assert_eq!(speed(10.0, 0.1, 10.0, 1e4, 1e-6), 0.0);
//! ```

/// Steps in which contacts between fixed bodies take up a difference of the force.
const STEPS: f64 = 20.0;

/// Speed [m/s] for an aim [N] and a largest speed [m/s], where grains press with a force [N] by contacts of a
/// stiffness [N/m], in steps [s].
#[must_use]
pub fn speed(aim: f64, most: f64, force: f64, stiffness: f64, step: f64) -> f64 {
    let gain = (most / aim).min(1.0 / (STEPS * stiffness * step));
    ((aim - force) * gain).clamp(-most, most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speed_is_bounded_and_of_the_right_sign() {
        assert_eq!(speed(1.0, 0.1, 100.0, 0.0, 1e-6), -0.1);
        assert!(speed(1.0, 0.1, 0.5, 1e5, 1e-6) > 0.0);
        assert!(speed(1.0, 0.1, 1.5, 1e5, 1e-6) < 0.0);
    }

    #[test]
    fn stiff_contact_comes_to_the_aim_without_overshoot() {
        let (aim, stiffness, step) = (2.0, 1e6, 1e-5);
        let mut force = 0.0;
        for _ in 0..1000 {
            force += stiffness * step * speed(aim, 0.5, force, stiffness, step);
            assert!(force <= aim);
        }
        assert!((force / aim - 1.0).abs() < 1e-9);
    }
}
