//! The field side of a gas's flow: what the grains do to it, and the answer.

use super::side::{FieldSide, of_dem};
use crate::CouplingError;
use amberfield_wire::payloads::FlowAnswer;
use amberfield_wire::{Element, Header, Layout, MessageKind, Section, Sections, WireError};
use std::ops::Range;

/// Answer of a rank to the question for the flow, at its cell centres.
#[derive(Clone, Copy, Debug)]
pub struct FlowReply<'a> {
    /// Velocity u of the gas [m/s].
    pub velocity: &'a [[f64; 3]],
    /// Pressure gradient ∇p [Pa/m].
    pub pressure_gradient: &'a [[f64; 3]],
    /// Divergence ∇·τ of the viscous stress [N/m³]; empty unless wanted.
    pub viscous_force: &'a [[f64; 3]],
    /// Vorticity ∇ × u [1/s]; empty unless wanted.
    pub vorticity: &'a [[f64; 3]],
    /// Iterations, residual, time, steps and Courant number.
    pub answer: FlowAnswer,
    /// Advice about the case for its mesh, for the user; empty for nothing.
    pub advice: &'a str,
}

/// Effect of the grains on the gas in a rank's cells.
#[derive(Clone, Copy, Debug)]
pub struct GrainsInCells<'a> {
    /// Void fraction.
    pub void_fraction: &'a [f64],
    /// Drag coefficient K [kg/(m³ s)].
    pub drag: &'a [f64],
    /// Source S of momentum [N/m³].
    pub source: &'a [[f64; 3]],
}

impl<'a> GrainsInCells<'a> {
    /// Reads what a message says of a rank's cells.
    ///
    /// # Errors
    /// Fewer numbers than cells, or such that cannot be used.
    pub fn read(sections: &Sections<'a>, cells: Range<usize>) -> Result<Self, WireError> {
        let found = Self {
            void_fraction: of_cells(sections, Section::VoidFraction, &cells)?,
            drag: of_cells(sections, Section::DragCoefficient, &cells)?,
            source: of_cells(sections, Section::MomentumSource, &cells)?,
        };
        let refuse = |section, numbers: &mut dyn Iterator<Item = (f64, bool)>| {
            let bad = numbers.enumerate().find(|(_, (_, good))| !good);
            bad.map_or(Ok(()), |(place, (value, _))| Err(WireError::Number { section, place, value }))
        };
        let fraction = |&void: &f64| (void, void > 0.0 && void <= 1.0 + f64::EPSILON);
        refuse(Section::VoidFraction, &mut found.void_fraction.iter().map(fraction))?;
        let positive = |&drag: &f64| (drag, drag >= 0.0 && drag.is_finite());
        refuse(Section::DragCoefficient, &mut found.drag.iter().map(positive))?;
        let finite = |source: &[f64; 3]| {
            let sum: f64 = source.iter().sum();
            (sum, sum.is_finite())
        };
        refuse(Section::MomentumSource, &mut found.source.iter().map(finite))?;
        Ok(found)
    }
}

/// Gives a section by cell of all ranks at some of the cells.
pub(super) fn of_cells<'a, T: Element>(
    sections: &Sections<'a>,
    section: Section,
    cells: &Range<usize>,
) -> Result<&'a [T], WireError> {
    let all = sections.get::<T>(section)?;
    all.get(cells.clone()).ok_or(WireError::Count { section, theirs: all.len(), ours: cells.end })
}

/// Places of a rank's numbers in the state of all ranks, which have these sizes.
pub(super) fn state_of_rank(sizes: &[u64], rank: usize, count: usize) -> Result<Range<usize>, WireError> {
    let wrong = |theirs, ours| WireError::Count { section: Section::FlowState, theirs, ours };
    let &size = sizes.get(rank).ok_or_else(|| wrong(sizes.len(), rank + 1))?;
    let before: u64 = sizes[..rank].iter().fold(0, |sum, &size| sum.saturating_add(size));
    let end = before.saturating_add(size);
    if end > count as u64 {
        return Err(wrong(count, end as usize));
    }
    Ok(before as usize..end as usize)
}

