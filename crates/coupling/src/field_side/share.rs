//! One rank's share of a question: what it has in its cells, and the charges that are felt there.

use super::flow::of_cells;
use super::question::Question;
use crate::CouplingError;
use crate::meeting::Message;
use crate::mesh::{MeshPart, OwnCells};
use amberfield_core::{Domain, Vector3};
use amberfield_field::far::CloudReach;
use amberfield_wire::payloads::{FarQuestion, FlowQuestion, SourceCloud};
use amberfield_wire::{Header, Layout, Letter, Section, Sections, WireError};
use std::ops::Range;

/// Sections with a number for each cell that a question for the far field may have.
const OPTIONAL: [Section; 2] = [Section::SourceDensity, Section::Guess];

/// Cells of one rank, as far as its share of a question depends on them.
#[derive(Debug)]
pub(super) struct Share {
    rank: usize,
    /// Numbers of the cells among those of all ranks.
    cells: Range<usize>,
    whole: Domain,
    corners: [Vector3<f64>; 2],
    /// Reach of clouds of one kind into the cells.
    reach: Option<(SourceCloud, CloudReach)>,
}

/// Charges at places.
type Charges = (Vec<[f64; 3]>, Vec<f64>);

impl Share {
    /// Share of the rank that has a part of the mesh.
    pub(super) fn new(part: &MeshPart<'_>, rank: u32) -> Result<Self, CouplingError> {
        let own = OwnCells::new(part)?;
        let first = part.outline.first_cell as usize;
        let cells = first..first.saturating_add(own.centres.len());
        Ok(Self { rank: rank as usize, cells, corners: own.corners(), whole: own.whole, reach: None })
    }

    /// The rank's share of a question.
    pub(super) fn of(&mut self, question: &Question, message: &Message) -> Result<Letter, WireError> {
        let (header, sections) = (message.header(), message.sections());
        match question {
            Question::Far(far) => self.of_charges(far, header, &sections),
            Question::Flow(flow) => self.of_grains(flow, header, &sections),
            Question::Restore => self.of_state(header, &sections),
            Question::State | Question::Potentials => Ok(message.to_letter()),
        }
    }

    fn of_charges(
        &mut self,
        question: &FarQuestion,
        header: &Header,
        sections: &Sections<'_>,
    ) -> Result<Letter, WireError> {
        let cells = sections.get::<u64>(Section::Cells)?;
        let (positions, charges) =
            self.felt(question.cloud, sections, [Section::Positions, Section::Charges])?;
        let (image_positions, image_charges) =
            self.felt(question.cloud, sections, [Section::ImagePositions, Section::ImageCharges])?;
        let boundary = sections.get::<f64>(Section::Boundary)?;
        let mut by_cell = Vec::new();
        for section in OPTIONAL {
            if sections.get::<f64>(section).is_ok() {
                by_cell.push((section, of_cells::<f64>(sections, section, &self.cells)?));
            }
        }

        let mut layout = Layout::new(*header)
            .with::<FarQuestion>(Section::FarQuestion, 1)
            .with::<[f64; 3]>(Section::Positions, positions.len())
            .with::<f64>(Section::Charges, charges.len())
            .with::<u64>(Section::Cells, cells.len())
            .with::<[f64; 3]>(Section::ImagePositions, image_positions.len())
            .with::<f64>(Section::ImageCharges, image_charges.len())
            .with::<f64>(Section::Boundary, boundary.len());
        for (section, values) in &by_cell {
            layout = layout.with::<f64>(*section, values.len());
        }
        Letter::write(&layout, |payload| {
            layout.section_mut::<FarQuestion>(payload, Section::FarQuestion)?.fill(*question);
            layout.section_mut::<[f64; 3]>(payload, Section::Positions)?.copy_from_slice(&positions);
            layout.section_mut::<f64>(payload, Section::Charges)?.copy_from_slice(&charges);
            layout.section_mut::<u64>(payload, Section::Cells)?.copy_from_slice(cells);
            let images = layout.section_mut::<[f64; 3]>(payload, Section::ImagePositions)?;
            images.copy_from_slice(&image_positions);
            layout.section_mut::<f64>(payload, Section::ImageCharges)?.copy_from_slice(&image_charges);
            layout.section_mut::<f64>(payload, Section::Boundary)?.copy_from_slice(boundary);
            for (section, values) in &by_cell {
                layout.section_mut::<f64>(payload, *section)?.copy_from_slice(values);
            }
            Ok(())
        })
    }

