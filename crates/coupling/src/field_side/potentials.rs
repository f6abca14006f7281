//! The field side of potentials that change with time: for which times they are asked for, and the answer.

use super::side::FieldSide;
use crate::CouplingError;
use amberfield_wire::{Layout, MessageKind, Section};

impl FieldSide {
    /// Times at which the potentials of patches that change are asked for [s].
    ///
    /// # Errors
    /// Another question.
    pub fn times(&self) -> Result<&[f64], CouplingError> {
        self.section(Section::Times)
    }

    /// Answers the question for the potentials [V] of the patches that change: patch by patch, all times of
    /// each. One that is not known is no number.
    ///
    /// # Errors
    /// A DEM process that is gone.
    pub fn reply_potentials(&mut self, potentials: &[f64]) -> Result<(), CouplingError> {
        let layout = Layout::new(self.header_of_answer(MessageKind::Potentials)?)
            .with::<f64>(Section::PatchPotentials, potentials.len());
        self.answer(&layout, |payload| {
            layout.section_mut::<f64>(payload, Section::PatchPotentials)?.copy_from_slice(potentials);
            Ok(())
        })
    }
}
