//! Keys of `[contacts]`.

use super::{Form, Key};

pub(super) static KEYS: &[Key] =
    &[Key::new("rolling_model", Form::Word(&["epsd", "epsd2", "cdt"]), "Model of rolling friction.")
        .default("\"epsd\"")
        .example("\"epsd2\"")
        .also(&["rolling_friction", "rolling_friction_model", "rolling"])];
