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
    /// Half edges, if they are along the axes [m].
    cuboid: Option<Vector3<f64>>,
    /// Number of the face behind and ahead along each edge, among the cell's.
    faces: [[u8; 2]; 3],
}

/// Coordinates of a place from −1 to 1 by size.
struct Sorted {
    /// Sizes, the largest first.
    sizes: [f64; 3],
    /// Axes that they are along.
    axes: [usize; 3],
}

impl Sorted {
    /// Sorts coordinates without a branch, which nothing could foretell.
    #[inline(always)]
    fn new(at: &Vector3<f64>) -> Self {
        let [x, y, z] = [at.x.abs(), at.y.abs(), at.z.abs()];
        let (less, more) = (x.min(y), x.max(y));
        let sizes = [more.max(z), less.max(more.min(z)), less.min(z)];
        let first = if (x >= y) & (x >= z) { 0 } else { 1 + usize::from(y < z) };
        let last = if (z <= x) & (z <= y) { 2 } else { usize::from(y <= x) };
        Self { sizes, axes: [first, 3 - first - last, last] }
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
            // The face most ahead along an axis: cuboids have their edges in the order of the axes.
            let cosine = |face: usize| to_face[face][axis] / to_face[face].norm();
            let ahead = (0..left.len()).max_by(|&a, &b| cosine(left[a]).total_cmp(&cosine(left[b])))?;
            let ahead = left.remove(ahead);
            let apart = |face: usize| (to_face[face] + to_face[ahead]).norm();
            let opposite = (0..left.len()).min_by(|&a, &b| apart(left[a]).total_cmp(&apart(left[b])))?;
            *behind_and_ahead = [left.remove(opposite) as u8, ahead as u8];
            edges.set_column(axis, &to_face[ahead]);
        }
        let per_length = edges.try_inverse()?;
        let halves = edges.diagonal();
        let beside = (edges - Matrix3::from_diagonal(&halves)).amax();
        let cuboid = (beside < EVEN * halves.amin()).then_some(halves);
        let mut numbers = [usize::MAX; 8];
        for (place, corner) in to_corner.iter().enumerate() {
            let at = per_length * corner;
            if at.iter().any(|x| (x.abs() - 1.0).abs() > EVEN) {
                return None;
            }
            numbers[(0..3).map(|axis| usize::from(at[axis] > 0.0) << axis).sum::<usize>()] = place;
        }
        numbers.iter().all(|&place| place < 8).then_some((Self { per_length, faces, cuboid }, numbers))
    }

    /// Coordinates of a place seen from the centre [m].
    #[inline(always)]
    pub(super) fn coordinates(&self, from: &Vector3<f64>) -> Vector3<f64> {
        self.per_length * from
    }

    /// Number of the face ahead of a place at coordinates, among the cell's.
    pub(super) fn face(&self, at: &Vector3<f64>) -> usize {
        let axis = at.iamax();
        usize::from(self.faces[axis][usize::from(at[axis] > 0.0)])
    }

    /// Half edges [m] of one whose edges are along the axes.
    #[inline(always)]
    pub(super) fn cuboid(&self) -> Option<&Vector3<f64>> {
        self.cuboid.as_ref()
    }

    /// Adds the weights of the corners around a place at coordinates, times a share.
    #[inline(always)]
    pub(super) fn add(at: &Vector3<f64>, share: f64, weights: &mut [f64; 8]) {
        add(at, share, 0, [1, 2, 4], weights);
    }
}

/// Adds the weights of the corners around a place at coordinates, times a share: corners from `first` on,
/// which are so many steps from each other along the axes.
#[inline(always)]
pub(super) fn add<const N: usize>(
    at: &Vector3<f64>,
    share: f64,
    first: usize,
    steps: [usize; 3],
    weights: &mut [f64; N],
) {
    let Sorted { sizes: [most, middle, least], axes } = Sorted::new(at);
    // A centre's weight goes to all corners around it alike.
    let all = share * (1.0 - most) / 8.0;
    let of_face = all + share * (most - middle) / 4.0;
    let far = of_face + share * (middle - least) / 2.0;
    let near = far + share * least;
    let ends = |axis: usize| if at[axis] > 0.0 { [steps[axis], 0] } else { [0, steps[axis]] };
    let [[ahead, behind], [beside, opposite], [here, there]] = axes.map(ends);
    let (on_face, off_face) = (first + ahead, first + behind);
    weights[on_face + beside + here] += near;
    weights[on_face + beside + there] += far;
    weights[on_face + opposite + here] += of_face;
    weights[on_face + opposite + there] += of_face;
    for corner in [beside + here, beside + there, opposite + here, opposite + there] {
        weights[off_face + corner] += all;
    }
}
