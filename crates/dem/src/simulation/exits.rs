//! Grains that leave the box.
//!
//! A grain leaves through an open face with its centre, and through a face that mirrors charges, a conductor
//! or an insulator, as soon as it touches it: its own image would pull its centre into the face without
//! bound. Where a wall stands on such a face, grains bounce off the wall and stay. An outlet takes the grains
//! that leave through its face, and those whose centre comes into its volume.

use super::{HALF_SKIN, Simulation};
use crate::error::DemError;
use crate::field_stage::Leaver;
use crate::motion::verlet::{Beyond, Bounds};
use crate::setup::Setup;
use amberfield_core::{Axis, MaterialId, OnExit, Side, Vector3};
use serde::{Deserialize, Serialize};

/// A wall this close to a face, over the skin of the lists, stands on it.
const ON_FACE: f64 = 0.25;

/// Way by which a grain left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WayOut {
    /// Face of the box, such as `z_min`.
    Face(&'static str),
    /// Outlet, by its number in the set-up.
    Outlet(u16),
}

impl WayOut {
    /// Number of the outlet; `None` for a face that is none.
    #[must_use]
    pub fn outlet(self) -> Option<u16> {
        match self {
            Self::Face(_) => None,
            Self::Outlet(number) => Some(number),
        }
    }
}

/// A grain that has left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exit {
    /// Step in which it left.
    pub step: u64,
    /// Simulated time [s].
    pub time_s: f64,
    /// Id of the grain.
    pub id: u64,
    /// Way by which it left.
    pub way: WayOut,
    /// Position of the centre [m].
    pub position: Vector3<f64>,
    /// Velocity in the middle of the step [m/s].
    pub velocity: Vector3<f64>,
    /// Radius [m].
    pub radius: f64,
    /// Mass [kg].
    pub mass: f64,
    /// Material.
    pub material: MaterialId,
    /// Charge [C].
    pub charge: f64,
}

/// Sums over the grains that have left since the run began.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Left {
    /// Number of grains.
    pub grains: usize,
    /// Charge that they took along [C].
    pub charge: f64,
    /// Energy −Σ m g·x where they left [J].
    pub gravity: f64,
}

/// Ways out of the box.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct WaysOut {
    /// Faces, by axis and side, through which a grain leaves when it touches them; `None` without any.
    at_touch: Option<[[bool; 2]; 3]>,
    left: Left,
}

impl WaysOut {
    /// Share of the skin that a wall may use up before lists are built anew.
    pub(super) fn share_of_walls(&self) -> f64 {
        if self.at_touch.is_some() { HALF_SKIN - ON_FACE } else { HALF_SKIN }
    }

    /// Ways out of the box of a set-up. A field solver has other faces than the box.
    pub(crate) fn new(setup: &Setup) -> Self {
        let mirrors = setup.field.as_ref().is_some_and(|field| field.solver.is_none());
        let at_touch = setup
            .domain
            .faces()
            .map(|sides| sides.map(|face| mirrors && (face.is_conductor() || face.is_insulating())));
        Self {
            at_touch: at_touch.iter().flatten().any(|face| *face).then_some(at_touch),
            left: Left::default(),
        }
    }

    /// First of the faces left at touch that a grain touches.
    fn touched(&self, bounds: &Bounds, centre: &[f64; 4]) -> Option<Beyond> {
        let faces = self.at_touch.as_ref()?;
        let [.., radius] = *centre;
        (0..3).find_map(|axis| {
            let [low, high] = faces[axis];
            let side = if low && centre[axis] - radius < bounds.min[axis] {
                Side::Min
            } else if high && centre[axis] + radius > bounds.max[axis] {
                Side::Max
            } else {
                return None;
            };
            Some(Beyond { axis, side: Some(side) })
        })
    }
}

impl Simulation {
    /// Sums over the grains that have left since the run began.
    #[must_use]
    pub fn left(&self) -> Left {
        self.ways_out.left
    }

    /// Grains that have left since this was asked last.
    pub fn take_exits(&mut self) -> Vec<Exit> {
        std::mem::take(&mut self.exits)
    }

    /// Whether any grain touches a face through which grains leave at touch.
    pub(super) fn touches_face(&self) -> bool {
        self.ways_out.at_touch.is_some() && (0..self.grains.len()).any(|i| self.face_touched_by(i).is_some())
    }

    /// Face through which a grain leaves by touching it; `None` where a wall holds the grain off.
    fn face_touched_by(&self, i: usize) -> Option<Beyond> {
        let touched = self.ways_out.touched(&self.bounds, &self.grains.centre[i])?;
        // What never moves may stand in a face.
        if self.grains.is_fixed(i) {
            return None;
        }
        let mut foot = self.grains.position(i);
        foot[touched.axis] = match touched.side? {
            Side::Min => self.bounds.min[touched.axis],
            Side::Max => self.bounds.max[touched.axis],
        };
        let walls = self.contacts.walls.as_ref();
        let held = walls.is_some_and(|walls| walls.stand_at(i, foot, ON_FACE * self.progress.skin_m));
        (!held).then_some(touched)
    }