    /// Charges whose clouds reach the cells; all of those that are spread over the cells that they are in,
    /// since the answer names the cell of each.
    fn felt(
        &mut self,
        cloud: SourceCloud,
        sections: &Sections<'_>,
        [places, charges]: [Section; 2],
    ) -> Result<Charges, WireError> {
        let places = sections.get::<[f64; 3]>(places)?;
        let charges = sections.exactly::<f64>(charges, places.len())?;
        if cloud.is_nearest_cell() {
            return Ok((places.to_vec(), charges.to_vec()));
        }
        if self.reach.as_ref().is_none_or(|(known, _)| *known != cloud) {
            let [low, high] = self.corners;
            self.reach = Some((cloud, CloudReach::new(&self.whole, low, high, cloud.radius_m)));
        }
        let (_, reach) = self.reach.as_ref().expect("just made");
        // What is no number goes on, to be refused where all ranks look for it.
        let is_felt =
            |place: &[f64; 3]| !place.iter().all(|x| x.is_finite()) || reach.has(Vector3::from(*place));
        let all = places.iter().zip(charges);
        Ok(all.filter(|(place, charge)| !charge.is_finite() || is_felt(place)).unzip())
    }

    fn of_grains(
        &self,
        question: &FlowQuestion,
        header: &Header,
        sections: &Sections<'_>,
    ) -> Result<Letter, WireError> {
        let [void_fraction, drag] = [Section::VoidFraction, Section::DragCoefficient];
        let scalars =
            [void_fraction, drag].map(|section| (section, of_cells(sections, section, &self.cells)));
        let source = of_cells::<[f64; 3]>(sections, Section::MomentumSource, &self.cells)?;
        let count = self.cells.len();
        let layout = Layout::new(*header)
            .with::<FlowQuestion>(Section::FlowQuestion, 1)
            .with::<f64>(void_fraction, count)
            .with::<f64>(drag, count)
            .with::<[f64; 3]>(Section::MomentumSource, count);
        Letter::write(&layout, |payload| {
            layout.section_mut::<FlowQuestion>(payload, Section::FlowQuestion)?.fill(*question);
            for (section, values) in scalars {
                layout.section_mut::<f64>(payload, section)?.copy_from_slice(values?);
            }
            layout.section_mut::<[f64; 3]>(payload, Section::MomentumSource)?.copy_from_slice(source);
            Ok(())
        })
    }

