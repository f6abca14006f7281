//! Green function of −∇² around an axis, cut at a cylinder.
//!
//! A wave κ along the axis has the Green function K₀(κρ)/2π across it, or −ln(ρ/u)/2π for κ = 0. Cut at ρ = R
//! its transform is T/(s² + κ²), s the wave number across, with
//!
//! ```text
//! T − 1 = sR J₁(sR) K₀(κR) − κR J₀(sR) K₁(κR)       κ > 0
//! T − 1 = −J₀(sR) − sR J₁(sR) ln(R/u)               κ = 0
//! ```
//!
//! after F. Vico, L. Greengard & M. Ferrando, J. Comput. Phys. 323, 191 (2016), from ∫₀ᴿ K₀(κρ) J₀(sρ) ρ dρ
//! (Lommel; Watson, Theory of Bessel Functions, § 5.11).

use libm::{j0, j1};

/// Argument beyond which K₀ and K₁ are below round-off beside 1.
const LAST: f64 = 40.0;

/// Green function of one wave along the axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CutLine {
    radius: f64,
    /// Factors of sR J₁(sR) and of J₀(sR).
    factors: [f64; 2],
    /// Transform where both wave numbers are zero [m²].
    at_origin: f64,
}

impl CutLine {
    /// The function of wave number κ [1/m], cut at a radius [m]; `unit` is u [m].
    pub(crate) fn new(kappa: f64, radius: f64, unit: f64) -> Self {
        let factors = if kappa > 0.0 {
            let [zeroth, first] = modified(kappa * radius);
            [zeroth, -kappa * radius * first]
        } else {
            [-(radius / unit).ln(), -1.0]
        };
        let at_origin = radius * radius * (0.25 - 0.5 * (radius / unit).ln());
        Self { radius, factors, at_origin }
    }

    /// sR J₁(sR) and J₀(sR) at a wave number s across the axis [1/m].
    pub(crate) fn waves(&self, across: f64) -> [f64; 2] {
        waves(across * self.radius)
    }

    /// T − 1 with what [`waves`] gives.
    pub(crate) fn change(&self, waves: [f64; 2]) -> f64 {
        self.factors[0] * waves[0] + self.factors[1] * waves[1]
    }

    /// T/(s² + κ²) for s = κ = 0 [m²].
    pub(crate) fn at_origin(&self) -> f64 {
        self.at_origin
    }
}

/// z J₁(z) and J₀(z).
pub(crate) fn waves(z: f64) -> [f64; 2] {
    [z * j1(z), j0(z)]
}

/// K₀(z) and K₁(z) = ∫₀^∞ e^{−z cosh t} cosh(νt) dt, z > 0, by the trapezoidal rule, which errs by e^{−π²/h}.
fn modified(z: f64) -> [f64; 2] {
    const STEP: f64 = 0.25;
    if z > LAST {
        return [0.0; 2];
    }
    let end = (2.0 * (LAST + z) / z).ln() + 1.0;
    let mut sums = [0.5 * (-z).exp(); 2];
    for t in (1_u32..).map(|n| STEP * f64::from(n)).take_while(|t| *t < end) {
        let value = (-z * t.cosh()).exp();
        sums[0] += value;
        sums[1] += value * t.cosh();
    }
    sums.map(|sum| STEP * sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modified_functions_match_tables() {
        // Abramowitz & Stegun, table 9.8, and K₀ of small arguments, −ln(z/2) − γ.
        for (z, zeroth, first) in [
            (1.0, 0.421_024_438_240_708_34, 0.601_907_230_197_234_6),
            (5.0, 0.003_691_098_334_042_594, 0.004_044_613_445_452_164),
            (0.1, 2.427_069_024_702_017, 9.853_844_780_870_606),
        ] {
            let found = modified(z);
            assert!((found[0] / zeroth - 1.0).abs() < 1e-14, "{z}: {found:?}");
            assert!((found[1] / first - 1.0).abs() < 1e-14, "{z}: {found:?}");
        }
        let small = 1e-9_f64;
        let expected = -(0.5 * small).ln() - 0.577_215_664_901_532_9;
        assert!((modified(small)[0] / expected - 1.0).abs() < 1e-13);
    }

    /// Integral of the function itself against J₀, by the midpoint rule in ρ².
    #[test]
    fn transform_is_the_integral_up_to_the_cut() {
        let (radius, unit) = (1.7, 0.6);
        for (kappa, across) in [(0.0, 2.3), (1.4, 0.0), (1.4, 3.9), (0.0, 1e-6)] {
            let count = 400_000;
            let sum: f64 = (0..count)
                .map(|n| {
                    // ρ = R u², which tames the logarithm.
                    let u = (f64::from(n) + 0.5) / f64::from(count);
                    let rho = radius * u * u;
                    let green = if kappa > 0.0 { modified(kappa * rho)[0] } else { -(rho / unit).ln() };
                    green * j0(across * rho) * rho * 2.0 * radius * u / f64::from(count)
                })
                .sum();
            let line = CutLine::new(kappa, radius, unit);
            let total: f64 = kappa * kappa + across * across;
            let found = if across < 1e-3 && kappa == 0.0 {
                line.at_origin()
            } else {
                (1.0 + line.change(line.waves(across))) / total
            };
            assert!((found - sum).abs() < 1e-8, "{kappa} {across}: {found} {sum}");
        }
    }
}
