//! Keys of `[[walls]]`.

use super::{Form, Key};
use crate::limits::COORDINATE;
use crate::tree::Range;

static PLANE: &[Key] = &[
    Key::new("point_m", Form::Vector(COORDINATE), "Point of the plane.")
        .unit("m")
        .required()
        .example("[0.0, 0.0, 0.0]")
        .also(&["point", "origin", "position", "position_m", "base_m"]),
    Key::new(
        "normal",
        Form::Vector(Range::closed(-1e100, 1e100)),
        "Direction towards the grains, of any length.",
    )
    .required()
    .example("[0.0, 0.0, 1.0]")
    .also(&["direction", "n", "axis"]),
];

pub(super) static KEYS: &[Key] = &[
    Key::new("stl", Form::Text, "STL file with the wall's surface.")
        .without("plane, or patch")
        .example("\"hopper.stl\"")
        .also(&["file", "mesh", "obj", "geometry", "path"]),
    Key::new(
        "scale",
        Form::Number(Range::positive(1e6)),
        "Metres in a unit of the STL file; 1e-3 for millimetres.",
    )
    .default("1.0")
    .example("1e-3")
    .also(&["unit", "units", "factor"]),
    Key::new("plane", Form::Table(PLANE), "Plane without end.")
        .without("stl, or patch")
        .example("{ point_m = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }"),
    Key::new(
        "patch",
        Form::Text,
        "Patch of the solver's mesh with this surface; without stl its own faces are the wall.",
    )
    .without("a wall that the field does not know")
    .example("\"plate\""),
    Key::new("material", Form::Text, "Name of the wall's material.")
        .without("the scene's only material")
        .example("\"steel\""),
    Key::new(
        "charging",
        Form::Word(&["grounded", "insulating", "none"]),
        "How the wall takes charge at contacts: it flows off, it stays where it is, or there is none.",
    )
    .without("\"grounded\" for surfaces, \"none\" for planes")
    .example("\"insulating\"")
    .also(&["potential_V", "conducting", "conductor", "electric", "potential"]),
];
