//! Boundary that walls are made of: its faces, and what carries the field before them.

use amberfield_core::Domain;
use nalgebra::{Matrix3, Vector3};

/// Condition that is prescribed on a boundary face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Condition {
    /// The potential [V].
    Potential(f64),
    /// Outward slope ∂V/∂n of the potential [V/m].
    Slope(f64),
}

impl Condition {
    /// The potential [V] or slope [V/m].
    #[must_use]
    pub fn value(self) -> f64 {
        let (Self::Potential(value) | Self::Slope(value)) = self;
        value
    }
}

/// A face at the end of the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundaryFace {
    /// Centre [m].
    pub centre: Vector3<f64>,
    /// Unit normal out of the mesh.
    pub normal: Vector3<f64>,
    /// Area [m²].
    pub area: f64,
    /// Mean over its corners x of (x − centre)(x − centre)ᵀ [m²].
    pub spread: Matrix3<f64>,
    /// Cell that the face belongs to.
    pub cell: u32,
    /// Patch that the face belongs to.
    pub patch: u32,
    /// Condition on the whole potential.
    pub condition: Condition,
}

impl Carrier {
    /// Difference of the normals and planes of faces below which they are flat, over one and over the face's
    /// size: corners of facets are in single precision often.
    pub(super) fn flatness(self) -> f64 {
        match self {
            Self::Cells => 1e-6,
            Self::Facets => 1e-4,
        }
    }

    /// Cosine of the angle of walls up to which they mirror each other's images once. Where two walls are not
    /// at a right angle, the image's place depends on which comes first.
    pub(super) fn across(self) -> f64 {
        match self {
            Self::Cells => 0.7,
            Self::Facets => 0.3,
        }
    }
}

impl BoundaryFace {
    /// Whether its potential is given, and not the slope.
    #[must_use]
    pub fn gives_potential(&self) -> bool {
        matches!(self.condition, Condition::Potential(_))
    }
}

/// Carrier of the field that images leave; it decides which images there can be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::levels) enum Carrier {
    /// Cells before the walls: ghosts take the place of images that would lie in other cells.
    #[default]
    Cells,
    /// Charge on the walls' own facets: there are plain images only, fewer beside rims and in narrow gaps.
    Facets,
}

/// Faces at which the space of the grains ends.
pub(in crate::levels) trait BoundaryFaces: Sync {
    /// Carrier of the field that images leave.
    fn carrier(&self) -> Carrier;

    /// The faces.
    fn faces(&self) -> &[BoundaryFace];

    /// Corners of a face in order around it, right-handed about its normal [m]; at least three.
    fn corners_of(&self, face: usize) -> &[Vector3<f64>];

    /// Box that the faces are in, with its periods.
    fn domain(&self) -> &Domain;

    /// Size of the largest cell at a face and beside it [m].
    fn cell_around(&self, face: usize) -> f64;

    /// Size of the cell at a face [m].
    fn cell_at(&self, face: usize) -> f64;

    /// Size of the smallest cell [m].
    fn smallest_cell(&self) -> f64;

    /// Distance behind a face beyond which another face bounds the solid there [m].
    fn least_solid(&self, face: usize) -> f64;

    /// Distance before a face beyond which another face is the wall across [m].
    fn least_gap(&self, face: usize) -> f64;

    /// Place at which a face's condition counts [m].
    fn place_of_condition(&self, face: usize) -> Vector3<f64>;
}
