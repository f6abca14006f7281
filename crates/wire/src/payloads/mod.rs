//! Structures that a message carries beside its arrays: one a file, with its layout.
//!
//! They have no padding and hold only `f64` and `u64`, so that any bytes are a value. A yes or no is the
//! number 1 or 0.

mod boundary_face;
mod far_answer;
mod far_question;
mod flow_answer;
mod flow_question;
mod mesh_outline;

pub use amberfield_core::{FarQuestion, SourceCloud};
pub use boundary_face::BoundaryFace;
pub use far_answer::FarAnswer;
pub use far_question::check_far_question;
pub use flow_answer::FlowAnswer;
pub use flow_question::FlowQuestion;
pub use mesh_outline::MeshOutline;

use crate::{Section, WireError};

/// Refuses a number that is not sound.
fn require(sound: bool, section: Section, name: &'static str, value: f64) -> Result<(), WireError> {
    if sound { Ok(()) } else { Err(WireError::Field { section, name, value }) }
}
