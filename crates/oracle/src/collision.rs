//! Head-on impacts of two equal spheres: Hertz's closed forms and the charge that one impact moves.

use std::f64::consts::PI;

/// Elastic head-on impact of two spheres with Hertz's contact force F = (4/3) Y* √R* δ^{3/2}.
///
/// Source: Johnson, *Contact Mechanics* (1985), §11.4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HertzImpact {
    /// Reduced mass m*, 1/m* = 1/m_i + 1/m_j [kg].
    pub reduced_mass: f64,
    /// Reduced radius R*, 1/R* = 1/r_i + 1/r_j [m].
    pub reduced_radius: f64,
    /// Reduced modulus Y* [Pa].
    pub reduced_young: f64,
    /// Relative speed v before the impact [m/s].
    pub speed: f64,
}

/// Factor of the contact time: 2√π Γ(7/5)/Γ(9/10) = 2 ∫₀¹ dx/√(1 − x^{5/2}).
const HERTZ_TIME: f64 = 2.943_275_128;

impl HertzImpact {
    /// Impact of two equal spheres: radius [m], density [kg/m³], Young's modulus [Pa], Poisson ratio,
    /// relative speed [m/s].
    #[must_use]
    pub fn equal_spheres(radius: f64, density: f64, young: f64, poisson: f64, speed: f64) -> Self {
        Self {
            reduced_mass: 0.5 * (4.0 / 3.0) * PI * radius.powi(3) * density,
            reduced_radius: 0.5 * radius,
            reduced_young: 0.5 * young / (1.0 - poisson * poisson),
            speed,
        }
    }

    /// Largest overlap δ_max = (15 m* v²/(16 Y* √R*))^{2/5} [m].
    #[must_use]
    pub fn largest_overlap(&self) -> f64 {
        let stiffness = 16.0 * self.reduced_young * self.reduced_radius.sqrt();
        (15.0 * self.reduced_mass * self.speed * self.speed / stiffness).powf(0.4)
    }

    /// Time in contact t_c = 2.9433 δ_max/v [s].
    #[must_use]
    pub fn contact_time(&self) -> f64 {
        HERTZ_TIME * self.largest_overlap() / self.speed
    }

    /// Largest force (4/3) Y* √R* δ_max^{3/2} [N].
    #[must_use]
    pub fn largest_force(&self) -> f64 {
        4.0 / 3.0 * self.reduced_young * self.reduced_radius.sqrt() * self.largest_overlap().powf(1.5)
    }
}

/// Head-on impact of two spheres with Hertz's force and the damping 2√(5/6) β √(S_n m*) v_n, S_n = 2 Y* √(R*
/// δ).
///
/// The variable x = δ^{5/4} is then a damped linear oscillator of frequency ω = √(4k/(5 m*)) in its own time,
/// with k = (4/3) Y* √R*: δ_max^{5/4} = (v/ω) exp(−(β/√(1 − β²)) acos β), β = −ln e/√(ln²e + π²).
///
/// Source: Antypov & Elliott, EPL 94, 50004 (2011).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DampedHertzImpact {
    /// Impact without the damping.
    pub elastic: HertzImpact,
    /// Coefficient of restitution e in (0, 1].
    pub restitution: f64,
}

impl DampedHertzImpact {
    /// Largest overlap δ_max [m].
    #[must_use]
    pub fn largest_overlap(&self) -> f64 {
        let elastic = &self.elastic;
        let log = self.restitution.ln();
        let damping = -log / (log * log + PI * PI).sqrt();
        let stiffness = 4.0 / 3.0 * elastic.reduced_young * elastic.reduced_radius.sqrt();
        let frequency = (0.8 * stiffness / elastic.reduced_mass).sqrt();
        // Share of the amplitude that is left at the turning point.
        let left = (-(damping / (1.0 - damping * damping).sqrt()) * damping.acos()).exp();
        (elastic.speed / frequency * left).powf(0.8)
    }

    /// Charge q (1 − e^{−δ_max/(4r)}) [C] that moves between equal spheres of radius r [m] with charges +q
    /// and −q [C], equal work functions and no field but their own.
    #[must_use]
    pub fn charge_moved(&self, radius: f64, charge: f64) -> f64 {
        -charge * (-self.largest_overlap() / (4.0 * radius)).exp_m1()
    }
}

