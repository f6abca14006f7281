//! Motion of walls, as the rest of the program asks for it.

use super::movers::{Movers, MoversState};
use super::{ChunkWalls, ContactWalls, Entry, WallContact, WallLoad};
use crate::contacts::material_pairs::PairTable;
use crate::motion::chunks::CHUNK;
use crate::motion::grains::Grains;
use amberfield_core::{Domain, Placement, Vector3, Wall};

impl ContactWalls {
    /// Lets walls move that have a motion; they are at its beginning then.
    pub(crate) fn set_in_motion(&mut self, walls: &[Wall], domain: &Domain) {
        self.movers = Movers::new(walls, &self.parts, &self.surfaces, domain).map(Box::new);
    }

    /// Moves walls to a time [s], after a step [s].
    pub(crate) fn advance(&mut self, time: f64, step: f64) {
        if let Some(movers) = &mut self.movers {
            movers.advance(&mut self.surfaces, time, step);
        }
    }

    /// Tells those who look for walls anywhere, beyond the lists, where they are now.
    pub(crate) fn settle(&mut self) {
        if let Some(movers) = &mut self.movers {
            movers.set_all(&mut self.surfaces);
        }
    }

    /// Largest way of a wall since the lists were built [m].
    pub(crate) fn travel(&self) -> f64 {
        self.movers.as_ref().map_or(0.0, |movers| movers.travel())
    }

    /// Whether a wall moves.
    pub(crate) fn move_at_all(&self) -> bool {
        self.movers.is_some()
    }

    /// Bound on the speed of walls until a time [m/s]; `None` where all are at rest.
    pub(crate) fn fastest(&self, end_s: f64) -> Option<f64> {
        self.movers.as_ref().map(|movers| movers.fastest(end_s))
    }

    /// Work of walls that move on the grains since the start [J]; `None` where all are at rest.
    pub(crate) fn work(&self) -> Option<f64> {
        self.movers.as_ref().map(|movers| movers.work())
    }

    /// Places of walls that move, by their number in the scene.
    pub(crate) fn placements(&self) -> impl Iterator<Item = (u32, Placement)> {
        self.movers.iter().flat_map(|movers| movers.placements())
    }

    /// State of walls that move, for a checkpoint.
    pub(crate) fn moving_state(&self) -> Option<MoversState> {
        self.movers.as_ref().map(|movers| movers.state())
    }

    /// Puts walls that move where the lists of a state were built; `Err` says what does not fit.
    pub(crate) fn restore_moving(&mut self, state: Option<&MoversState>) -> Result<(), String> {
        match (&mut self.movers, state) {
            (None, None) => Ok(()),
            (Some(movers), Some(state)) => movers.restore(state),
            _ => Err("its walls move and the scene's do not, or the other way".to_owned()),
        }
    }

    /// Books the work of walls that move in a step [s] that ends at a time [s], and steers those that are
    /// pressed on.
    pub(crate) fn book_motion(&mut self, grains: &Grains, table: &PairTable, time: f64, step: f64) {
        let Some(mut movers) = self.movers.take() else { return };
        movers.book(self.chunks.iter().map(|chunk| chunk.power).sum(), step);
        if step > 0.0 && movers.has_servo(time) {
            movers.steer(time, step, |wall, direction| {
                let load = self.load(wall);
                let force = -(load.normal + load.tangential).dot(direction);
                [force, self.stiffness(grains, table, wall, direction)]
            });
        }
        self.movers = Some(movers);
    }

    /// Load on a wall at the last evaluation.
    fn load(&self, wall: u32) -> WallLoad {
        let mut sum = WallLoad::default();
        let parts = self.chunks.iter().filter_map(|chunk| chunk.loads.get(wall as usize));
        parts.for_each(|part| sum.add(part));
        sum
    }

    /// Stiffness of the contacts of a wall along a direction [N/m].
    fn stiffness(&self, grains: &Grains, table: &PairTable, wall: u32, direction: &Vector3<f64>) -> f64 {
        let of_chunk = |(k, chunk): (usize, &ChunkWalls)| {
            let of_entry = |entry: &Entry| {
                let i = k * CHUNK + entry.local as usize;
                let touching = entry.contacts as usize..(entry.contacts + entry.count) as usize;
                let of_contact = |contact: &WallContact| {
                    let part = self.part(contact.triangle);
                    let contact_radius = (contact.overlap.max(0.0) * grains.centre[i][3]).sqrt();
                    let normal = table.get(grains.material[i], part.material).normal * contact_radius;
                    let share = contact.normal.dot(direction);
                    if part.wall == wall { normal * share * share } else { 0.0 }
                };
                chunk.contacts[touching].iter().map(of_contact).sum::<f64>()
            };
            chunk.entries.iter().map(of_entry).sum::<f64>()
        };
        self.chunks.iter().enumerate().map(of_chunk).sum()
    }
}
