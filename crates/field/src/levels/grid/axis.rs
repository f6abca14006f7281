//! One axis of the internal grid: nodes, what lies beyond its ends, and the transform that knows both.

use super::transform::{LineTransform, Symmetry};
use super::window::HALO;
use crate::geometry::images::{AxisKind, FaceKind};
use amberfield_core::{Axis, Domain};

/// Truncated kernels are smoothed by a Gaussian; its tail beyond this many widths is below 2e-9.
pub(crate) const TAIL_WIDTHS: f64 = 6.0;

/// Number of an axis's nodes and their places: all that its cost depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AxisSize {
    /// Nodes that carry charge.
    pub(crate) nodes: usize,
    /// Node spacing h [m].
    pub(crate) spacing: f64,
    /// Length of the transformed line: with an open end, zero-padded.
    pub(crate) padded: usize,
    /// Lower end of the first node's cell [m].
    origin: f64,
    /// Index of node 0 in the padded line.
    offset: usize,
}

impl AxisSize {
    /// Axis of a domain with nodes at most `spacing` apart. `padding` is what a zero-padded line needs beyond
    /// twice its own length [m].
    pub(crate) fn new(domain: &Domain, axis: Axis, spacing: f64, padding: f64) -> Self {
        let length = domain.extent()[axis.index()];
        let lower = domain.min()[axis.index()];
        let whole = (length / spacing).ceil().max(1.0) as usize;
        let (below, above) = match AxisKind::of(domain, axis) {
            kind @ AxisKind::Faces(below, above) if kind.is_open() => (below, above),
            _ => {
                let nodes = smooth_even(whole.max(2));
                return Self {
                    nodes,
                    spacing: length / nodes as f64,
                    padded: nodes,
                    origin: lower,
                    offset: 0,
                };
            }
        };
        let [below, above] = [below, above].map(|face| if face == FaceKind::Open { HALO } else { 0 });
        let nodes = whole + below + above;
        let spacing = length / whole as f64;
        let padded = smooth_even(2 * nodes + (padding / spacing).ceil() as usize);
        // A wall at the upper end stays at the end of the line.
        let offset = if below > 0 && above == 0 { padded - nodes } else { 0 };
        Self { nodes, spacing, padded, origin: lower - below as f64 * spacing, offset }
    }
}

/// One axis of the grid. Node i lies at `origin + (i + ½) spacing`.
#[derive(Debug)]
pub(crate) struct GridAxis {
    /// Nodes that carry charge.
    pub(crate) nodes: usize,
    /// Node spacing h [m].
    pub(crate) spacing: f64,
    origin: f64,
    /// Transform of the (zero-padded) line.
    pub(crate) transform: LineTransform,
    /// Index of node 0 in the padded line.
    pub(crate) offset: usize,
    /// Whether one or both ends are open: the line is zero-padded.
    pub(crate) open: bool,
    kind: AxisKind,
}

impl GridAxis {
    /// Axis of a domain with the given size.
    pub(crate) fn new(domain: &Domain, axis: Axis, size: AxisSize) -> Self {
        let AxisSize { nodes, spacing, padded, origin, offset } = size;
        let kind = AxisKind::of(domain, axis);
        let transform = LineTransform::new(symmetry(kind), padded);
        Self { nodes, spacing, origin, transform, offset, open: kind.is_open(), kind }
    }

    /// Whether both ends are joined.
    pub(crate) fn is_periodic(&self) -> bool {
        self.kind == AxisKind::Periodic
    }

    /// Greatest distance between a charge and a node, images included [m].
    pub(crate) fn reach(&self) -> f64 {
        let images = if self.open && self.transform.symmetry() != Symmetry::Periodic { 2.0 } else { 1.0 };
        images * self.nodes as f64 * self.spacing
    }

    /// Half the period of the padded line with its images, in nodes.
    pub(crate) fn half_period(&self) -> usize {
        match self.transform.symmetry() {
            Symmetry::Periodic => self.transform.len() / 2,
            _ => self.transform.len(),
        }
    }

