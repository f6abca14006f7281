//! A curved wall: what its facets say of the surface through their corners.
//!
//! Around each face the surface is z = s + b·u + ½ uᵀKu over the face's plane: slope b and curvature K fit
//! the centres and normals of the faces around it, and s = −½ tr(K M), with M the mean square of the
//! corners' distances from the centre, brings the corners onto it. Facets lie inside a concave wall by s:
//! images in one surface and boundary data on the other would be wrong by more than all the rest.

use super::DEEPEST;
use super::boundary::BoundaryFace;
use super::creases::Creases;
use super::mirror::{Ground, Mirror, Side};
use super::patch::{Patch, half_diagonal};
use super::screen::Screen;
use super::smooth::Surface;
use nalgebra::{Matrix2, SMatrix, SVector, Vector2, Vector3};

/// Steps of Newton's method to the nearest point of a surface.
const STEPS: usize = 4;
/// Faces on the way to the one that holds a foot.
const HOPS: usize = 6;
/// Distance beside its face at which a foot is still on the wall, over the half diagonal.
const BESIDE: f64 = 1.5;
/// Slope of a surface over its face, and its change along the face's half diagonal, at most.
const STEEPEST: f64 = 1.0;
/// Height of a surface over its face at most, over the half diagonal.
const HIGHEST: f64 = 0.5;
/// Depth over the distance of the wall across: images of opposite places never meet.
const OF_GAP: f64 = 0.5;

/// The surface around a face, z = s + b·u + ½ uᵀKu.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quadric {
    centre: Vector3<f64>,
    normal: Vector3<f64>,
    along: [Vector3<f64>; 2],
    /// s [m], b, K [1/m].
    height: f64,
    slope: Vector2<f64>,
    bend: Matrix2<f64>,
}

/// A face of a curved wall.
#[derive(Clone, Debug)]
struct Facet {
    /// Number in the boundary.
    face: u32,
    surface: Quadric,
    half: f64,
    /// Faces around it, by their number in the patch.
    around: Vec<u32>,
}

/// A curved piece of the boundary.
#[derive(Debug)]
pub(super) struct CurvedWall {
    facets: Vec<Facet>,
    patch: Patch,
    conductor: bool,
    ground: Vec<Ground>,
    rims: Creases,
    /// Corners of the box in which charges can be mirrored [m].
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl CurvedWall {
    /// A wall of faces; `around` has each face's neighbours in it, by their number among `faces`.
    pub(super) fn new(surface: &Surface<'_>, faces: &[u32], around: &[Vec<u32>]) -> Self {
        let all = surface.boundary.faces();
        let member = |index: u32| &all[faces[index as usize] as usize];
        let facets = (0..faces.len() as u32).map(|index| {
            let near = &around[index as usize];
            let others = near.iter().map(|&other| member(other));
            let surface = Quadric::through(member(index), others);
            let face = faces[index as usize];
            Facet { face, surface, half: half_diagonal(member(index)), around: near.clone() }
        });
        let ground = |&face: &u32| {
            let ground = surface.ground(face);
            Ground { depth: ground.depth.min(OF_GAP * surface.around[face as usize].gap), ..ground }
        };
        let ground: Vec<Ground> = faces.iter().map(ground).collect();
        let deepest = ground.iter().map(|ground| ground.depth).fold(0.0, f64::max);
        let (mut low, mut high) = (member(0).centre, member(0).centre);
        for &face in faces {
            let face = &all[face as usize];
            let reach = Vector3::repeat(BESIDE * half_diagonal(face) + DEEPEST * deepest);
            low = low.inf(&(face.centre - reach));
            high = high.sup(&(face.centre + reach));
        }
        Self {
            low,
            high,
            facets: facets.collect(),
            patch: Patch::new(all, faces, DEEPEST * deepest),
            conductor: member(0).gives_potential(),
            ground,
            rims: Creases::rims_of(surface.boundary, surface.edges, faces, surface.reach),
        }
    }

    /// The point of the surface over a point of a face.
    pub(super) fn place(&self, face: usize, point: &Vector3<f64>) -> Vector3<f64> {
        self.facets[face].surface.foot(point).at
    }

    /// Height of the surface over a face's centre, along the face's normal [m].
    pub(super) fn height(&self, face: usize) -> f64 {
        self.facets[face].surface.height
    }

    /// Mirrors a charge at a point, with depths scaled.
    pub(super) fn mirror(&self, point: &Vector3<f64>, depth_scale: f64) -> Option<Mirror> {
        if (0..3).any(|axis| point[axis] < self.low[axis] || point[axis] > self.high[axis]) {
            return None;
        }
        let mut index = self.patch.nearest(point)?;
        let mut foot = self.facets[index].surface.foot(point);
        for _ in 0..HOPS {
            let apart = |face: usize| (self.facets[face].surface.centre - foot.at).norm_squared();
            let others = self.facets[index].around.iter().map(|&face| face as usize);
            match others.min_by(|a, b| apart(*a).total_cmp(&apart(*b))) {
                Some(nearer) if apart(nearer) < apart(index) => index = nearer,
                _ => break,
            }
            foot = self.facets[index].surface.foot(point);
        }
        let (facet, ground) = (&self.facets[index], &self.ground[index].deeper(depth_scale));
        let distance = foot.normal.dot(&(foot.at - point));
        // An image is not farther outside than the deepest charge of a flat wall is inside.
        let depth = ground.depth / (1.0 + facet.surface.sharpest().max(0.0) * ground.depth);
        let beside = (foot.at - facet.surface.centre).norm() > BESIDE * facet.half;
        if beside || !(0.0..depth).contains(&distance) {
            return None;
        }
        // What an insulator adds to the image of a sphere is no point charge: the plane's is as good.
        let curvature = if self.conductor { -0.5 * facet.surface.bend.trace() } else { 0.0 };
        let image_depth = distance / (1.0 - curvature * distance);
        let side = Side::of(ground, &self.rims, &foot.at, &foot.normal, image_depth)?;
        Some(Mirror {
            face: Some(facet.face),
            normal: foot.normal,
            offset: foot.normal.dot(&foot.at),
            distance,
            curvature,
            depth,
            share: side.share(ground),
            screened: side.screened(ground, || Screen::Curved(facet.surface)),
        })
    }
}

/// The nearest point of a surface, and the normal there.
struct Foot {
    at: Vector3<f64>,
    normal: Vector3<f64>,
}

impl Quadric {
    /// The surface through a face's corners that fits the faces around it.
    fn through<'a>(face: &BoundaryFace, others: impl Iterator<Item = &'a BoundaryFace>) -> Self {
        let normal = face.normal;
        let aside = Vector3::ith(normal.iamin(), 1.0);
        let first = normal.cross(&aside).normalize();
        let along = [first, normal.cross(&first)];
        let half = half_diagonal(face);
        let flat = |v: &Vector3<f64>| Vector2::new(along[0].dot(v), along[1].dot(v));
        let (mut matrix, mut right) = (SMatrix::<f64, 5, 5>::zeros(), SVector::<f64, 5>::zeros());
        let mut add = |row: SVector<f64, 5>, value: f64| {
            matrix += row * row.transpose();
            right += row * value;
        };
        for other in others {
            let apart = other.centre - face.centre;
            let (u, z) = (flat(&apart), normal.dot(&apart));
            add(SVector::from([u.x, u.y, 0.5 * u.x * u.x, u.x * u.y, 0.5 * u.y * u.y]), z);
            let slope = -flat(&other.normal) / normal.dot(&other.normal);
            add(SVector::from([half, 0.0, half * u.x, half * u.y, 0.0]), half * slope.x);
            add(SVector::from([0.0, half, 0.0, half * u.x, half * u.y]), half * slope.y);
        }
        let fit = matrix.cholesky().map_or_else(SVector::zeros, |factors| factors.solve(&right));
        let slope = Vector2::new(fit[0], fit[1]);
        let bend = Matrix2::new(fit[2], fit[3], fit[3], fit[4]);
        let spread = |a: usize, b: usize| along[a].dot(&(face.spread * along[b]));
        let spread = Matrix2::new(spread(0, 0), spread(0, 1), spread(0, 1), spread(1, 1));
        let height = -0.5 * (bend * spread).trace();
        let flat = Self {
            centre: face.centre,
            normal,
            along,
            height: 0.0,
            slope: Vector2::zeros(),
            bend: Matrix2::zeros(),
        };
        // Faces that are no part of a smooth surface, or too few of them, say nothing of one.
        let is_smooth =
            slope.norm() < STEEPEST && bend.norm() * half < STEEPEST && height.abs() < HIGHEST * half;
        if is_smooth { Self { height, slope, bend, ..flat } } else { flat }
    }