    /// Way by which a grain leaves.
    fn way_out_of(&self, i: usize) -> Option<WayOut> {
        let outlets = self.outlets.as_ref();
        let face = self.bounds.beyond(&self.grains.centre[i]).or_else(|| self.face_touched_by(i));
        let Some(Beyond { axis, side }) = face else {
            return outlets?.holding(&self.domain, self.grains.position(i)).map(WayOut::Outlet);
        };
        // A centre that is not a number has no side; it ends the run in any case.
        let side = side.unwrap_or(Side::Min);
        let outlet = outlets.and_then(|outlets| outlets.at_face(axis, side));
        Some(outlet.map_or(WayOut::Face(Axis::ALL[axis].face_name(side)), WayOut::Outlet))
    }

    /// Ends the run or books the grains that leave, as the scene says. Returns their sorted indices,
    /// ascending: the rebuild that must follow drops them.
    pub(super) fn handle_exits(&mut self) -> Result<Vec<usize>, DemError> {
        let mut exits: Vec<(usize, Exit)> = Vec::new();
        let mut lost: Option<u64> = None;
        let time_s = self.progress.time_s();
        for i in 0..self.grains.len() {
            let Some(way) = self.way_out_of(i) else { continue };
            let original = self.grains.original[i].index();
            let id = self.particles.id[original];
            if !self.grains.is_finite(i) {
                lost = Some(lost.map_or(id, |other| other.min(id)));
                continue;
            }
            let exit = Exit {
                step: self.progress.step_index,
                time_s,
                id,
                way,
                position: self.grains.position(i),
                velocity: self.grains.velocity[i],
                radius: self.grains.centre[i][3],
                mass: 1.0 / self.grains.inverse_mass[i],
                material: self.particles.material[original],
                charge: self.particles.charge[original],
            };
            exits.push((i, exit));
        }
        // The smallest id is named: which grain comes first in the sorted order means nothing to a reader.
        if let Some(id) = lost {
            return Err(DemError::NotFinite { id, time_s });
        }
        let through_faces = exits.iter().filter_map(|(_, exit)| match exit.way {
            WayOut::Face(face) => Some((exit.id, exit.position, face)),
            WayOut::Outlet(_) => None,
        });
        if self.time.on_exit == OnExit::Stop
            && let Some((id, position_m, face)) = through_faces.min_by_key(|(id, ..)| *id)
        {
            return Err(DemError::Left { id, position_m, face: face.to_owned(), time_s });
        }
        if exits.is_empty() {
            return Ok(Vec::new());
        }
        let gone: Vec<usize> = exits.iter().map(|(i, _)| *i).collect();
        // Charge that contacts have yet to trade goes before the grains do.
        self.trade_between_grains();
        self.retire_from_field(&gone);
        for (i, mut exit) in exits {
            let original = self.grains.original[i].index();
            exit.charge = self.particles.charge[original];
            let left = &mut self.ways_out.left;
            left.grains += 1;
            left.charge += exit.charge;
            left.gravity -= exit.position.dot(&self.time.gravity_m_s2) * exit.mass;
            if let Some(books) = &mut self.books {
                books.book_exit(&self.particles, original, exit.way.outlet());
            }
            self.exits.push(exit);
        }
        Ok(gone)
    }

    /// Takes the field of grains that leave (sorted indices) off the others' forces.
    fn retire_from_field(&mut self, gone: &[usize]) {
        let leavers: Vec<Leaver> =
            gone.iter().map(|&index| Leaver { index, image: self.image_where_it_leaves(index) }).collect();
        if let Some(field) = &mut self.field {
            field.retire(&self.domain, &self.grains, &self.particles, &leavers);
        }
    }

    /// Image of a grain in the face through which it leaves: its place [m] and its charge over the grain's;
    /// `None` where the face mirrors nothing.
    fn image_where_it_leaves(&self, i: usize) -> Option<(Vector3<f64>, f64)> {
        let faces = self.ways_out.at_touch.as_ref()?;
        let face = self.bounds.beyond(&self.grains.centre[i]).or_else(|| self.face_touched_by(i))?;
        let Beyond { axis, side: Some(side) } = face else { return None };
        if !faces[axis][side as usize] {
            return None;
        }
        let plane = [self.domain.min(), self.domain.max()][side as usize][axis];
        let mut place = self.grains.position(i);
        place[axis] = 2.0 * plane - place[axis];
        let boundary = self.domain.faces()[axis][side as usize];
        Some((place, if boundary.is_conductor() { -1.0 } else { 1.0 }))
    }
}
