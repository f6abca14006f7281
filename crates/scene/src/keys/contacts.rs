//! Keys of `[contacts]`.

use super::{Form, Key};

pub(super) static KEYS: &[Key] = &[
    Key::new("rolling_model", Form::Word(&["epsd", "epsd2", "cdt"]), "Model of rolling friction.")
        .default("\"epsd\"")
        .example("\"epsd2\"")
        .also(&["rolling_friction", "rolling_friction_model", "rolling"]),
    Key::new(
        "cohesion",
        Form::Word(&["none", "dmt", "jkr"]),
        "Model by which touching bodies stick; it needs a surface_energy_J_m2 of materials or pairs.",
    )
    .default("\"none\"")
    .example("\"jkr\"")
    .also(&["adhesion", "cohesion_model", "sjkr", "jkr"]),
];
