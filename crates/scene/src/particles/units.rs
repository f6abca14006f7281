//! Unit styles of LAMMPS and LIGGGHTS, and their factors to SI.
//!
//! What each style means stands in the page `units` of the manual of LAMMPS, and the numbers are CODATA 2018.

use amberfield_core::constants::ELEMENTARY_CHARGE;

/// Atomic mass constant [kg], which is a gram per mole over Avogadro's number within 1e-9.
const ATOMIC_MASS: f64 = 1.660_539_066_60e-27;
/// Gram per mole, over Avogadro's number [kg].
const GRAM_PER_MOLE: f64 = 1e-3 / 6.022_140_76e23;
/// Bohr radius [m].
const BOHR: f64 = 5.291_772_109_03e-11;
/// Hartree energy [J].
const HARTREE: f64 = 4.359_744_722_207_1e-18;
/// Charge of one statcoulomb [C]: 1/(10 c) with c in m/s.
const STATCOULOMB: f64 = 1.0 / 2_997_924_580.0;

/// Unit style of a file, by the names of LAMMPS and LIGGGHTS.
///
/// The style `lj` has no units and is not among them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Units {
    /// Metres, kilograms, seconds, coulombs.
    Si,
    /// Centimetres, grams, seconds, statcoulombs.
    Cgs,
    /// Micrometres, picograms, microseconds, picocoulombs.
    Micro,
    /// Nanometres, attograms, nanoseconds, elementary charges.
    Nano,
    /// Ångströms, grams per mole, femtoseconds, elementary charges.
    Real,
    /// Ångströms, grams per mole, picoseconds, elementary charges.
    Metal,
    /// Bohr radii, atomic mass units, femtoseconds, elementary charges.
    Electron,
}

/// Units of a style in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Factors {
    /// Length [m].
    pub(crate) length: f64,
    /// Mass [kg].
    pub(crate) mass: f64,
    /// Time [s].
    pub(crate) time: f64,
    /// Velocity [m/s].
    pub(crate) velocity: f64,
    /// Charge [C].
    pub(crate) charge: f64,
    /// Density [kg/m³].
    pub(crate) density: f64,
}

impl Factors {
    /// Units that follow from those of length, mass and time.
    fn new(length: f64, mass: f64, time: f64, charge: f64) -> Self {
        Self { length, mass, time, velocity: length / time, charge, density: mass / length.powi(3) }
    }
}

impl Units {
    /// All styles.
    pub const ALL: [Self; 7] =
        [Self::Si, Self::Cgs, Self::Micro, Self::Nano, Self::Real, Self::Metal, Self::Electron];

    /// Names of all styles, in the order of [`Self::ALL`].
    pub(crate) const NAMES: [&str; 7] = ["si", "cgs", "micro", "nano", "real", "metal", "electron"];

    /// Name of the style.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// Style of a name, or what to do about another name.
    ///
    /// # Errors
    /// The style `lj`, and names that are none.
    pub fn named(name: &str) -> Result<Self, String> {
        match Self::ALL.into_iter().find(|units| name.eq_ignore_ascii_case(units.name())) {
            Some(units) => Ok(units),
            None if name.eq_ignore_ascii_case("lj") => {
                Err("lj has no units, so lengths and charges cannot be known; \
                                         write the file in another style"
                    .to_owned())
            }
            None => Err(format!("no unit style; give one of {}", Self::NAMES.join(", "))),
        }
    }