    /// Position in node units: node i at i.
    #[inline(always)]
    pub(crate) fn to_nodes(&self, coordinate: f64) -> f64 {
        (coordinate - self.origin) / self.spacing - 0.5
    }

    /// The node that stands for `index` (which may lie beyond the ends) and its sign; `None` in free space.
    pub(crate) fn fold(&self, index: isize) -> Option<(usize, f64)> {
        let nodes = self.nodes as isize;
        let (mut index, mut sign) = (index, 1.0);
        loop {
            let (side, mirrored, wrapped) = if index < 0 {
                (0, -1 - index, index + nodes)
            } else if index >= nodes {
                (1, 2 * nodes - 1 - index, index - nodes)
            } else {
                return Some((index as usize, sign));
            };
            let AxisKind::Faces(lower, upper) = self.kind else {
                index = wrapped;
                continue;
            };
            match [lower, upper][side] {
                FaceKind::Conductor => (index, sign) = (mirrored, -sign),
                FaceKind::Insulator => index = mirrored,
                FaceKind::Open => return None,
            }
        }
    }
}

/// Returns how the line of an axis is continued by the images in its faces.
pub(crate) fn symmetry(kind: AxisKind) -> Symmetry {
    use FaceKind::{Conductor, Insulator, Open};
    match kind {
        AxisKind::Periodic | AxisKind::Faces(Open, Open) => Symmetry::Periodic,
        AxisKind::Faces(Conductor, Insulator) => Symmetry::OddEven,
        AxisKind::Faces(Insulator, Conductor) => Symmetry::EvenOdd,
        // The far end of a padded line is empty: either parity serves.
        AxisKind::Faces(Conductor, _) | AxisKind::Faces(_, Conductor) => Symmetry::OddOdd,
        AxisKind::Faces(..) => Symmetry::EvenEven,
    }
}

/// Smallest even number of the form 2ᵃ3ᵇ5ᶜ that is at least `least`.
pub(crate) fn smooth_even(least: usize) -> usize {
    (least.max(2)..)
        .find(|&n| {
            let mut rest = n;
            for factor in [2, 3, 5] {
                while rest.is_multiple_of(factor) {
                    rest /= factor;
                }
            }
            n % 2 == 0 && rest == 1
        })
        .expect("powers of two are unbounded")
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::Boundary;
    use nalgebra::Vector3;

    fn axis(lower: Boundary, upper: Boundary) -> GridAxis {
        let mut faces = [[Boundary::Open; 2]; 3];
        faces[0] = [lower, upper];
        let domain = Domain::new(Vector3::zeros(), Vector3::repeat(1.0), faces).unwrap();
        GridAxis::new(&domain, Axis::X, AxisSize::new(&domain, Axis::X, 0.25, 0.0))
    }

    #[test]
    fn folding_follows_the_faces() {
        let insulating = Boundary::Insulating { normal_field_v_m: 0.0 };
        let mixed = axis(Boundary::Grounded, insulating);
        assert_eq!(mixed.fold(-1), Some((0, -1.0)));
        assert_eq!(mixed.fold(4), Some((3, 1.0)));
        assert_eq!(mixed.fold(9), Some((1, -1.0)));
        assert_eq!(axis(Boundary::Periodic, Boundary::Periodic).fold(-1), Some((3, 1.0)));
        let half = axis(Boundary::Grounded, Boundary::Open);
        assert_eq!(half.fold(-2), Some((1, -1.0)));
        assert_eq!(half.fold(half.nodes as isize), None);
    }

    #[test]
    fn open_sides_leave_room_for_the_widest_window() {
        let open = axis(Boundary::Open, Boundary::Open);
        assert_eq!(open.nodes, 4 + 2 * HALO);
        assert!((open.to_nodes(0.0) - (HALO as f64 - 0.5)).abs() < 1e-12);
        assert!(open.transform.len() >= 2 * open.nodes);
    }

    #[test]
    fn sizes_are_smooth_and_even() {
        assert_eq!([1, 7, 11, 25, 97, 121].map(smooth_even), [2, 8, 12, 30, 100, 128]);
    }
}
