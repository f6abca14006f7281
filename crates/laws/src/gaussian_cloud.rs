//! Gaussian cloud and remainder: V_cloud = q erf(u)/(4πεr), u = r/(√2σ), and V_near = q erfc(u)/(4πεr).
//!
//! The cloud has the density q (2πσ²)^{-3/2} exp(−r²/2σ²). Fields along r̂ (from the charge to the point):
//!
//! E_near = q/(4πεr²) [erfc u + (2/√π) u e^{−u²}],  E_cloud = q/(4πεr²) [erf u − (2/√π) u e^{−u²}];
//! their sum is the point charge's field. For r ≪ σ the cloud's field is
//! q r/(4πε) √(2/π)/(3σ³) [1 − 3u²/5 + 3u⁴/14 − u⁶/18 + …] and its potential at the centre is
//! q √(2/π)/(4πεσ).
//!
//! q charge [C]; r distance [m]; σ width [m]; ε [F/m]. The functions are for q/(4πε) = 1: fields are
//! given **over r** (E/r, [1/m³]), ready to multiply an offset vector; potentials in [1/m].
//! Range: near part r > 0; cloud r ≥ 0. Source: Hockney & Eastwood, *Computer Simulation Using Particles*,
//! ch. 8; Essmann et al., J. Chem. Phys. 103, 8577 (1995).
//!
//! ```
//! use amberfield_laws::gaussian_cloud::{cloud_field_over_r, near_field_over_r};
//! let (r, sigma) = (1.3, 0.9);
//! let point = 1.0 / (r * r * r);
//! assert!((cloud_field_over_r(r, sigma) + near_field_over_r(r, sigma) - point).abs() < 1e-15);
//! ```

use libm::{erf, erfc};
use std::f64::consts::{FRAC_2_SQRT_PI, SQRT_2};

/// √(2/π).
const SQRT_2_OVER_PI: f64 = FRAC_2_SQRT_PI / SQRT_2;
/// u below which the series is used; its first dropped terms are under 1e-16 there.
const SERIES_BELOW_U: f64 = 0.5;
/// Terms of the series.
const SERIES_TERMS: u32 = 12;

/// E_near/r [1/m³] of a unit q/(4πε) at distance r > 0 [m], width σ [m].
#[inline]
#[must_use]
pub fn near_field_over_r(distance: f64, sigma: f64) -> f64 {
    let u = distance / (SQRT_2 * sigma);
    (erfc(u) + FRAC_2_SQRT_PI * u * (-u * u).exp()) / (distance * distance * distance)
}

/// V_near [1/m] of a unit q/(4πε) at distance r > 0 [m], width σ [m].
#[inline]
#[must_use]
pub fn near_potential(distance: f64, sigma: f64) -> f64 {
    erfc(distance / (SQRT_2 * sigma)) / distance
}

/// E_cloud/r [1/m³] of a unit q/(4πε) at distance r ≥ 0 [m], width σ [m]; series for small r.
#[must_use]
pub fn cloud_field_over_r(distance: f64, sigma: f64) -> f64 {
    let u = distance / (SQRT_2 * sigma);
    if u < SERIES_BELOW_U {
        let u2 = u * u;
        // erf u − (2/√π) u e^{−u²} = (2/√π) Σ_{k≥1} (−1)^{k+1} 2k u^{2k+1} / (k! (2k+1)).
        let mut sum = 0.0;
        let mut power = 1.0;
        for k in 1..=SERIES_TERMS {
            let k = f64::from(k);
            sum += power * 2.0 * k / (2.0 * k + 1.0);
            power *= -u2 / (k + 1.0);
        }
        return FRAC_2_SQRT_PI * sum / (SQRT_2 * sigma).powi(3);
    }
    (erf(u) - FRAC_2_SQRT_PI * u * (-u * u).exp()) / (distance * distance * distance)
}

/// V_cloud [1/m] of a unit q/(4πε) at distance r ≥ 0 [m], width σ [m].
#[must_use]
pub fn cloud_potential(distance: f64, sigma: f64) -> f64 {
    let u = distance / (SQRT_2 * sigma);
    if u < 1e-8 { SQRT_2_OVER_PI / sigma } else { erf(u) / distance }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Round-off with cancellation of erf near the series' end.
    const ROUND_OFF: f64 = 1e-13;
    /// Central difference: truncation and cancellation.
    const DIFFERENCE: f64 = 1e-7;

    #[test]
    fn exact_point() {
        // u = 1: erfc 1 = 0.157299207050285, (2/√π)/e = 0.415107497420594.
        let r = SQRT_2;
        let expected = (0.157_299_207_050_285_13 + 0.415_107_497_420_594_7) / r.powi(3);
        assert!((near_field_over_r(r, 1.0) / expected - 1.0).abs() < ROUND_OFF);
        assert!((near_potential(r, 1.0) * r / 0.157_299_207_050_285_13 - 1.0).abs() < ROUND_OFF);
    }

    #[test]
    fn limits() {
        let centre = SQRT_2_OVER_PI / 3.0;
        assert!((cloud_field_over_r(0.0, 1.0) / centre - 1.0).abs() < ROUND_OFF);
        assert!((cloud_potential(0.0, 1.0) / SQRT_2_OVER_PI - 1.0).abs() < ROUND_OFF);
        assert!((cloud_potential(1e-7, 1.0) / SQRT_2_OVER_PI - 1.0).abs() < ROUND_OFF);
        assert!((cloud_field_over_r(50.0, 1.0) * 125_000.0 - 1.0).abs() < ROUND_OFF);
        assert!((near_field_over_r(1e-3, 1.0) * 1e-9 - 1.0).abs() < 1e-9);
        assert!(near_field_over_r(10.0, 1.0) < 1e-20);
    }

    #[test]
    fn series_meets_closed_form() {
        let below = cloud_field_over_r(SQRT_2 * SERIES_BELOW_U * (1.0 - 1e-15), 1.0);
        let above = cloud_field_over_r(SQRT_2 * SERIES_BELOW_U, 1.0);
        assert!((below / above - 1.0).abs() < ROUND_OFF, "{below} {above}");
    }

    #[test]
    fn published_series_coefficients() {
        let (r, sigma) = (0.1_f64, 1.0);
        let u2 = r * r / 2.0;
        let expected =
            SQRT_2_OVER_PI / 3.0 * (1.0 - 3.0 * u2 / 5.0 + 3.0 * u2 * u2 / 14.0 - u2.powi(3) / 18.0);
        assert!((cloud_field_over_r(r, sigma) / expected - 1.0).abs() < 1e-10);
    }

    #[test]
    fn fields_are_minus_gradients() {
        let h = 1e-5;
        for r in [0.2, 0.7, 1.5, 4.0] {
            let near = -(near_potential(r + h, 0.8) - near_potential(r - h, 0.8)) / (2.0 * h);
            assert!((near_field_over_r(r, 0.8) * r / near - 1.0).abs() < DIFFERENCE);
            let cloud = -(cloud_potential(r + h, 0.8) - cloud_potential(r - h, 0.8)) / (2.0 * h);
            assert!((cloud_field_over_r(r, 0.8) * r / cloud - 1.0).abs() < DIFFERENCE);
        }
    }

    #[test]
    fn lengths_scale() {
        let (a, b) = (cloud_field_over_r(0.6, 0.5), cloud_field_over_r(6.0, 5.0));
        assert!((a / (1000.0 * b) - 1.0).abs() < ROUND_OFF);
    }
}
