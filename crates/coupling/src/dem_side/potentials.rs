//! Potentials of patches that change with time, which the field process tells at any time.

use super::far::RemoteSolver;
use super::shared::locked;
use crate::CouplingError;
use amberfield_field::far::FarField;
use amberfield_wire::{Layout, MessageKind, Section};

impl RemoteSolver {
    /// Asks for the potentials of the patches that change, at some times [s], and waits for them.
    pub(super) fn ask_for_potentials(
        &mut self,
        times_s: &[f64],
        values: &mut Vec<f64>,
    ) -> Result<(), CouplingError> {
        values.clear();
        let count = times_s.len() * self.mesh().changing().len();
        if count == 0 {
            return Ok(());
        }
        let shared = &mut *locked(&self.shared);
        shared.clear_the_way()?;
        let layout = |layout: Layout| layout.with::<f64>(Section::Times, times_s.len());
        shared.remote.ask(MessageKind::Times, layout, |layout, payload| {
            layout.section_mut::<f64>(payload, Section::Times)?.copy_from_slice(times_s);
            Ok(())
        })?;
        shared.remote.collect(MessageKind::Potentials, |_, rank, sections| {
            let potentials = sections.exactly::<f64>(Section::PatchPotentials, count)?;
            // All ranks know the same.
            if rank == 0 {
                values.extend(potentials);
            }
            Ok(())
        })
    }
}