    /// Centre of the face that the surface is about [m].
    pub(crate) fn centre(&self) -> Vector3<f64> {
        self.centre
    }

    /// Normal of that face, out of the mesh.
    pub(crate) fn normal(&self) -> Vector3<f64> {
        self.normal
    }

    /// The surface moved by a period [m].
    pub(crate) fn moved(&self, by: &Vector3<f64>) -> Self {
        Self { centre: self.centre + by, ..*self }
    }

    /// Largest curvature towards the inside [1/m].
    fn sharpest(&self) -> f64 {
        -self.bend.symmetric_eigenvalues().min()
    }

    /// Height of a point above the surface along the face's normal, out of the mesh [m].
    pub(crate) fn above(&self, point: &Vector3<f64>) -> f64 {
        let apart = point - self.centre;
        let u = Vector2::new(self.along[0].dot(&apart), self.along[1].dot(&apart));
        self.normal.dot(&apart) - (self.height + self.slope.dot(&u) + 0.5 * u.dot(&(self.bend * u)))
    }

    fn foot(&self, point: &Vector3<f64>) -> Foot {
        let apart = point - self.centre;
        let (over, above) =
            (Vector2::new(self.along[0].dot(&apart), self.along[1].dot(&apart)), self.normal.dot(&apart));
        let surface = |u: &Vector2<f64>| {
            (self.height + self.slope.dot(u) + 0.5 * u.dot(&(self.bend * u)), self.slope + self.bend * u)
        };
        let mut u = over;
        for _ in 0..STEPS {
            let (z, slope) = surface(&u);
            let residual = u - over + (z - above) * slope;
            let jacobian = Matrix2::identity() + slope * slope.transpose() + (z - above) * self.bend;
            let Some(inverse) = jacobian.try_inverse() else { break };
            u -= inverse * residual;
        }
        let (z, slope) = surface(&u);
        let normal = (self.normal - self.along[0] * slope.x - self.along[1] * slope.y).normalize();
        Foot { at: self.centre + self.along[0] * u.x + self.along[1] * u.y + self.normal * z, normal }
    }
}
