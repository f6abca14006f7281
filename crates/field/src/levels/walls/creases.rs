//! Creases: edges at which walls bend so much that the images of planes do not do.
//!
//! Around a crease the field is that between two half planes (`amberfield_laws::wedge`): around the rim of a
//! sheet, the edge of a plate or a body, and in a corner whose angle is not a right one.

use super::boundary::{BoundaryFaces, Condition};
use super::buckets::Buckets;
use super::edges::Edge;
use super::patch::{Patch, half_diagonal};
use super::screen::{EdgeScreen, RIGHT};
use amberfield_core::Domain;
use amberfield_laws::wedge::{Face, Wedge};
use nalgebra::Vector3;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Bend from which on an edge is a crease [rad]: faces that bend less are one wall.
pub(super) const LEAST_BEND: f64 = 0.69;
/// Difference from a right angle up to which a corner is one: its images are three points [rad].
const NEARLY_RIGHT: f64 = 0.02;
/// Part of a direction into a face that lies in a wall's plane at least, where the face is the wall's.
const LEAST_ALONG: f64 = 0.5;
/// Cosine of the angle of a face to a crease's faces below which it is another wall's, such as the back of a
/// plate; that of a face's normal and a crease above which the face stands across it.
const BACK: f64 = -0.5;
const ACROSS: f64 = 0.7;
/// Distance of a wall from a crease's half planes over its distance from the crease, at most.
const STRAIGHT: f64 = 0.2;
/// Part of the search's reach by which the nearest point of another crease may lie beside a crease's line
/// and still belong to it.
const ON_LINE: f64 = 0.05;

/// Part of a crease between two corners of faces.
#[derive(Clone, Copy, Debug)]
struct Piece {
    ends: [Vector3<f64>; 2],
    /// Directions into the two faces.
    into: [Vector3<f64>; 2],
    /// Outward normals of the two faces.
    normals: [Vector3<f64>; 2],
    faces: [u32; 2],
    /// Angle of the mesh between the faces, and their conditions.
    wedge: Wedge,
    /// Distance up to which the walls around it are the two half planes [m].
    straight: f64,
}

/// Creases of a mesh, or those of one wall.
#[derive(Debug)]
pub(super) struct Creases {
    pieces: Vec<Piece>,
    buckets: Buckets,
    reach: f64,
    domain: Domain,
}

/// Crease near a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearCrease {
    /// Nearest point of the crease, in the copy of the mesh in which the point is [m].
    at: Vector3<f64>,
    /// Distance from the point [m].
    pub(super) distance: f64,
    /// Direction along the crease.
    along: Vector3<f64>,
    /// An end of the piece, one for all points near it [m].
    line: Vector3<f64>,
    piece: Piece,
}

/// Blunt tip of a plate, between two creases.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tip {
    /// Distance of the two creases [m].
    pub(super) thickness: f64,
    /// Sheet in the place of the plate: through a charge before the tip, else along the plate's nearer side.
    pub(super) sheet: EdgeScreen,
    /// Plane of the tip.
    pub(super) plane: EdgeScreen,
    /// Space around the other crease.
    pub(super) other: EdgeScreen,
}

impl Creases {
    /// The creases among edges; a search finds those up to `reach` [m] away.
    pub(super) fn new(boundary: &dyn BoundaryFaces, edges: &[Edge], reach: f64) -> Self {
        let is_crease = |edge: &&Edge| {
            let is_right = (edge.angle - RIGHT).abs() < NEARLY_RIGHT;
            edge.bend().abs() > LEAST_BEND && !is_right
        };
        let mut creases = Self::of(boundary, edges.iter().filter(is_crease), reach);
        let all: Vec<u32> = (0..boundary.faces().len() as u32).collect();
        let patch = Patch::new(boundary.faces(), &all, reach);
        creases
            .pieces
            .par_iter_mut()
            .for_each(|piece| piece.straight = piece.straight_up_to(boundary, &patch, reach));
        creases
    }

    /// The free rims of a wall of some faces: creases around which the mesh goes.
    pub(super) fn rims_of(boundary: &dyn BoundaryFaces, edges: &[Edge], faces: &[u32], reach: f64) -> Self {
        let belongs = |edge: &&Edge| edge.faces.iter().any(|face| faces.binary_search(face).is_ok());
        Self::of(boundary, edges.iter().filter(|edge| edge.bend() > LEAST_BEND).filter(belongs), reach)
    }