    /// Units of the style in SI.
    pub(crate) fn factors(self) -> Factors {
        match self {
            Self::Si => Factors::new(1.0, 1.0, 1.0, 1.0),
            // The densities of these are powers of ten, which a quotient of rounded numbers may miss.
            Self::Cgs => {
                Factors { velocity: 1e-2, density: 1e3, ..Factors::new(1e-2, 1e-3, 1.0, STATCOULOMB) }
            }
            Self::Micro => Factors { velocity: 1.0, density: 1e3, ..Factors::new(1e-6, 1e-15, 1e-6, 1e-12) },
            Self::Nano => {
                Factors { velocity: 1.0, density: 1e6, ..Factors::new(1e-9, 1e-21, 1e-9, ELEMENTARY_CHARGE) }
            }
            // LAMMPS reads and writes a sphere's density as mass over volume in these styles too, though its
            // manual counts densities of them in grams per cubic centimetre.
            Self::Real => {
                Factors { velocity: 1e5, ..Factors::new(1e-10, GRAM_PER_MOLE, 1e-15, ELEMENTARY_CHARGE) }
            }
            Self::Metal => {
                Factors { velocity: 1e2, ..Factors::new(1e-10, GRAM_PER_MOLE, 1e-12, ELEMENTARY_CHARGE) }
            }
            // Velocities are in Bohr radii per 1.03275 fs, which is a₀ √(u/E_h), and not per femtosecond.
            Self::Electron => Factors {
                velocity: (HARTREE / ATOMIC_MASS).sqrt(),
                ..Factors::new(BOHR, ATOMIC_MASS, 1e-15, ELEMENTARY_CHARGE)
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Digits of the numbers that the manual gives for a proton's charge.
    const MANUAL: f64 = 1e-7;
    /// Rounding of a few factors.
    const ROUND_OFF: f64 = 1e-14;

    fn agrees(found: f64, expected: f64, tolerance: f64) -> bool {
        (found / expected - 1.0).abs() < tolerance
    }

    #[test]
    fn a_proton_has_the_charge_that_the_manual_says_in_every_style() {
        for (units, proton) in [
            (Units::Si, 1.602_176_5e-19),
            (Units::Cgs, 4.803_204_4e-10),
            (Units::Micro, 1.602_176_5e-7),
            (Units::Nano, 1.0),
            (Units::Real, 1.0),
            (Units::Metal, 1.0),
            (Units::Electron, 1.0),
        ] {
            let charge = proton * units.factors().charge;
            assert!(agrees(charge, 1.602_176_634e-19, MANUAL), "{units:?}: {charge}");
        }
    }

    #[test]
    fn other_units_are_those_of_codata() {
        // Numbers of NIST's table: u, a₀, Avogadro's number; water in each style's density.
        assert!(agrees(Units::Electron.factors().mass, 1.660_539_066_60e-27, ROUND_OFF));
        assert!(agrees(Units::Electron.factors().length, 5.291_772_109_03e-11, ROUND_OFF));
        assert!(agrees(Units::Metal.factors().mass * 6.022_140_76e26, 1.0, ROUND_OFF));
        let time = Units::Electron.factors().length / Units::Electron.factors().velocity;
        assert!(agrees(time, 1.032_75e-15, 1e-5), "{time}");
        for (units, water) in [
            (Units::Si, 1e3),
            (Units::Cgs, 1.0),
            (Units::Micro, 1.0),
            (Units::Nano, 1e-3),
            (Units::Real, 0.602_214_076),
        ] {
            assert!(agrees(water * units.factors().density, 1e3, ROUND_OFF), "{units:?}");
        }
        for (units, sound) in [
            (Units::Si, 340.0),
            (Units::Cgs, 34_000.0),
            (Units::Micro, 340.0),
            (Units::Nano, 340.0),
            (Units::Real, 3.4e-3),
            (Units::Metal, 3.4),
        ] {
            let factors = units.factors();
            assert!(agrees(sound * factors.velocity, 340.0, ROUND_OFF), "{units:?}");
            assert!(agrees(factors.length / factors.time, factors.velocity, ROUND_OFF), "{units:?}");
        }
    }

    #[test]
    fn names_are_those_of_lammps_and_lj_is_refused() {
        for (units, name) in Units::ALL.into_iter().zip(Units::NAMES) {
            assert_eq!((Units::named(name), units.name()), (Ok(units), name));
        }
        assert!(Units::named("lj").unwrap_err().contains("has no units"));
        assert_eq!(Units::named("SI"), Ok(Units::Si));
        assert!(Units::named("metric").unwrap_err().contains("si, cgs, micro"));
    }
}
