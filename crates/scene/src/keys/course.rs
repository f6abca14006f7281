//! Keys of potentials and fields that change with time.

use super::{Form, Key};
use crate::limits::ELECTRIC;
use crate::tree::Range;

const fn amplitude(form: Form, example: &'static str) -> Key {
    Key::new("amplitude", form, "Amplitude of the sine, in the unit of the key.")
        .without("a table")
        .example(example)
        .also(&["peak", "amplitude_V", "amplitude_V_m"])
}

const FREQUENCY: Key = Key::new("frequency_Hz", Form::Number(Range::positive(1e12)), "Periods in a second.")
    .unit("Hz")
    .without("a table")
    .example("50.0")
    .also(&["frequency", "period", "period_s", "omega", "f"]);

const PHASE: Key = Key::new("phase_rad", Form::Number(Range::closed(-1e6, 1e6)), "Phase at t = 0.")
    .unit("rad")
    .without("zero")
    .example("1.5708")
    .also(&["phase"]);

const fn offset(form: Form, example: &'static str) -> Key {
    Key::new("offset", form, "Mean over a period, in the unit of the key.")
        .without("zero")
        .example(example)
        .also(&["mean", "dc", "bias"])
}

const fn table(meaning: &'static str, example: &'static str) -> Key {
    Key::new("table", Form::Text, meaning).without("a sine").example(example).also(&["file", "csv"])
}

/// Keys of a potential that changes.
pub(super) static POTENTIAL: &[Key] = &[
    amplitude(Form::Number(ELECTRIC), "1000.0"),
    FREQUENCY,
    PHASE,
    offset(Form::Number(ELECTRIC), "0.0"),
    table("File of the potential over time: t_s, potential_V; with lines between rows.", "\"v.csv\""),
];

/// Keys of a field that changes.
pub(super) static FIELD: &[Key] = &[
    amplitude(Form::Vector(ELECTRIC), "[0.0, 0.0, 1e5]"),
    FREQUENCY,
    PHASE,
    offset(Form::Vector(ELECTRIC), "[0.0, 0.0, 0.0]"),
    table(
        "File of the field over time: t_s, ex_V_per_m, ey_V_per_m, ez_V_per_m; with lines between rows.",
        "\"e.csv\"",
    ),
];