    fn of<'a>(boundary: &dyn BoundaryFaces, edges: impl Iterator<Item = &'a Edge>, reach: f64) -> Self {
        let faces = boundary.faces();
        let kind = |face: u32| match faces[face as usize].condition {
            Condition::Potential(_) => Face::Conductor,
            Condition::Slope(_) => Face::Insulator,
        };
        let pieces: Vec<Piece> = edges
            .map(|edge| Piece {
                ends: edge.ends,
                into: edge.into,
                normals: edge.faces.map(|face| faces[face as usize].normal),
                faces: edge.faces,
                wedge: Wedge::new(edge.angle, edge.faces.map(kind)),
                straight: reach,
            })
            .collect();
        let longest = pieces.iter().map(|piece| (piece.ends[1] - piece.ends[0]).norm()).fold(0.0, f64::max);
        let middles: Vec<_> = pieces.iter().map(|piece| 0.5 * (piece.ends[0] + piece.ends[1])).collect();
        let buckets = Buckets::new(middles.iter(), reach + 0.5 * longest);
        Self { pieces, buckets, reach, domain: boundary.domain().clone() }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }

    /// The crease that is nearest to a point, if any is within reach.
    pub(super) fn nearest(&self, point: &Vector3<f64>) -> Option<NearCrease> {
        self.all_near(point).into_iter().min_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    /// The nearest rim that does not go on along the line of a given crease.
    pub(super) fn other_rim(&self, point: &Vector3<f64>, first: &NearCrease) -> Option<NearCrease> {
        let beside = |other: &NearCrease| {
            let apart = other.at - first.at;
            let aside = apart - first.along * first.along.dot(&apart);
            other.is_rim() && aside.norm() > ON_LINE * self.reach
        };
        let others = self.all_near(point).into_iter().filter(beside);
        others.min_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    fn all_near(&self, point: &Vector3<f64>) -> Vec<NearCrease> {
        if self.pieces.is_empty() {
            return Vec::new();
        }
        let near = self.buckets.near(&self.domain.wrap(*point));
        let creases = near.map(|number| self.pieces[number].near(point, &self.domain));
        creases.filter(|crease| crease.distance < self.reach).collect()
    }
}

impl Piece {
    /// Distance up to which the walls around the piece are the two half planes of its faces [m]: what looks
    /// another way from the back of a plate, and what stands across the crease, apart.
    fn straight_up_to(&self, boundary: &dyn BoundaryFaces, patch: &Patch, reach: f64) -> f64 {
        let middle = 0.5 * (self.ends[0] + self.ends[1]);
        let along = (self.ends[1] - self.ends[0]).normalize();
        let domain = boundary.domain();
        let bends_at = |face: usize| {
            let face = &boundary.faces()[face];
            let apart = domain.shortest(face.centre - middle);
            let distance = apart.norm();
            let looks = self.normals.map(|normal| normal.dot(&face.normal));
            let is_across = face.normal.dot(&along).abs() > ACROSS;
            let is_behind = self.normals.iter().all(|normal| normal.dot(&apart) > 0.0);
            let is_back = is_behind && looks.iter().any(|cosine| *cosine < BACK);
            if distance > reach || is_across || is_back {
                return f64::INFINITY;
            }
            let from_plane = |own: usize| {
                let inside = self.into[own].dot(&apart);
                let height = self.normals[own].dot(&apart);
                if inside < 0.0 { height.hypot(inside) } else { height.abs() }
            };
            let beside = from_plane(0).min(from_plane(1));
            let least = half_diagonal(face);
            if beside > STRAIGHT * distance.max(least) { distance - least } else { f64::INFINITY }
        };
        patch.near(&domain.wrap(middle)).map(bends_at).fold(reach, f64::min).max(0.0)
    }

    fn near(&self, point: &Vector3<f64>, domain: &Domain) -> NearCrease {
        let from_end = domain.shortest(point - self.ends[0]);
        let line = self.ends[0] + (point - self.ends[0] - from_end);
        let span = self.ends[1] - self.ends[0];
        let share = (from_end.dot(&span) / span.norm_squared()).clamp(0.0, 1.0);
        let apart = from_end - span * share;
        NearCrease { at: point - apart, distance: apart.norm(), along: span.normalize(), line, piece: *self }
    }
}

impl NearCrease {
    /// Distance up to which the walls around it are two half planes [m].
    pub(super) fn straight(&self) -> f64 {
        self.piece.straight
    }

    /// The crease's two faces.
    pub(super) fn faces(&self) -> [u32; 2] {
        self.piece.faces
    }

    /// Whether the mesh goes around it by more than half a turn.
    fn is_rim(&self) -> bool {
        self.piece.wedge.angle() > PI
    }

    /// Distance of a foot on a wall from the rim, into the wall [m], negative beyond it; the wall is known by
    /// its normal out of the mesh. `None` where the rim's faces stand across that wall.
    pub(super) fn inside(&self, normal: &Vector3<f64>, foot: &Vector3<f64>) -> Option<f64> {
        let own = usize::from(self.piece.normals[1].dot(normal) > self.piece.normals[0].dot(normal));
        let into = self.piece.into[own];
        let flat = into - normal * normal.dot(&into);
        Some(flat.try_normalize(LEAST_ALONG)?.dot(&(foot - self.line)))
    }

    /// Whether the line of this piece is about as far from a point as the crease is.
    fn goes_on_past(&self, point: &Vector3<f64>) -> bool {
        /// Distance from the line over that from the crease.
        const AS_FAR: f64 = 0.9;
        (point - self.line).cross(&self.along).norm() > AS_FAR * self.distance
    }

    /// The blunt tip of a plate that ends in this crease and in another; `None` where the two do not bound a
    /// tip.
    pub(super) fn tip(&self, other: &Self, point: &Vector3<f64>) -> Option<Tip> {
        /// Cosine of the angle of two edges that are parallel, of two directions that are one, and of two
        /// that stand across each other.
        const PARALLEL: f64 = 0.99;
        const SAME: f64 = 0.9;
        const ASIDE: f64 = 0.1;
        /// Share of a plate's thickness from which on a place is within it.
        const WITHIN: f64 = 1e-6;
        if self.along.dot(&other.along).abs() < PARALLEL || !other.goes_on_past(point) {
            return None;
        }
        let likeness = |[own, its]: [usize; 2]| other.piece.normals[its].dot(&self.piece.normals[own]);
        let pairs = [[0, 0], [0, 1], [1, 0], [1, 1]];
        let [face, its] = pairs.into_iter().max_by(|a, b| likeness(*a).total_cmp(&likeness(*b)))?;
        if likeness([face, its]) < SAME {
            return None;
        }
        let flat = |v: Vector3<f64>| v - self.along * self.along.dot(&v);
        let across = flat(other.line - self.line);
        let through = across.try_normalize(0.0)?;
        // The tip's face lies between the two.
        let is_tip = through.dot(&self.piece.into[face]).min(-through.dot(&other.piece.into[its])) > SAME;
        if !is_tip || through.dot(&self.piece.normals[face]).abs() > ASIDE {
            return None;
        }
        // Out of the mesh: into the plate.
        let into = flat(self.piece.normals[face]);
        let into = (into - through * through.dot(&into)).try_normalize(0.0)?;
        let apart = flat(point - self.line);
        let through_it = through.dot(&apart);
        let is_between = through_it > WITHIN * across.norm() && through_it < (1.0 - WITHIN) * across.norm();
        if is_between && into.dot(&apart) > 0.0 {
            // A plate that goes on would hold the charge.
            return None;
        }
        let place = through_it.clamp(0.0, across.norm());
        let kinds = self.piece.wedge.faces();
        let screen = |point: Vector3<f64>, into: Vector3<f64>, up: Vector3<f64>, angle: f64, kind: Face| {
            EdgeScreen { point, along: into.cross(&up), into, up, wedge: Wedge::new(angle, [kind; 2]) }
        };
        Some(Tip {
            thickness: across.norm(),
            sheet: screen(self.line + through * place, into, -through, TAU, kinds[1 - face]),
            plane: screen(self.line, through, -into, PI, kinds[face]),
            other: other.screen(),
        })
    }

    /// Sheet in the place of a body whose rim is not straight: along the face that a point is above, or
    /// between the two faces; `None` where the crease is no rim.
    pub(super) fn sheet(&self, point: &Vector3<f64>) -> Option<EdgeScreen> {
        if !self.is_rim() {
            return None;
        }
        let apart = point - self.at;
        let above = [0, 1].map(|own| self.piece.into[own].dot(&apart) >= 0.0);
        let own = usize::from(!above[0]);
        let (into, up) = if above[0] || above[1] {
            (self.piece.into[own], -self.piece.normals[own])
        } else {
            let into = (self.piece.into[0] + self.piece.into[1]).try_normalize(0.0)?;
            (into, self.along.cross(&into))
        };
        let wedge = Wedge::new(TAU, [self.piece.wedge.faces()[own]; 2]);
        Some(EdgeScreen { point: self.line, along: into.cross(&up), into, up, wedge })
    }

    /// The space between the crease's faces.
    pub(super) fn screen(&self) -> EdgeScreen {
        let into = self.piece.into[0];
        let up = self.along.cross(&into);
        let turn = if up.dot(&self.piece.normals[0]) > 0.0 { -1.0 } else { 1.0 };
        EdgeScreen {
            point: self.line,
            along: turn * self.along,
            into,
            up: turn * up,
            wedge: self.piece.wedge,
        }
    }
}
