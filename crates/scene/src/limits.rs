//! Ranges of values; a value beyond is a mistake, such as a wrong unit or a lost exponent.

use crate::tree::Range;

/// Coordinates [m].
pub(crate) const COORDINATE: Range = Range::closed(-1e6, 1e6);
/// Lengths [m].
pub(crate) const LENGTH: Range = Range::positive(1e6);
/// Radii of grains [m].
pub(crate) const RADIUS: Range = Range::closed(1e-12, 1e3);
/// Radii of particles that need no size [m].
pub(crate) const RADIUS_OR_POINT: Range = Range::closed(0.0, 1e3);
/// Masses of grains [kg].
pub(crate) const MASS: Range = Range::closed(1e-40, 1e15);
/// Densities [kg/m³].
pub(crate) const DENSITY: Range = Range::closed(1e-6, 1e9);
/// Young's moduli [Pa].
pub(crate) const YOUNG: Range = Range::closed(1e-3, 1e15);
/// Charges [C]; the range is wide, since textbooks and test sets use unit charges.
pub(crate) const CHARGE: Range = Range::closed(-1e6, 1e6);
/// Velocities [m/s] and angular velocities [rad/s] of grains.
pub(crate) const SPEED: Range = Range::closed(-1e9, 1e9);
/// Times [s].
pub(crate) const TIME: Range = Range::positive(1e9);
/// Potentials [V] and fields [V/m].
pub(crate) const ELECTRIC: Range = Range::closed(-1e15, 1e15);
/// Fractions.
pub(crate) const FRACTION: Range = Range::closed(0.0, 1.0);
/// Friction coefficients.
pub(crate) const FRICTION: Range = Range::closed(0.0, 1e3);
/// Surface energies [J/m²]; those of solids lie below 10.
pub(crate) const SURFACE_ENERGY: Range = Range::closed(0.0, 1e3);
/// Tolerances.
pub(crate) const TOLERANCE: Range = Range::closed(1e-12, 1.0);
/// Largest number of particles of a generator.
pub(crate) const GRAINS: i64 = 100_000_000;
