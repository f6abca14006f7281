//! Questions of the DEM process.

use amberfield_wire::payloads::{FarQuestion, FlowQuestion, check_far_question};
use amberfield_wire::{Header, MessageKind, Section, Sections, WireError};

/// Question of the DEM process.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Question {
    /// The far field.
    Far(FarQuestion),
    /// The flow at the end of an interval.
    Flow(FlowQuestion),
    /// The state of the flow, for a checkpoint.
    State,
    /// A state of the flow to take in.
    Restore,
    /// Potentials that change, at some times.
    Potentials,
}

impl Question {
    /// Reads the question that a message asks.
    ///
    /// # Errors
    /// A message that asks nothing, numbers that are missing or cannot be used.
    pub fn read(header: &Header, sections: &Sections<'_>) -> Result<Self, WireError> {
        let is = |kind: MessageKind| header.kind == kind as u32;
        if is(MessageKind::Charges) {
            let question = sections.one::<FarQuestion>(Section::FarQuestion)?;
            check_far_question(question)?;
            Ok(Self::Far(*question))
        } else if is(MessageKind::Grains) {
            let question = sections.one::<FlowQuestion>(Section::FlowQuestion)?;
            question.check()?;
            Ok(Self::Flow(*question))
        } else if is(MessageKind::Checkpoint) {
            Ok(Self::State)
        } else if is(MessageKind::Restore) {
            Ok(Self::Restore)
        } else if is(MessageKind::Times) {
            Ok(Self::Potentials)
        } else {
            let Header { kind, solve, rank, ranks, .. } = *header;
            Err(WireError::Unexpected { kind, solve, rank, ranks })
        }
    }
}
