//! The nodes that the grains of one rank touch: a brick of the grid.
//!
//! Windows reach over faces, where images stand for what lies beyond, and over periodic ones to the other
//! side. What travels between ranks has only nodes of the grid, each once: a brick's *folded* nodes.

use crate::geometry::images::BoundingBox;
use crate::levels::grid::assignment::Assignment;
use crate::levels::grid::axis::GridAxis;
use crate::levels::grid::nodes::NodeArray;
use crate::levels::grid::solve::{Planes, Rows};
use crate::levels::grid::window::MAX_ORDER;
use std::ops::Range;

/// Nodes that windows touch along one axis.
#[derive(Clone, Debug, PartialEq)]
struct Span {
    /// First node touched; may lie beyond the ends of the axis.
    first: isize,
    /// Number of nodes from there.
    count: usize,
    /// Nodes of the grid that these stand for, in two runs that ascend: at a periodic face the axis is cut.
    folded: [Range<usize>; 2],
}

impl Span {
    fn new(axis: &GridAxis, [first, last]: [isize; 2]) -> Self {
        let nodes = axis.nodes;
        let count = usize::try_from(last - first + 1).expect("the last is not below the first");
        let mut is_touched = (first..=last).filter_map(|node| axis.fold(node)).map(|(node, _)| node);
        let folded = if axis.is_periodic() {
            let start = first.rem_euclid(nodes as isize) as usize;
            let end = start + count.min(nodes);
            [0..end.saturating_sub(nodes), start..end.min(nodes)]
        } else {
            let lowest = is_touched.next().unwrap_or(0);
            let ends = is_touched.fold([lowest; 2], |[low, high], node| [low.min(node), high.max(node)]);
            [0..0, ends[0]..ends[1] + 1]
        };
        Self { first, count, folded }
    }

    /// Number of folded nodes.
    fn len(&self) -> usize {
        self.folded.iter().map(ExactSizeIterator::len).sum()
    }

    fn contains(&self, node: usize) -> bool {
        self.folded.iter().any(|run| run.contains(&node))
    }

    /// Number of folded nodes below a node: its own place among them, if it is one.
    fn below(&self, node: usize) -> usize {
        self.folded.iter().map(|run| node.clamp(run.start, run.end) - run.start).sum()
    }

    /// Folded nodes in their order.
    fn nodes(&self) -> impl Iterator<Item = usize> {
        self.folded.clone().into_iter().flatten()
    }

    /// Place among the folded nodes and sign of the image, for each node touched; `None` in free space.
    fn places(&self, axis: &GridAxis) -> Vec<Option<(usize, f64)>> {
        let place = |number: usize| {
            let (node, sign) = axis.fold(self.first + number as isize)?;
            Some((self.below(node), sign))
        };
        (0..self.count).map(place).collect()
    }
}

/// The nodes that the grains of one rank touch.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Brick {
    spans: [Span; 3],
}

impl Brick {
    /// Nodes touched by grains in a box.
    pub(super) fn new(axes: &[GridAxis; 3], assignment: &Assignment, grains: &BoundingBox) -> Self {
        let span = |axis: usize| {
            let ends = [grains.min[axis], grains.max[axis]];
            Span::new(&axes[axis], assignment.touched(&axes[axis], ends))
        };
        Self { spans: [span(0), span(1), span(2)] }
    }

    /// Makes an array that holds the brick's nodes, those beyond faces included, zero.
    pub(super) fn prepare(&self, nodes: &mut NodeArray) {
        let [x, y, z] = &self.spans;
        nodes.move_to([x.first, y.first, z.first], [x.count, y.count, z.count + MAX_ORDER]);
    }

    /// Number of folded nodes in planes of x.
    pub(super) fn size_in(&self, planes: &Range<usize>) -> usize {
        (self.spans[0].below(planes.end) - self.spans[0].below(planes.start)) * self.plane_len()
    }

    /// Number of folded nodes in a plane.
    fn plane_len(&self) -> usize {
        self.spans[1].len() * self.spans[2].len()
    }

    /// Adds a brick's nodes to folded ones, `[x][y][z]`, which are zero before.
    pub(super) fn fold(&self, axes: &[GridAxis; 3], nodes: &NodeArray, folded: &mut [f64]) {
        self.for_each_row(axes, |row, sign, place, along_z| {
            let row = &nodes.values[row..];
            for (value, along) in row.iter().zip(along_z) {
                if let Some((z, sign_z)) = along {
                    folded[place + z] += sign * sign_z * value;
                }
            }
        });
    }

