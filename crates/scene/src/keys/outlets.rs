//! Keys of `[[outlets]]`.

use super::particles::VOLUME;
use super::{Form, Key};
use amberfield_core::Axis;

pub(super) static KEYS: &[Key] = &[
    Key::new("name", Form::Text, "Name in messages and results, which no other outlet has.")
        .required()
        .example("\"left bin\"")
        .also(&["id", "title"]),
    Key::new("region", Form::Table(VOLUME), "Volume; a grain leaves as soon as its centre is in it.")
        .without("face")
        .example("{ box = { min_m = [0.0, 0.0, 0.0], max_m = [0.1, 0.1, 0.01] } }")
        .also(&["place", "volume", "where", "box", "bin"]),
    Key::new(
        "face",
        Form::Word(&Axis::FACE_NAMES),
        "Face of the domain; it takes the grains that reach it, whatever `particles.on_exit` says.",
    )
    .without("region")
    .example("\"z_min\"")
    .also(&["side", "boundary", "patch"]),
    Key::new(
        "each",
        Form::Boolean,
        "Whether `outlets_grains.csv` has a row for each grain that leaves here.",
    )
    .default("false")
    .example("true")
    .also(&["every_grain", "rows", "list"]),
];
