//! Case of the charge that impacts move, for soft grains and with the correction of their stiffness.

use crate::support::{Case, Curve, plot};
use amberfield_oracle::{DampedHertzImpact, HertzImpact};

const RADIUS_M: f64 = 75e-6;
const CHARGE_C: f64 = 1e-13;
const YOUNG_PA: [f64; 4] = [1e5, 1e6, 1e7, 1e8];
/// Error of the integration with at least 400 steps in a contact, and of the field of the other pairs.
const ERROR: f64 = 2e-4;
/// Error with the correction; at e = 0.3 the strong damping is integrated to first order.
const COLLAPSE: f64 = 4e-4;

/// Speeds [m/s] and charges moved [C].
fn impacts(young: f64, restitution: f64, corrected: bool) -> Vec<(f64, f64)> {
    let case = Case::new("stiffness-collapse");
    // The duration of a contact goes as Y^{−2/5}.
    let time = (young / 1e6).powf(-0.4);
    let replace = |from: &str, to: String| case.replace("scene.toml", from, &to);
    replace("young_Pa = 1e6", format!("young_Pa = {young:e}"));
    replace("restitution = 0.9", format!("restitution = {restitution}"));
    replace("step_s = 4e-8", format!("step_s = {:e}", 4e-8 * time));
    replace("end_s = 8e-5", format!("end_s = {:e}", 8e-5 * time + 4e-6));
    if !corrected {
        replace("stiffness_correction = true", "stiffness_correction = false".to_owned());
    }
    let before = case.table("grains.csv");
    let run = case.run(&[]);
    let after = run.last_particles();
    let (speed, charge) = (before.column("vx_m_s"), after.column("charge_C"));
    assert_eq!(*run.history().column("contacts").last().expect("a row"), 0.0, "all have parted");
    (0..speed.len() / 2).map(|pair| (2.0 * speed[2 * pair], CHARGE_C - charge[2 * pair])).collect()
}

fn exact(young: f64, restitution: f64, speed: f64) -> f64 {
    let elastic = HertzImpact::equal_spheres(RADIUS_M, 1000.0, young, 0.3, speed);
    DampedHertzImpact { elastic, restitution }.charge_moved(RADIUS_M, CHARGE_C)
}

#[test]
fn charges_of_soft_impacts_collapse_on_the_real_stiffness() {
    for (restitution, corrected, name) in
        [(0.9, false, "uncorrected"), (0.9, true, "corrected"), (0.3, true, "corrected-inelastic")]
    {
        let mut curves = Vec::new();
        for young in YOUNG_PA {
            let impacts = impacts(young, restitution, corrected);
            for &(speed, moved) in &impacts {
                let of = if corrected { 1e8 } else { young };
                let error = moved / exact(of, restitution, speed) - 1.0;
                let bound = if corrected { COLLAPSE } else { ERROR };
                assert!(error.abs() < bound, "{name}, Y {young:e}, {speed} m/s: {error:e}");
            }
            curves.push(Curve { name: format!("Y = {young:e} Pa"), points: impacts });
        }
        plot("stiffness-collapse", name, ["speed of the impact [m/s]", "charge moved [C]"], true, curves);
    }
}

#[test]
fn area_grows_with_speed_to_the_four_fifths() {
    let impacts = impacts(1e8, 0.9, false);
    // Speeds lie a factor of 10^{1/4} apart; at Y = 10⁸ Pa αA is small, and charge goes as area.
    let slope = (impacts[8].1 / impacts[0].1).log10() / (impacts[8].0 / impacts[0].0).log10();
    assert!((4.0_f64.powf(slope) / 4.0_f64.powf(0.8) - 1.0).abs() < 3e-3, "exponent {slope}");
}
