//! Keys of `[time]`.

use super::{Form, Key};
use crate::limits::{LENGTH, TIME};
use crate::tree::Range;

pub(super) static KEYS: &[Key] = &[
    Key::new(
        "step_s",
        Form::Either(&[Form::Number(TIME), Form::Word(&["auto"])]),
        "Time step, or the largest that is safe.",
    )
    .unit("s")
    .required()
    .example("\"auto\"")
    .also(&["dt", "step", "timestep", "time_step", "time_step_s", "timestep_s", "delta_t", "deltaT"]),
    Key::new("end_s", Form::Number(TIME), "Time at which the run ends.")
        .unit("s")
        .required()
        .example("0.1")
        .also(&["end", "end_time", "endTime", "duration", "duration_s", "t_end", "stop_s"]),
    Key::new(
        "gravity_m_s2",
        Form::Vector(Range::closed(-1e9, 1e9)),
        "Acceleration of all grains by gravity.",
    )
    .unit("m/s²")
    .default("[0.0, 0.0, 0.0]")
    .example("[0.0, 0.0, -9.81]")
    .also(&["gravity", "g", "acceleration"]),
    Key::new(
        "skin_m",
        Form::Either(&[Form::Number(LENGTH), Form::Word(&["auto"])]),
        "Distance beyond contact up to which neighbours are listed.",
    )
    .unit("m")
    .default("\"auto\"")
    .example("1e-4")
    .also(&["skin", "verlet_skin", "neighbor"]),
    Key::new("allow_unstable", Form::Boolean, "Whether a step above the limits is taken.")
        .default("false")
        .example("true"),
];
