//! Free rims: edges of sheets, plates and bodies, around which the mesh goes.

use super::buckets::Buckets;
use super::edges::Edge;
use super::screen::HalfPlane;
use crate::levels::far::mesh::FarMesh;
use amberfield_core::Domain;
use nalgebra::Vector3;

/// Bend from which on an edge is a free rim [rad]: faces that bend less are one wall.
pub(super) const LEAST_BEND: f64 = 0.69;
/// Part of a direction into a face that lies in a wall's plane at least, where the face is the wall's.
const LEAST_ALONG: f64 = 0.5;
/// Part of the search's reach by which the nearest point of another rim may lie beside a rim's line and
/// still belong to it.
const ON_LINE: f64 = 0.05;

/// Part of a rim between two corners.
#[derive(Clone, Copy, Debug)]
struct Piece {
    ends: [Vector3<f64>; 2],
    /// Directions into the two faces.
    into: [Vector3<f64>; 2],
    /// Outward normals of the two faces.
    normals: [Vector3<f64>; 2],
    faces: [u32; 2],
}

/// Rims of a mesh, or those of one wall.
#[derive(Debug)]
pub(super) struct Rims {
    pieces: Vec<Piece>,
    buckets: Buckets,
    reach: f64,
    domain: Domain,
}

/// Rim near a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearRim {
    /// Nearest point of the rim, in the copy of the mesh in which the point is [m].
    pub(super) at: Vector3<f64>,
    /// Distance from the point [m].
    pub(super) distance: f64,
    /// Direction along the rim.
    along: Vector3<f64>,
    piece: Piece,
}

impl Rims {
    /// The rims among edges, or those that faces among `of` have; a search finds those up to `reach` [m]
    /// away.
    pub(super) fn new(mesh: &FarMesh, edges: &[Edge], of: Option<&[u32]>, reach: f64) -> Self {
        let belongs = |edge: &&Edge| {
            of.is_none_or(|faces| edge.faces.iter().any(|face| faces.binary_search(face).is_ok()))
        };
        let normal = |face: u32| mesh.boundary()[face as usize].normal;
        let rims = edges.iter().filter(|edge| edge.bend() > LEAST_BEND).filter(belongs);
        let pieces: Vec<Piece> = rims
            .map(|edge| Piece {
                ends: edge.ends,
                into: edge.into,
                normals: edge.faces.map(normal),
                faces: edge.faces,
            })
            .collect();
        let longest = pieces.iter().map(|piece| (piece.ends[1] - piece.ends[0]).norm()).fold(0.0, f64::max);
        let middles: Vec<_> = pieces.iter().map(|piece| 0.5 * (piece.ends[0] + piece.ends[1])).collect();
        let buckets = Buckets::new(middles.iter(), reach + 0.5 * longest);
        Self { pieces, buckets, reach, domain: mesh.domain().clone() }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }

    /// The rim that is nearest to a point, if any is within reach.
    pub(super) fn nearest(&self, point: &Vector3<f64>) -> Option<NearRim> {
        self.all_near(point).into_iter().min_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    /// Distance of the nearest rim that does not go on along the line of a given one [m].
    pub(super) fn other(&self, point: &Vector3<f64>, first: &NearRim) -> f64 {
        let beside = |rim: &NearRim| {
            let apart = rim.at - first.at;
            let aside = apart - first.along * first.along.dot(&apart);
            aside.norm() > ON_LINE * self.reach
        };
        self.all_near(point)
            .iter()
            .filter(|rim| beside(rim))
            .map(|rim| rim.distance)
            .fold(f64::INFINITY, f64::min)
    }

    fn all_near(&self, point: &Vector3<f64>) -> Vec<NearRim> {
        if self.pieces.is_empty() {
            return Vec::new();
        }
        let near = self.buckets.near(&self.domain.wrap(*point));
        let rims = near.map(|number| self.pieces[number].near(point, &self.domain));
        rims.filter(|rim| rim.distance < self.reach).collect()
    }
}

impl Piece {
    fn near(&self, point: &Vector3<f64>, domain: &Domain) -> NearRim {
        let from_end = domain.shortest(point - self.ends[0]);
        let span = self.ends[1] - self.ends[0];
        let share = (from_end.dot(&span) / span.norm_squared()).clamp(0.0, 1.0);
        let apart = from_end - span * share;
        NearRim { at: point - apart, distance: apart.norm(), along: span.normalize(), piece: *self }
    }
}

impl NearRim {
    /// Half plane that goes on from the rim as one wall does: with the wall's normal, out of the mesh; `None`
    /// where the rim's faces stand across that wall.
    pub(super) fn of_wall(&self, normal: &Vector3<f64>) -> Option<HalfPlane> {
        let own = usize::from(self.piece.normals[1].dot(normal) > self.piece.normals[0].dot(normal));
        let into = self.piece.into[own];
        let flat = into - normal * normal.dot(&into);
        let into = flat.try_normalize(LEAST_ALONG)?;
        Some(HalfPlane { rim: self.at, into, up: -normal })
    }

    /// Half plane between the rim's two faces, for a charge beyond the rim; `None` where one of the faces is
    /// below the charge.
    pub(super) fn between_faces(&self, point: &Vector3<f64>) -> Option<HalfPlane> {
        let apart = point - self.at;
        let below = |face: usize| {
            self.piece.into[face].dot(&apart) >= 0.0 && self.piece.normals[face].dot(&apart) <= 0.0
        };
        if below(0) || below(1) {
            return None;
        }
        let into = (self.piece.into[0] + self.piece.into[1]).try_normalize(0.0)?;
        let up = self.along.cross(&into);
        Some(HalfPlane { rim: self.at, into, up: if up.dot(&apart) < 0.0 { -up } else { up } })
    }

    /// One of the rim's faces.
    pub(super) fn face(&self) -> u32 {
        self.piece.faces[0]
    }
}
