//! Cells that are parallelepipeds, as most meshes' are: all that tetrahedra say, in closed form.
//!
//! A place has coordinates x from −1 to 1 along the edges. Let m ≥ n ≥ t be their sizes. Its tetrahedron is
//! that of the face ahead of it along the first and of the edge of this face ahead along the second, with
//! the weights
//!
//! 1 − m of the cell's centre, m − n of the face's, (n + t)/2 and (n − t)/2 of the edge's corners.

use nalgebra::{Matrix3, Vector3};

/// Largest distance of a corner from where a parallelepiped has it, over its half edges: files hold six
/// digits. No share jumps by more where a grain crosses a face.
pub(super) const EVEN: f64 = 1e-4;

/// A parallelepiped. Bits of a corner's number are 1 where its coordinates are positive.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// Coordinates of a place seen from the centre [1/m].
    per_length: Matrix3<f64>,
    /// Number of the face behind and ahead along each edge, among the cell's.
    faces: [[u8; 2]; 3],
}

/// Coordinates of a place from −1 to 1 by size.
struct Sorted {
    /// Sizes, the largest first.
    sizes: [f64; 3],
    /// Bits of their axes.
    bits: [usize; 3],
    /// Corner next to the place.
    corner: usize,
}

impl Sorted {
    /// Sorts coordinates without a branch, which nothing could foretell.
    #[inline(always)]
    fn new(at: &Vector3<f64>) -> Self {
        let [x, y, z] = [at.x.abs(), at.y.abs(), at.z.abs()];
        let (less, more) = (x.min(y), x.max(y));
        let sizes = [more.max(z), less.max(more.min(z)), less.min(z)];
        let first = if (x >= y) & (x >= z) { 1 } else { 2 << usize::from(y < z) };
        let last = if (z <= x) & (z <= y) { 4 } else { 1 << usize::from(y <= x) };
        let corner = usize::from(at.x > 0.0) | usize::from(at.y > 0.0) << 1 | usize::from(at.z > 0.0) << 2;
        Self { sizes, bits: [first, 7 ^ first ^ last, last], corner }
    }
}

impl Block {
    /// Parallelepiped of the centres of a cell's faces and of its corners, both seen from its centre [m], if
    /// it is one; and which corner has which number.
    pub(super) fn new(to_face: &[Vector3<f64>], to_corner: &[Vector3<f64>]) -> Option<(Self, [usize; 8])> {
        if to_face.len() != 6 || to_corner.len() != 8 {
            return None;
        }
        let (mut edges, mut faces) = (Matrix3::zeros(), [[0; 2]; 3]);
        let mut left: Vec<usize> = (0..6).collect();
        for (axis, behind_and_ahead) in faces.iter_mut().enumerate() {
            let ahead = left.remove(0);
            let apart = |face: usize| (to_face[face] + to_face[ahead]).norm();
            let opposite = (0..left.len()).min_by(|&a, &b| apart(left[a]).total_cmp(&apart(left[b])))?;
            *behind_and_ahead = [left.remove(opposite) as u8, ahead as u8];
            edges.set_column(axis, &to_face[ahead]);
        }
        let per_length = edges.try_inverse()?;
        let mut numbers = [usize::MAX; 8];
        for (place, corner) in to_corner.iter().enumerate() {
            let at = per_length * corner;
            if at.iter().any(|x| (x.abs() - 1.0).abs() > EVEN) {
                return None;
            }
            numbers[Sorted::new(&at).corner] = place;
        }
        numbers.iter().all(|&place| place < 8).then_some((Self { per_length, faces }, numbers))
    }

    /// Coordinates of a place seen from the centre [m].
    #[inline(always)]
    pub(super) fn coordinates(&self, from: &Vector3<f64>) -> Vector3<f64> {
        self.per_length * from
    }

    /// Coordinates of vectors of a length [m] along the axes.
    #[inline(always)]
    pub(super) fn coordinates_of(&self, length: f64) -> Matrix3<f64> {
        self.per_length * length
    }

    /// Number of the face ahead of a place at coordinates, among the cell's.
    pub(super) fn face(&self, at: &Vector3<f64>) -> usize {
        let axis = at.iamax();
        usize::from(self.faces[axis][usize::from(at[axis] > 0.0)])
    }

    /// Adds the weights of the corners around a place at coordinates, times a share.
    #[inline(always)]
    pub(super) fn add(at: &Vector3<f64>, share: f64, weights: &mut [f64; 8]) {
        let Sorted { sizes: [most, middle, least], bits: [first, second, third], corner } = Sorted::new(at);
        // A centre's weight goes to all corners around it alike.
        let all = share * (1.0 - most) / 8.0;
        let of_face = all + share * (most - middle) / 4.0;
        let far = of_face + share * (middle - least) / 2.0;
        let near = far + share * least;
        weights[corner] += near;
        weights[corner ^ third] += far;
        weights[corner ^ second] += of_face;
        weights[corner ^ second ^ third] += of_face;
        weights[corner ^ first] += all;
        weights[corner ^ first ^ third] += all;
        weights[corner ^ first ^ second] += all;
        weights[corner ^ 7] += all;
    }
}
