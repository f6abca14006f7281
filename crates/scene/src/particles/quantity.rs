//! Names of columns: those of this project, and those in other units.

use amberfield_core::constants::ELEMENTARY_CHARGE;

/// Column of a file of grains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Quantity {
    /// Name of the column that it stands for, in this project's unit.
    pub(super) name: &'static str,
    /// Factor from the file's unit to that of the name.
    pub(super) factor: f64,
}

/// Units, and the factors from them to this project's.
type Units = &'static [(&'static str, f64)];

const LENGTHS: Units =
    &[("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("um", 1e-6), ("µm", 1e-6), ("μm", 1e-6), ("nm", 1e-9)];
const CHARGES: Units = &[
    ("C", 1.0),
    ("mC", 1e-3),
    ("uC", 1e-6),
    ("µC", 1e-6),
    ("μC", 1e-6),
    ("nC", 1e-9),
    ("pC", 1e-12),
    ("fC", 1e-15),
    ("e", ELEMENTARY_CHARGE),
];
const SPEEDS: Units = &[("m_s", 1.0), ("cm_s", 1e-2), ("mm_s", 1e-3)];
const SPINS: Units = &[("rad_s", 1.0), ("rpm", std::f64::consts::PI / 30.0)];
const MASSES: Units = &[
    ("kg", 1.0),
    ("g", 1e-3),
    ("mg", 1e-6),
    ("ug", 1e-9),
    ("µg", 1e-9),
    ("μg", 1e-9),
    ("ng", 1e-12),
    ("pg", 1e-15),
];
const DENSITIES: Units = &[("kg_m3", 1.0), ("g_cm3", 1e3)];

/// Columns of one kind and their units.
struct Stem {
    /// Names without a unit.
    names: &'static [&'static str],
    /// Column that they stand for, in this project's unit.
    known: &'static str,
    /// Units that may follow the name.
    units: Units,
    /// Further factor, of a diameter for example.
    factor: f64,
}

const fn stem(names: &'static [&'static str], known: &'static str, units: Units, factor: f64) -> Stem {
    Stem { names, known, units, factor }
}

const STEMS: &[Stem] = &[
    stem(&["x"], "x_m", LENGTHS, 1.0),
    stem(&["y"], "y_m", LENGTHS, 1.0),
    stem(&["z"], "z_m", LENGTHS, 1.0),
    stem(&["radius", "r"], "radius_m", LENGTHS, 1.0),
    stem(&["diameter", "d"], "radius_m", LENGTHS, 0.5),
    stem(&["charge", "q"], "charge_C", CHARGES, 1.0),
    stem(&["vx"], "vx_m_s", SPEEDS, 1.0),
    stem(&["vy"], "vy_m_s", SPEEDS, 1.0),
    stem(&["vz"], "vz_m_s", SPEEDS, 1.0),
    stem(&["wx", "omegax"], "wx_rad_s", SPINS, 1.0),
    stem(&["wy", "omegay"], "wy_rad_s", SPINS, 1.0),
    stem(&["wz", "omegaz"], "wz_rad_s", SPINS, 1.0),
    stem(&["density"], "density_kg_m3", DENSITIES, 1.0),
    stem(&["mass", "m"], "mass_kg", MASSES, 1.0),
];

impl Quantity {
    /// Quantity of a column whose name has its unit, or needs none.
    pub(super) fn named(name: &str) -> Option<Self> {
        if let Some(known) = ["id", "material", "group"].into_iter().find(|known| *known == name) {
            return Some(Self { name: known, factor: 1.0 });
        }
        let (stem, unit) = name.split_once('_')?;
        let Stem { known, units, factor, .. } = STEMS.iter().find(|known| known.names.contains(&stem))?;
        let (_, scale) = units.iter().find(|(name, _)| *name == unit)?;
        Some(Self { name: known, factor: factor * scale })
    }

    /// Names with a unit that a name without one may stand for; `None` where there are none.
    pub(super) fn unit_missing(name: &str) -> Option<String> {
        let plain = name.to_lowercase();
        let Stem { names, units, .. } = STEMS.iter().find(|stem| stem.names.contains(&plain.as_str()))?;
        let stem = names.iter().find(|stem| **stem == plain)?;
        let names: Vec<String> = units.iter().take(4).map(|(unit, _)| format!("{stem}_{unit}")).collect();
        Some(names.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_follow_names() {
        for (name, known, factor) in [
            ("x_mm", "x_m", 1e-3),
            ("diameter_um", "radius_m", 0.5e-6),
            ("charge_e", "charge_C", 1.602_176_634e-19),
            ("q_pC", "charge_C", 1e-12),
            ("density_g_cm3", "density_kg_m3", 1e3),
            ("vx_mm_s", "vx_m_s", 1e-3),
            ("mass_ug", "mass_kg", 1e-9),
            ("material", "material", 1.0),
        ] {
            assert_eq!(Quantity::named(name), Some(Quantity { name: known, factor }), "{name}");
        }
        for name in ["x", "x_ft", "volume_m3", "", "_m"] {
            assert_eq!(Quantity::named(name), None, "{name}");
        }
        assert_eq!(Quantity::unit_missing("X").as_deref(), Some("x_m, x_cm, x_mm, x_um"));
    }
}