    /// Continues folded nodes to all nodes of the brick.
    pub(super) fn unfold(&self, axes: &[GridAxis; 3], folded: &[f64], nodes: &mut NodeArray) {
        self.for_each_row(axes, |row, sign, place, along_z| {
            let row = &mut nodes.values[row..];
            for (value, along) in row.iter_mut().zip(along_z) {
                *value = along.map_or(0.0, |(z, sign_z)| sign * sign_z * folded[place + z]);
            }
        });
    }

    /// Visits the rows along z that stand for nodes: place of the row, its sign, place of its folded row, and
    /// places and signs along it.
    fn for_each_row(
        &self,
        axes: &[GridAxis; 3],
        mut visit: impl FnMut(usize, f64, usize, &[Option<(usize, f64)>]),
    ) {
        let places = [0, 1, 2].map(|axis: usize| self.spans[axis].places(&axes[axis]));
        let (rows, length) = (self.spans[1].count, self.spans[2].count + MAX_ORDER);
        let folded_row = self.spans[2].len();
        for (i, x) in places[0].iter().enumerate() {
            for (j, y) in places[1].iter().enumerate() {
                let (Some((x, sign_x)), Some((y, sign_y))) = (x, y) else { continue };
                let folded = x * self.plane_len() + y * folded_row;
                visit((i * rows + j) * length, sign_x * sign_y, folded, &places[2]);
            }
        }
    }

    /// Adds the folded nodes of a plane of x, if there are any, to the plane; `folded` are those of a share
    /// of planes.
    pub(super) fn add_plane(&self, folded: &[f64], share: &Range<usize>, x: usize, plane: &mut Rows<'_>) {
        if !self.spans[0].contains(x) {
            return;
        }
        let before = self.spans[0].below(x) - self.spans[0].below(share.start);
        let mut rest = &folded[before * self.plane_len()..];
        for y in self.spans[1].nodes() {
            for run in &self.spans[2].folded {
                let values;
                (values, rest) = rest.split_at(run.len());
                for (node, value) in plane.at(y)[run.clone()].iter_mut().zip(values) {
                    *node += value;
                }
            }
        }
    }

    /// Appends the folded nodes of a share of planes, the first of which is the share's first.
    pub(super) fn append(
        &self,
        axes: &[GridAxis; 3],
        planes: &Planes,
        share: &Range<usize>,
        folded: &mut Vec<f64>,
    ) {
        for x in share.clone().filter(|&x| self.spans[0].contains(x)) {
            for y in self.spans[1].nodes() {
                let row = planes.row(axes, x - share.start, y);
                for run in &self.spans[2].folded {
                    folded.extend_from_slice(&row[run.clone()]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::levels::grid::axis::AxisSize;
    use amberfield_core::{Axis, Boundary, Domain};
    use nalgebra::Vector3;

    fn axis(faces: [Boundary; 2]) -> GridAxis {
        let mut all = [[Boundary::Open; 2]; 3];
        all[0] = faces;
        let domain = Domain::new(Vector3::zeros(), Vector3::repeat(1.0), all).unwrap();
        GridAxis::new(&domain, Axis::X, AxisSize::new(&domain, Axis::X, 0.1, 0.0))
    }

    #[test]
    fn spans_hold_every_node_that_is_touched_once_and_in_order() {
        for faces in [[Boundary::Periodic; 2], [Boundary::Grounded; 2], [Boundary::Open; 2]] {
            let axis = axis(faces);
            for (first, last) in [(-4, 3), (5, 9), (7, 13), (-4, 14), (-4, 30), (3, 3)] {
                let span = Span::new(&axis, [first, last]);
                let mut expected: Vec<usize> =
                    (first..=last).filter_map(|node| axis.fold(node)).map(|(node, _)| node).collect();
                expected.sort_unstable();
                expected.dedup();
                assert_eq!(span.nodes().collect::<Vec<_>>(), expected, "{faces:?} {first} {last}");
                assert_eq!(span.len(), expected.len());
                for (place, &node) in expected.iter().enumerate() {
                    assert!(span.contains(node));
                    assert_eq!(span.below(node), place);
                }
                for (number, place) in span.places(&axis).into_iter().enumerate() {
                    let folded = axis.fold(first + number as isize);
                    assert_eq!(place.map(|(place, sign)| (expected[place], sign)), folded);
                }
            }
        }
    }
}
