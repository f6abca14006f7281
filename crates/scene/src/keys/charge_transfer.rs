//! Keys of `[charge_transfer]`.

use super::{Form, Key};
use crate::tree::Range;

pub(super) static KEYS: &[Key] = &[
    Key::new(
        "beyond_previous_maximum",
        Form::Boolean,
        "Whether only area beyond a contact's largest so far moves charge.",
    )
    .default("false")
    .example("true"),
    Key::new(
        "breakdown_field_V_m",
        Form::Number(Range::positive(1e15)),
        "Field at a contact at which a transfer ends.",
    )
    .unit("V/m")
    .without("no limit")
    .example("3e6")
    .also(&["breakdown", "breakdown_field", "e_bd"]),
    Key::new("stiffness_correction", Form::Boolean, "Whether contact areas are those of the real stiffness.")
        .default("false")
        .example("true"),
    Key::new(
        "velocity_ratio",
        Form::Number(Range::positive(1e6)),
        "Speed of real impacts over that of soft ones.",
    )
    .default("1.0")
    .example("1.0"),
];
