//! Keys of `[[pairs]]`.

use super::{Form, Key};
use crate::limits::{FRICTION, SURFACE_ENERGY};
use crate::tree::Range;

pub(super) static KEYS: &[Key] = &[
    Key::new("between", Form::Texts, "Names of two materials, in any order, or of one twice.")
        .required()
        .example("[\"glass\", \"steel\"]")
        .also(&["materials", "pair", "types", "types_m"]),
    Key::new(
        "restitution",
        Form::Number(Range::positive(1.0)),
        "Coefficient of restitution of a central impact of the two.",
    )
    .without("the geometric mean of the two materials")
    .example("0.6")
    .also(&["coefficient_of_restitution", "coefficient_restitution", "cor"]),
    Key::new("friction", Form::Number(FRICTION), "Coefficient of sliding friction of the two.")
        .without("the smaller one of the two materials")
        .example("0.4")
        .also(&["mu", "friction_coefficient", "coefficient_friction", "sliding_friction"]),
    Key::new("rolling_friction", Form::Number(FRICTION), "Coefficient of rolling friction of the two.")
        .without("the smaller one of the two materials")
        .example("0.02")
        .also(&["mu_r", "rolling", "coefficient_rolling_friction"]),
    Key::new(
        "surface_energy_J_m2",
        Form::Number(SURFACE_ENERGY),
        "Half of the work of adhesion of the two, for contacts.cohesion.",
    )
    .unit("J/m²")
    .without("√(γ₁γ₂) of the two materials")
    .example("0.05")
    .also(&["surface_energy", "cohesion_energy", "gamma", "adhesion", "work_of_adhesion"]),
];
