//! Keys of `[domain]`.

use super::{Form, Key, course};
use crate::limits::{COORDINATE, ELECTRIC};

/// Conditions of a face that are given as a word.
pub(crate) const FACE_WORDS: &[&str] = &["grounded", "insulating", "periodic", "open"];

static FACE: &[Key] = &[
    Key::new(
        "potential_V",
        Form::Either(&[Form::Number(ELECTRIC), Form::Table(course::POTENTIAL)]),
        "Potential of a conductor; a table gives one that changes with time.",
    )
    .unit("V")
    .example("1000.0")
    .also(&["potential", "voltage", "v", "dirichlet", "fixed_value"]),
    Key::new("normal_field_V_m", Form::Number(ELECTRIC), "Field that leaves the box through an insulator.")
        .unit("V/m")
        .example("0.0")
        .also(&["field", "neumann", "flux", "fixed_gradient", "normal_field"]),
];
const CONDITION: Form = Form::Either(&[Form::Word(FACE_WORDS), Form::Table(FACE)]);

const fn face(name: &'static str, meaning: &'static str) -> Key {
    Key::new(name, CONDITION, meaning).without("the key of the axis").example("\"grounded\"")
}

const fn axis(name: &'static str, meaning: &'static str) -> Key {
    Key::new(name, CONDITION, meaning).without("the keys of both faces").example("\"periodic\"")
}

static BOUNDARY: &[Key] = &[
    axis("x", "Condition on both faces across x."),
    face("x_min", "Condition on the lower face across x."),
    face("x_max", "Condition on the upper face across x.").example("{ potential_V = 1000.0 }"),
    axis("y", "Condition on both faces across y."),
    face("y_min", "Condition on the lower face across y."),
    face("y_max", "Condition on the upper face across y."),
    axis("z", "Condition on both faces across z.").example("\"open\""),
    face("z_min", "Condition on the lower face across z."),
    face("z_max", "Condition on the upper face across z.").example("{ potential_V = 1000.0 }"),
];

pub(super) static KEYS: &[Key] = &[
    Key::new("min_m", Form::Vector(COORDINATE), "Lower corner of the box.")
        .unit("m")
        .required()
        .example("[0.0, 0.0, 0.0]")
        .also(&["min", "lower", "from", "from_m", "origin", "lo", "corner"]),
    Key::new(
        "max_m",
        Form::Vector(COORDINATE),
        "Upper corner of the box, above the lower one on every axis.",
    )
    .unit("m")
    .required()
    .example("[0.01, 0.01, 0.02]")
    .also(&["max", "upper", "to", "to_m", "size", "size_m", "extent", "length", "hi"]),
    Key::new(
        "boundary",
        Form::Table(BOUNDARY),
        "Condition of the field on each face; grains wrap at periodic ones and leave through open ones.",
    )
    .required()
    .example("{ x = \"periodic\", y = \"periodic\", z_min = \"grounded\", z_max = { potential_V = 1000.0 } }")
    .also(&["boundaries", "boundary_conditions", "bc", "faces", "periodic"]),
];