    /// The state to take in, as if no other rank had any.
    fn of_state(&self, header: &Header, sections: &Sections<'_>) -> Result<Letter, WireError> {
        let all = sections.get::<f64>(Section::FlowState)?;
        let sizes = sections.get::<u64>(Section::FlowStateSizes)?;
        let state = &all[super::flow::state_of_rank(sizes, self.rank, all.len())?];
        let mut own_size = vec![0; sizes.len()];
        own_size[self.rank] = state.len() as u64;
        let layout = Layout::new(*header)
            .with::<u64>(Section::FlowStateSizes, own_size.len())
            .with::<f64>(Section::FlowState, state.len());
        Letter::write(&layout, |payload| {
            layout.section_mut::<u64>(payload, Section::FlowStateSizes)?.copy_from_slice(&own_size);
            layout.section_mut::<f64>(payload, Section::FlowState)?.copy_from_slice(state);
            Ok(())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::Boundary;
    use amberfield_wire::MessageKind;

    /// Share of a rank that has the cells 2 and 3 of four in a row along x, each a metre long.
    fn share() -> Share {
        let faces = [[Boundary::Periodic; 2], [Boundary::Open; 2], [Boundary::Open; 2]];
        let whole = Domain::new(Vector3::zeros(), Vector3::new(4.0, 1.0, 1.0), faces).unwrap();
        let corners = [Vector3::new(2.0, 0.0, 0.0), Vector3::new(4.0, 1.0, 1.0)];
        Share { rank: 1, cells: 2..4, whole, corners, reach: None }
    }

    fn letter(kind: MessageKind, arrays: &[(Section, &[f64])]) -> Letter {
        let mut layout = Layout::new(Header::new(kind, 7, 3));
        for (section, values) in arrays {
            layout = layout.with::<f64>(*section, values.len());
        }
        let written = Letter::write(&layout, |payload| {
            for (section, values) in arrays {
                layout.section_mut::<f64>(payload, *section)?.copy_from_slice(values);
            }
            Ok(())
        });
        written.unwrap()
    }

    #[test]
    fn charges_are_those_whose_clouds_reach_the_cells_and_what_is_no_number() {
        let places: Vec<[f64; 3]> = [0.1, 1.0, 1.9, 3.0, f64::NAN].iter().map(|&x| [x, 0.5, 0.5]).collect();
        let charges = [1.0, 2.0, 3.0, 4.0, 5.0];
        let layout = Layout::new(Header::new(MessageKind::Charges, 7, 3))
            .with::<[f64; 3]>(Section::Positions, places.len())
            .with::<f64>(Section::Charges, charges.len());
        let message = Letter::write(&layout, |payload| {
            layout.section_mut::<[f64; 3]>(payload, Section::Positions)?.copy_from_slice(&places);
            layout.section_mut::<f64>(payload, Section::Charges)?.copy_from_slice(&charges);
            Ok(())
        });
        let message = message.unwrap();
        let felt = |cloud| {
            let found = share().felt(cloud, &message.sections(), [Section::Positions, Section::Charges]);
            found.unwrap().1
        };
        // The first across the period, the second from nowhere.
        assert_eq!(felt(SourceCloud { radius_m: 0.2, shape: 8.0 }), [1.0, 3.0, 4.0, 5.0]);
        assert_eq!(felt(SourceCloud { radius_m: 1.5, shape: 8.0 }), charges);
        assert_eq!(felt(SourceCloud::nearest_cell()), charges);
    }

    #[test]
    fn a_state_is_the_ranks_own_and_one_that_is_too_short_is_refused() {
        let state = |sizes: &[u64], state: &[f64]| {
            let layout = Layout::new(Header::new(MessageKind::Restore, 7, 3))
                .with::<u64>(Section::FlowStateSizes, sizes.len())
                .with::<f64>(Section::FlowState, state.len());
            let message = Letter::write(&layout, |payload| {
                layout.section_mut::<u64>(payload, Section::FlowStateSizes)?.copy_from_slice(sizes);
                layout.section_mut::<f64>(payload, Section::FlowState)?.copy_from_slice(state);
                Ok(())
            });
            let own = share().of(&Question::Restore, &Message::Letter(message.unwrap()))?;
            let sections = own.sections();
            let sizes = sections.get::<u64>(Section::FlowStateSizes)?.to_vec();
            Ok::<_, WireError>((sizes, sections.get::<f64>(Section::FlowState)?.to_vec()))
        };
        assert_eq!(state(&[1, 2, 1], &[1.0, 2.0, 3.0, 4.0]), Ok((vec![0, 2, 0], vec![2.0, 3.0])));
        assert!(state(&[1, 2, 1], &[1.0, 2.0]).is_err());
        assert!(state(&[4], &[1.0; 4]).is_err());
    }

    #[test]
    fn what_concerns_no_cells_goes_on_as_it_is() {
        let times = letter(MessageKind::Times, &[(Section::Times, &[1.0, 2.0])]);
        let own = share().of(&Question::Potentials, &Message::Letter(times.clone())).unwrap();
        assert_eq!(own.bytes(), times.bytes());
    }
}
