//! Keys of `[output]`.

use super::{Form, Key};
use crate::limits::TIME;

pub(super) static KEYS: &[Key] = &[
    Key::new("every_s", Form::Number(TIME), "Time between files with all grains.")
        .unit("s")
        .without("at the start and the end alone")
        .example("1e-2")
        .also(&["every", "interval_s", "interval", "write_interval", "writeInterval", "dump_every"]),
    Key::new("history_every_s", Form::Number(TIME), "Time between rows of history.csv.")
        .unit("s")
        .without("a thousandth of the run, a step at least")
        .example("1e-3")
        .also(&["history", "log_every_s"]),
    Key::new("checkpoint_every_s", Form::Number(TIME), "Time between checkpoints.")
        .unit("s")
        .without("at the end, and when a run is stopped")
        .example("1e-2")
        .also(&["checkpoint", "restart_every_s"]),
    Key::new("formats", Form::Words(&["vtk", "csv", "png"]), "Kinds of the files with all grains.")
        .default("[\"vtk\"]")
        .example("[\"csv\", \"png\"]")
        .also(&["format", "vtu", "pictures"]),
];
