//! Books about the grains that come and go, by material.

use crate::setup::Setup;
use amberfield_core::{OnExit, Particles};
use serde::{Deserialize, Serialize};

/// Number, mass and charge of grains.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// Number.
    pub grains: u64,
    /// Mass [kg].
    pub mass: f64,
    /// Charge [C].
    pub charge: f64,
}

impl Tally {
    /// Adds a grain with its mass [kg] and charge [C].
    pub(crate) fn add(&mut self, mass: f64, charge: f64) {
        self.grains += 1;
        self.mass += mass;
        self.charge += charge;
    }

    /// Sum of tallies.
    #[must_use]
    pub fn sum<'a>(tallies: impl IntoIterator<Item = &'a Self>) -> Self {
        let mut sum = Self::default();
        for Self { grains, mass, charge } in tallies {
            sum.grains += grains;
            sum.mass += mass;
            sum.charge += charge;
        }
        sum
    }
}

/// State of the books, for checkpoints.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct BooksState {
    /// Grains that have come, by material.
    pub(crate) fed: Vec<Tally>,
    /// Grains that have left, by material.
    pub(crate) left: Vec<Tally>,
    /// Grains that left through an outlet, by outlet and material; they are among `left`.
    pub(crate) outlets: Vec<Vec<Tally>>,
}

/// Books of a run in which grains come or go.
#[derive(Debug)]
pub(crate) struct Books {
    /// Grains at the start, by material.
    pub(crate) start: Vec<Tally>,
    pub(crate) state: BooksState,
}

impl Books {
    /// Whether grains come or go, so that books are kept.
    pub(crate) fn are_kept(setup: &Setup) -> bool {
        !setup.feeds.is_empty() || !setup.outlets.is_empty() || setup.time.on_exit == OnExit::Delete
    }

    /// Empty books of a merged set-up, in which the grains of feeds follow those of the start; `None` where
    /// grains neither come nor go.
    pub(crate) fn new(setup: &Setup) -> Option<Self> {
        let materials = setup.materials.len();
        let none = || vec![Tally::default(); materials];
        Self::are_kept(setup).then(|| {
            let particles = &setup.particles;
            let mut start = none();
            for i in 0..particles.len() - setup.feeds.due_s.len() {
                tally_of(&mut start, particles, i).add(particles.mass(i), particles.charge[i]);
            }
            let outlets = vec![none(); setup.outlets.len()];
            Self { start, state: BooksState { fed: none(), left: none(), outlets } }
        })
    }

    /// Goes on from a state; `Err` says what does not fit.
    pub(crate) fn restore(&mut self, state: &BooksState) -> Result<(), String> {
        let lengths = [&state.fed, &state.left].into_iter().chain(&state.outlets).map(Vec::len);
        let fits = lengths.into_iter().all(|length| length == self.start.len())
            && state.outlets.len() == self.state.outlets.len();
        if !fits {
            return Err("its books are not those of the scene".to_owned());
        }
        self.state.clone_from(state);
        Ok(())
    }

    /// Books a grain that comes, by its index in the set-up.
    pub(crate) fn book_entry(&mut self, particles: &Particles, grain: usize) {
        tally_of(&mut self.state.fed, particles, grain).add(particles.mass(grain), particles.charge[grain]);
    }

    /// Books a grain that leaves, by its index in the set-up, and its outlet where it has one.
    pub(crate) fn book_exit(&mut self, particles: &Particles, grain: usize, outlet: Option<u16>) {
        let (mass, charge) = (particles.mass(grain), particles.charge[grain]);
        tally_of(&mut self.state.left, particles, grain).add(mass, charge);
        if let Some(outlet) = outlet {
            tally_of(&mut self.state.outlets[usize::from(outlet)], particles, grain).add(mass, charge);
        }
    }
}

/// Tally of a grain's material.
fn tally_of<'a>(tallies: &'a mut [Tally], particles: &Particles, grain: usize) -> &'a mut Tally {
    &mut tallies[usize::from(particles.material[grain].0)]
}