impl FieldSide {
    /// Gives what the grains do to the gas in this rank's cells.
    ///
    /// # Errors
    /// Fewer numbers than cells, or such that cannot be used.
    pub fn grains(&self) -> Result<GrainsInCells<'_>, CouplingError> {
        GrainsInCells::read(&self.sections()?, self.places_of_cells()).map_err(of_dem)
    }

    /// Answers the question for the flow.
    ///
    /// # Errors
    /// A DEM process that is gone.
    pub fn reply_flow(&mut self, reply: &FlowReply<'_>) -> Result<(), CouplingError> {
        let arrays = [
            (Section::Velocity, reply.velocity),
            (Section::PressureGradient, reply.pressure_gradient),
            (Section::ViscousForce, reply.viscous_force),
            (Section::Vorticity, reply.vorticity),
        ];
        let mut layout = Layout::new(self.header_of_answer(MessageKind::Flow)?);
        for (section, array) in arrays {
            layout = layout.with::<[f64; 3]>(section, array.len());
        }
        let advice = reply.advice.as_bytes();
        let layout =
            layout.with::<FlowAnswer>(Section::FlowAnswer, 1).with::<u8>(Section::Text, advice.len());
        self.answer(&layout, |payload| {
            for (section, array) in arrays {
                layout.section_mut::<[f64; 3]>(payload, section)?.copy_from_slice(array);
            }
            layout.section_mut::<FlowAnswer>(payload, Section::FlowAnswer)?.fill(reply.answer);
            layout.section_mut::<u8>(payload, Section::Text)?.copy_from_slice(advice);
            Ok(())
        })
    }

    /// The state that this rank is to take in.
    ///
    /// # Errors
    /// None for this rank.
    pub fn flow_state(&self) -> Result<&[f64], CouplingError> {
        let all = self.section::<f64>(Section::FlowState)?;
        let sizes = self.section::<u64>(Section::FlowStateSizes)?;
        let of_rank = state_of_rank(sizes, self.rank() as usize, all.len()).map_err(of_dem)?;
        Ok(&all[of_rank])
    }

    /// Answers a checkpoint with this rank's state, or a state taken in with nothing.
    ///
    /// # Errors
    /// A DEM process that is gone.
    pub fn reply_state(&mut self, state: &[f64]) -> Result<(), CouplingError> {
        let header: Header = self.header_of_answer(MessageKind::State)?;
        let layout = Layout::new(header).with::<f64>(Section::FlowState, state.len());
        self.answer(&layout, |payload| {
            layout.section_mut::<f64>(payload, Section::FlowState)?.copy_from_slice(state);
            Ok(())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field_side::question::Question;
    use amberfield_wire::Block64;
    use amberfield_wire::payloads::FlowQuestion;
    use std::mem::MaybeUninit;

    /// A message of one interval and three cells.
    fn message(question: FlowQuestion, void_fraction: f64, drag: f64, source: f64) -> (Header, Vec<Block64>) {
        let layout = Layout::new(Header::new(MessageKind::Grains, 1, 1))
            .with::<FlowQuestion>(Section::FlowQuestion, 1)
            .with::<f64>(Section::VoidFraction, 3)
            .with::<f64>(Section::DragCoefficient, 3)
            .with::<[f64; 3]>(Section::MomentumSource, 3);
        let mut payload = vec![MaybeUninit::uninit(); layout.blocks()];
        layout.section_mut::<FlowQuestion>(&mut payload, Section::FlowQuestion).unwrap().fill(question);
        let voids = layout.section_mut::<f64>(&mut payload, Section::VoidFraction).unwrap();
        voids.copy_from_slice(&[1.0, void_fraction, 0.5]);
        layout.section_mut::<f64>(&mut payload, Section::DragCoefficient).unwrap()[1] = drag;
        layout.section_mut::<[f64; 3]>(&mut payload, Section::MomentumSource).unwrap()[1][2] = source;
        // SAFETY: the sections cover every block.
        let payload = payload.into_iter().map(|block| unsafe { block.assume_init() }).collect();
        (*layout.header(), payload)
    }

    const QUESTION: FlowQuestion = FlowQuestion {
        interval_s: 1e-4,
        time_s: 0.0,
        density_kg_m3: 1.2,
        viscosity_pa_s: 1.8e-5,
        model_b: 0,
        viscous_force: 1,
        vorticity: 0,
    };

    #[test]
    fn what_grains_do_to_a_gas_is_checked_before_it_is_used() {
        let read = |void, drag, source, cells| {
            let (header, payload) = message(QUESTION, void, drag, source);
            GrainsInCells::read(&Sections::new(&header, &payload), cells).map(|grains| grains.drag[0])
        };
        assert_eq!(read(0.5, 2.0, -3.0, 1..3), Ok(2.0));
        let count = WireError::Count { section: Section::VoidFraction, theirs: 3, ours: 4 };
        assert_eq!(read(0.5, 2.0, -3.0, 1..4), Err(count));
        let refused = |section, value: f64, found: Result<f64, WireError>| match found {
            Err(WireError::Number { section: theirs, place: 0, value: bad }) => {
                assert!(theirs == section && (bad == value || value.is_nan() && bad.is_nan()));
            }
            other => panic!("{other:?}"),
        };
        for bad in [0.0, -0.1, 1.1, f64::NAN] {
            refused(Section::VoidFraction, bad, read(bad, 2.0, 0.0, 1..3));
        }
        for bad in [-1.0, f64::INFINITY, f64::NAN] {
            refused(Section::DragCoefficient, bad, read(0.5, bad, 0.0, 1..3));
        }
        refused(Section::MomentumSource, f64::INFINITY, read(0.5, 1.0, f64::INFINITY, 1..3));
    }

    #[test]
    fn an_interval_that_makes_no_sense_is_refused() {
        let read = |question| {
            let (header, payload) = message(question, 1.0, 0.0, 0.0);
            Question::read(&header, &Sections::new(&header, &payload))
        };
        assert_eq!(read(QUESTION), Ok(Question::Flow(QUESTION)));
        for (name, bad) in [
            ("interval_s", FlowQuestion { interval_s: -1.0, ..QUESTION }),
            ("interval_s", FlowQuestion { interval_s: f64::NAN, ..QUESTION }),
            ("time_s", FlowQuestion { time_s: f64::INFINITY, ..QUESTION }),
            ("density_kg_m3", FlowQuestion { density_kg_m3: 0.0, ..QUESTION }),
            ("viscosity_pa_s", FlowQuestion { viscosity_pa_s: -1.0, ..QUESTION }),
        ] {
            assert!(
                matches!(read(bad), Err(WireError::Field { name: found, .. }) if found == name),
                "{name}"
            );
        }
    }
}