/// Row of [`COLLISION_CHARGES`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollisionCharge {
    /// Coefficient of restitution e.
    pub restitution: f64,
    /// Young's modulus Y [Pa].
    pub young: f64,
    /// Charge moved by one impact [C].
    pub charge: f64,
}

/// Charges [C] that one head-on impact moves between two equal spheres.
///
/// Radius 75 µm, density 1000 kg/m³, Poisson ratio 0.3, charges ±1e-13 C, equal work functions, relative
/// speed 0.1 m/s, electric force off.
pub const COLLISION_CHARGES: [CollisionCharge; 12] = [
    row(1.0, 1e5, 1.1934e-15),
    row(1.0, 1e6, 4.7681e-16),
    row(1.0, 1e7, 1.9010e-16),
    row(1.0, 1e8, 7.5722e-17),
    row(0.9, 1e5, 1.14545e-15),
    row(0.9, 1e6, 4.57592e-16),
    row(0.9, 1e7, 1.82422e-16),
    row(0.9, 1e8, 7.26635e-17),
    row(0.3, 1e5, 8.26349e-16),
    row(0.3, 1e6, 3.29797e-16),
    row(0.3, 1e7, 1.31425e-16),
    row(0.3, 1e8, 5.23420e-17),
];

const fn row(restitution: f64, young: f64, charge: f64) -> CollisionCharge {
    CollisionCharge { restitution, young, charge }
}

/// Equilibrium charge of a grain on a grounded wall per electronvolt of W_p − W_w [C/eV].
///
/// Q_eq = −2πr²ε(W_p − W_w)/(δe) for a radius r = 75 µm and a cut-off distance δ = 500 nm.
pub const EQUILIBRIUM_CHARGE_PER_EV: f64 = -6.2587e-13;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_follows_from_the_closed_form() {
        for expected in COLLISION_CHARGES {
            let elastic = HertzImpact::equal_spheres(75e-6, 1000.0, expected.young, 0.3, 0.1);
            let impact = DampedHertzImpact { elastic, restitution: expected.restitution };
            let charge = impact.charge_moved(75e-6, 1e-13);
            // The table has five or six digits.
            assert!((charge / expected.charge - 1.0).abs() < 3e-5, "{expected:?}: {charge:e}");
        }
    }

    #[test]
    fn no_damping_is_hertz() {
        let elastic = HertzImpact::equal_spheres(1e-3, 2500.0, 1e7, 0.22, 0.5);
        let damped = DampedHertzImpact { elastic, restitution: 1.0 };
        assert!((damped.largest_overlap() / elastic.largest_overlap() - 1.0).abs() < 1e-13);
    }

    #[test]
    fn work_of_the_contact_force_is_the_kinetic_energy() {
        let impact = HertzImpact::equal_spheres(1e-3, 2500.0, 1e7, 0.22, 0.5);
        let work = 0.4 * impact.largest_force() * impact.largest_overlap();
        let kinetic = 0.5 * impact.reduced_mass * impact.speed * impact.speed;
        assert!((work / kinetic - 1.0).abs() < 1e-13);
    }

    #[test]
    fn contact_time_is_the_integral_over_the_overlap() {
        // x = 1 − s² takes the root singularity at the turning point out of ∫ dx/√(1 − x^{5/2}).
        let count = 20_000;
        let sum: f64 = (0..count)
            .map(|index| {
                let s = (f64::from(index) + 0.5) / f64::from(count);
                2.0 * s / (1.0 - (1.0 - s * s).powf(2.5)).sqrt()
            })
            .sum();
        assert!((2.0 * sum / f64::from(count) - HERTZ_TIME).abs() < 1e-7);
    }

    #[test]
    fn equilibrium_charge_is_its_closed_form() {
        use amberfield_core::constants::VACUUM_PERMITTIVITY;
        // One electronvolt over e is one volt.
        let closed = -2.0 * PI * 75e-6_f64.powi(2) * VACUUM_PERMITTIVITY / 500e-9;
        assert!((closed / EQUILIBRIUM_CHARGE_PER_EV - 1.0).abs() < 1e-4, "{closed:e}");
    }
}
