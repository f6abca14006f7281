//! Keys of `[gas]`.

use super::{Form, Key};
use crate::limits::TIME;
use crate::tree::Range;

pub(super) static KEYS: &[Key] = &[
    Key::new(
        "flow",
        Form::Word(&["uniform", "solver"]),
        "Flow of the gas: the same everywhere, or computed by [solver].",
    )
    .default("\"uniform\"")
    .example("\"solver\"")
    .also(&["coupling", "cfd"]),
    Key::new(
        "drag",
        Form::Word(&["schiller_naumann", "stokes", "di_felice", "gidaspow", "beetstra"]),
        "Law of drag.",
    )
    .default("\"schiller_naumann\"")
    .example("\"gidaspow\"")
    .also(&["drag_law", "drag_model", "law"]),
    Key::new("density_kg_m3", Form::Number(Range::closed(0.0, 1e6)), "Density of the gas.")
        .unit("kg/m³")
        .default("1.204")
        .example("1.2")
        .also(&["density", "rho"]),
    Key::new("viscosity_Pa_s", Form::Number(Range::positive(1e6)), "Dynamic viscosity of the gas.")
        .unit("Pa·s")
        .default("1.82e-5")
        .example("1.8e-5")
        .also(&["viscosity", "mu", "nu", "viscosity_m2_s"]),
    Key::new("velocity_m_s", Form::Vector(Range::closed(-1e6, 1e6)), "Velocity of a uniform gas.")
        .unit("m/s")
        .default("[0.0, 0.0, 0.0]")
        .example("[0.0, 0.0, 0.5]")
        .also(&["velocity", "u", "wind", "speed"]),
    Key::new("magnus_lift", Form::Boolean, "Whether grains that spin are lifted.")
        .default("false")
        .example("true"),
    Key::new(
        "model",
        Form::Word(&["A", "B"]),
        "Who bears the pressure gradient: grains and gas, or the gas alone.",
    )
    .default("\"A\"")
    .example("\"B\""),
    Key::new(
        "interval_s",
        Form::Number(TIME),
        "Time between exchanges of momentum with a computed flow, which needs it.",
    )
    .unit("s")
    .without("an error where the flow is computed")
    .example("1e-4")
    .also(&["interval", "coupling_interval", "coupling_interval_s"]),
    Key::new(
        "smoothing_length_m",
        Form::Number(Range::positive(1e3)),
        "Length over which a grain is spread among cells.",
    )
    .unit("m")
    .without("what cells and grains ask for")
    .example("3e-3")
    .also(&["smoothing_length", "smoothing", "bandwidth"]),
    Key::new("viscous_force", Form::Boolean, "Whether grains feel the gas's viscous stress.")
        .default("false")
        .example("true"),
    Key::new("saffman_lift", Form::Boolean, "Whether grains are lifted where the gas shears.")
        .default("false")
        .example("true"),
    Key::new("overlap", Form::Boolean, "Whether the gas flows on while the grains move.")
        .default("false")
        .example("true"),
];
