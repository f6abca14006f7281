//! Walls that hide what is behind them: sheets, plates and edges of bodies, where a mirror charge would lie
//! in the mesh or beside it.
//!
//! An endless screen hides all of a charge's potential from the places behind it, or nothing. Around an edge
//! the potential that its faces add goes smoothly, as between two half planes (`amberfield_laws::wedge`).

use super::curved::Quadric;
use amberfield_laws::wedge::{Around, Face, Induced, Wedge};
use nalgebra::Vector3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A right angle [rad].
pub(super) const RIGHT: f64 = FRAC_PI_2;

/// Numbers by which a screen is known: place and normal, as bits.
pub(super) type ScreenKey = [u64; 6];
/// Numbers by which an edge is known: place, directions and angle, as bits, and its faces' conditions.
pub(super) type EdgeKey = ([u64; 7], [Face; 2]);

/// A wall without an edge nearby, as a charge sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Screen {
    /// A flat wall.
    Plane {
        /// Unit normal, away from the charge.
        normal: Vector3<f64>,
        /// Normal times a point of the plane [m].
        offset: f64,
    },
    /// A curved wall.
    Curved(Quadric),
}

/// Space between the two faces that meet in an edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EdgeScreen {
    /// A point of the edge [m].
    pub(crate) point: Vector3<f64>,
    /// Unit vectors along the edge, from it into the first face, and from that face into the mesh.
    pub(crate) along: Vector3<f64>,
    pub(crate) into: Vector3<f64>,
    pub(crate) up: Vector3<f64>,
    /// Angle of the mesh between the faces, and their conditions.
    pub(crate) wedge: Wedge,
}

/// A place that a field is asked for at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    /// The place [m].
    pub(crate) at: Vector3<f64>,
    /// A point on the same side of every wall, off them [m]: places on a wall are on the mesh's side of it.
    pub(crate) seen_from: Vector3<f64>,
}

impl Screen {
    /// The screen moved by a period [m].
    pub(crate) fn moved(&self, by: &Vector3<f64>) -> Self {
        match *self {
            Self::Plane { normal, offset } => Self::Plane { normal, offset: offset + normal.dot(by) },
            Self::Curved(quadric) => Self::Curved(quadric.moved(by)),
        }
    }

    /// Numbers by which a screen is known that many charges have.
    pub(super) fn key(&self) -> ScreenKey {
        let (place, normal) = match self {
            Self::Plane { normal, offset } => (normal * *offset, *normal),
            Self::Curved(quadric) => (quadric.centre(), quadric.normal()),
        };
        [place.x, place.y, place.z, normal.x, normal.y, normal.z].map(f64::to_bits)
    }

    /// Height of a point above the wall [m], positive on the charge's side.
    #[inline]
    pub(crate) fn height(&self, point: &Vector3<f64>) -> f64 {
        match self {
            Self::Plane { normal, offset } => offset - normal.dot(point),
            Self::Curved(quadric) => -quadric.above(point),
        }
    }
}

impl EdgeScreen {
    /// Numbers by which an edge is known that many charges have: a sheet and a body can share a rim.
    pub(super) fn key(&self) -> EdgeKey {
        let (place, across, angle) = (self.point, self.into + 2.0 * self.up, self.wedge.angle());
        let numbers = [place.x, place.y, place.z, across.x, across.y, across.z, angle];
        (numbers.map(f64::to_bits), self.wedge.faces())
    }

    /// Height of a point above the first face over its distance into it; infinite beside the face.
    pub(super) fn steepness(&self, point: &Vector3<f64>) -> f64 {
        let apart = point - self.point;
        let into = self.into.dot(&apart);
        if into > 0.0 { self.up.dot(&apart).abs() / into } else { f64::INFINITY }
    }

    /// The edge moved by a period [m].
    pub(crate) fn moved(&self, by: &Vector3<f64>) -> Self {
        Self { point: self.point + by, ..*self }
    }

    /// Place around the edge; `None` outside the space between the faces, where all of a charge is hidden.
    pub(crate) fn around(&self, place: &Place) -> Option<Around> {
        let angle_of = |apart: &Vector3<f64>| {
            let angle = apart.dot(&self.up).atan2(apart.dot(&self.into));
            if angle < 0.0 { angle + TAU } else { angle }
        };
        let apart = place.at - self.point;
        let seen = angle_of(&(place.seen_from - self.point));
        if seen > self.wedge.angle() {
            return None;
        }
        // A place on a face is on the side that it is seen from.
        let mut angle = angle_of(&apart);
        if (angle - seen).abs() > PI {
            angle -= TAU.copysign(angle - seen);
        }
        let r = apart.dot(&self.into).hypot(apart.dot(&self.up));
        Some(self.wedge.around(r, angle.clamp(0.0, self.wedge.angle()), apart.dot(&self.along)))
    }

    /// Potential that the faces add to a unit charge's at a place [1/m], with its gradient [1/m²].
    pub(crate) fn induced(&self, place: &Around, charge: &Around) -> (f64, Vector3<f64>) {
        let Induced { value, slope } = self.wedge.induced(place, charge);
        let [cosine, sine] = place.cosine_and_sine();
        let outwards = self.into * cosine + self.up * sine;
        let across = self.up * cosine - self.into * sine;
        (value, outwards * slope[0] + across * slope[1] + self.along * slope[2])
    }
}
