//! Memory of contacts: springs, area and what of its growth is still to move charge.

use crate::contacts::walls::movers::MoversState;
use crate::motion::grains::Original;
use amberfield_core::Vector3;
use serde::{Deserialize, Serialize};

/// Rule by which contact areas are followed in a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Follow {
    /// Whether it is a step: what touches at the start has its area from before the run.
    pub(crate) moves: bool,
    /// Whether only growth beyond a contact's largest area counts.
    pub(crate) beyond: bool,
}

/// Contact area, and the part of its growth that has not moved charge yet.
///
/// Every step reads and writes those of all contacts. Single precision halves that, and its rounding does not
/// add up, since differences of close areas are exact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Growth {
    /// Area at the last step at which it touched, or the largest since first touch [m²].
    area: f32,
    /// Growth that has not moved charge yet [m²].
    due: f32,
}

impl Growth {
    /// Takes the area [m²] at a step; `touched` says whether the contact touched a step before. Returns
    /// whether it begins. There are no branches, which would keep the next contacts waiting.
    #[inline(always)]
    pub(crate) fn follow(&mut self, area: f64, touched: bool, Follow { moves, beyond }: Follow) -> bool {
        #[expect(clippy::cast_possible_truncation, reason = "single precision is meant")]
        let area = area as f32;
        let before = if touched { self.area } else { 0.0 };
        let grows = (area - before).max(0.0);
        self.due += if moves { grows } else { 0.0 };
        self.area = if beyond { area.max(before) } else { area };
        (before == 0.0) & (area > 0.0)
    }

    /// Growth that has not moved charge yet [m²].
    pub(crate) fn due(self) -> f64 {
        self.due.into()
    }

    /// Forgets the growth that was due: it has moved its charge.
    pub(crate) fn settle(&mut self) {
        self.due = 0.0;
    }
}

/// E_x·n at a contact, on the line through the last two evaluations of the field that foresaw it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Foreseen {
    /// E_x·n at the evaluation [V/m].
    field: f64,
    /// Change per step [V/m]; zero where the evaluation before did not foresee the contact.
    slope: f64,
    /// Number of the evaluation; 0: none has foreseen the contact.
    evaluation: u64,
}

impl Foreseen {
    /// Takes E_x·n [V/m] of an evaluation, `age` steps after the one before, which may have `known` it.
    pub(crate) fn new(field: f64, evaluation: u64, known: Option<Self>, age: u64) -> Self {
        let known =
            known.filter(|known| known.evaluation > 0 && known.evaluation + 1 == evaluation && age > 0);
        let slope = known.map_or(0.0, |known| (field - known.field) / age as f64);
        Self { field, slope, evaluation }
    }

    /// E_x·n [V/m], `age` steps after the evaluation of a number; `None` if that did not foresee the contact.
    #[inline(always)]
    pub(crate) fn at(self, evaluation: u64, age: f64) -> Option<f64> {
        (self.evaluation > 0 && self.evaluation == evaluation).then_some(self.field + self.slope * age)
    }

    /// E_x·n as seen from the other collider.
    pub(crate) fn times(self, sign: f64) -> Self {
        Self { field: sign * self.field, slope: sign * self.slope, ..self }
    }
}

/// A pair of a list whose growth is due.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grown {
    pub(crate) entry: u32,
    /// Grain in the chunk.
    pub(crate) local: u32,
}

/// Tangential spring of a contact, as it is kept from step to step; zero where there was no contact before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Spring {
    /// Tangential force [N].
    pub(crate) force: [f64; 3],
    /// Contact radius of the last step [m].
    pub(crate) contact_radius: f64,
}

/// History of a touching pair.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PairHistory {
    /// Grain whose list holds the pair, in the sorted order.
    pub(crate) i: u32,
    /// Entry in that list.
    pub(crate) entry: u32,
    /// Partner.
    pub(crate) partner: Original,
    /// Tangential spring.
    pub(crate) spring: Spring,
    /// Rolling torque [N·m].
    pub(crate) rolling: [f64; 3],
}

/// Memory of a pair that touched in another run, by the order of the set-up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CarriedPair {
    /// The two grains.
    pub(crate) grains: [Original; 2],
    /// Tangential spring, as it acts on the first.
    pub(crate) spring: Spring,
    /// Rolling torque on the first [N·m].
    pub(crate) rolling: [f64; 3],
}

impl CarriedPair {
    /// Key of a pair in either order.
    pub(crate) fn key([a, b]: [Original; 2]) -> [Original; 2] {
        if a < b { [a, b] } else { [b, a] }
    }
}

/// History of a contact with a wall.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct WallHistory {
    /// Grain.
    pub(crate) grain: Original,
    /// Direction from the grain to the wall.
    pub(crate) normal: [f64; 3],
    /// Overlap [m].
    pub(crate) overlap: f64,
    /// Overlap with the line where the contact joins a deeper one [m].
    pub(crate) joined: f64,
    /// Triangle or plane that is touched.
    pub(crate) triangle: u32,
    /// Tangential spring.
    pub(crate) spring: Spring,
    /// Rolling torque [N·m].
    pub(crate) rolling: [f64; 3],
    /// Growth of the area.
    pub(crate) growth: Growth,
}

/// State of all contacts, for checkpoints.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ContactsState {
    /// Centres for which the lists were built [m].
    pub(crate) reference: Vec<Vector3<f64>>,
    /// Number of grains that were there then; the others after them are loose.
    pub(crate) listed: usize,
    /// Histories of the touching pairs.
    pub(crate) pairs: Vec<PairHistory>,
    /// Histories of the touching contacts with walls.
    pub(crate) walls: Vec<WallHistory>,
    /// Number of the wall of each of them in the scene.
    pub(crate) touched: Vec<u32>,
    /// Walls that move; `None` where all are at rest.
    pub(crate) moving: Option<MoversState>,
}

/// Charging of a listed pair.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PairGrowth {
    /// Chunk whose list holds the pair.
    pub(crate) chunk: u32,
    /// Entry in that list.
    pub(crate) entry: u32,
    pub(crate) growth: Growth,
    pub(crate) foreseen: Foreseen,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn due_after(areas: &[f64], beyond: bool) -> f64 {
        let mut growth = Growth::default();
        for (step, &area) in areas.iter().enumerate() {
            growth.follow(area, true, Follow { moves: step > 0, beyond });
        }
        growth.due()
    }

    #[test]
    fn only_growth_counts_and_beyond_the_maximum_once() {
        let rocking = [0.0, 1.0, 3.0, 2.0, 3.0, 2.0, 4.0];
        assert_eq!(due_after(&rocking, false), 6.0);
        assert_eq!(due_after(&rocking, true), 4.0);
        assert_eq!(due_after(&[2.0, 1.0, 1.5], false), 0.5);
    }

    #[test]
    fn separated_contact_begins_anew() {
        let follow = Follow { moves: true, beyond: true };
        let mut growth = Growth::default();
        assert!(growth.follow(2.0, false, follow));
        assert!(!growth.follow(3.0, true, follow));
        assert_eq!(growth.due(), 3.0);
        growth.settle();
        assert!(growth.follow(1.0, false, follow));
        assert_eq!(growth.due(), 1.0);
    }
}
