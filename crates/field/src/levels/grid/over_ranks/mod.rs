//! The internal grid, shared by ranks.
//!
//! Every rank spreads its own grains onto the nodes that they touch. Planes of x are shared out: the rank
//! that has a plane adds up what the others spread onto it, in the order of the ranks, and transforms it
//! along z and y. Coefficients of y are shared out too: the rank that has some gets their part of all
//! planes, and transforms, convolves and transforms back along x. Planes and bricks get their values the
//! same way back.

mod brick;

use super::assignment::Assignment;
use super::axis::GridAxis;
use super::influence::Influence;
use super::level::{GridParameters, grid_axes};
use super::nodes::NodeArray;
use super::solve::{Lines, Planes};
use crate::error::FieldError;
use crate::geometry::images::BoundingBox;
use crate::ranks::{Parcels, Ranks, share};
use crate::values::FieldAt;
use amberfield_core::Domain;
use brick::Brick;
use nalgebra::Vector3;
use rayon::prelude::*;
use std::ops::Range;

/// Field of the clouds around the charges of all ranks, with the box's own faces.
#[derive(Debug)]
pub(crate) struct GridOverRanks {
    axes: [GridAxis; 3],
    assignment: Assignment,
    /// Nodes that this rank's grains touch.
    nodes: NodeArray,
    /// Nodes touched, by rank.
    bricks: Vec<Option<Brick>>,
    /// Planes of x, and coefficients of y, by rank.
    shares: Vec<Range<usize>>,
    coefficients: Vec<Range<usize>>,
    rank: usize,
    planes: Planes,
    lines: Lines,
    sent: Parcels,
    received: Parcels,
}

impl GridOverRanks {
    pub(crate) fn new(domain: &Domain, parameters: GridParameters, ranks: &dyn Ranks) -> Self {
        let axes = grid_axes(domain, parameters);
        let assignment = Assignment::new(parameters.order, parameters.window_shape);
        let (rank, count) = (ranks.rank(), ranks.count());
        let of_all = |things: usize| (0..count).map(|rank| share(things, rank, count)).collect::<Vec<_>>();
        let (shares, coefficients) = (of_all(axes[0].nodes), of_all(axes[1].transform.len()));
        let own = coefficients[rank].clone();
        let influence = Influence::part(&axes, assignment.window(), parameters.cloud, own.clone());
        Self {
            nodes: NodeArray::empty(),
            bricks: Vec::new(),
            planes: Planes::new(&axes, shares[rank].len()),
            lines: Lines::new(&axes, own, influence),
            shares,
            coefficients,
            rank,
            assignment,
            axes,
            sent: Parcels::default(),
            received: Parcels::default(),
        }
    }

    /// Nodes that carry charge, per axis.
    pub(crate) fn cells(&self) -> [usize; 3] {
        self.axes.each_ref().map(|axis| axis.nodes)
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        8 * self.nodes.values.capacity()
            + self.planes.memory_bytes()
            + self.lines.memory_bytes()
            + self.assignment.memory_bytes()
            + self.sent.memory_bytes()
            + self.received.memory_bytes()
    }

    /// Computes the clouds' potential (4πε = 1) at the nodes that this rank's grains touch. `boxes` are those
    /// around the grains of each rank.
    pub(crate) fn solve(
        &mut self,
        ranks: &dyn Ranks,
        boxes: &[Option<BoundingBox>],
        positions: &[Vector3<f64>],
        charges: &[f64],
    ) -> Result<(), FieldError> {
        let brick = |grains: &BoundingBox| Brick::new(&self.axes, &self.assignment, grains);
        self.bricks = boxes.iter().map(|grains| grains.as_ref().map(brick)).collect();
        self.spread(positions, charges);
        self.bricks_to_planes(ranks)?;
        self.planes_to_lines(ranks)?;
        self.lines_to_planes(ranks)?;
        self.planes_to_bricks(ranks)
    }

    /// E and potential of the clouds (4πε = 1) at the given positions, after [`Self::solve`].
    pub(crate) fn gather(&self, positions: &[Vector3<f64>], field: &mut [FieldAt]) {
        self.assignment.gather(&self.axes, &self.nodes, positions, field);
    }

    /// Spreads this rank's charges, and folds what lies beyond faces.
    fn spread(&mut self, positions: &[Vector3<f64>], charges: &[f64]) {
        let Self { axes, assignment, nodes, bricks, shares, sent, .. } = self;
        let Some(brick) = &bricks[self.rank] else {
            sent.resize(shares.iter().map(|_| 0));
            return;
        };
        brick.prepare(nodes);
        assignment.spread(axes, positions, charges, nodes);
        // Planes are shared out in order: so the folded ones come to lie in the order of the ranks.
        sent.resize(shares.iter().map(|share| brick.size_in(share)));
        brick.fold(axes, nodes, &mut sent.values);
    }

    fn bricks_to_planes(&mut self, ranks: &dyn Ranks) -> Result<(), FieldError> {
        let Self { axes, bricks, received, .. } = self;
        let share = &self.shares[self.rank];
        received.resize(bricks.iter().map(|brick| brick.as_ref().map_or(0, |brick| brick.size_in(share))));
        ranks.exchange(&self.sent, received)?;
        self.planes.forward(axes, |plane, rows| {
            for (rank, brick) in bricks.iter().enumerate() {
                if let Some(brick) = brick {
                    brick.add_plane(received.of(rank), share, share.start + plane, rows);
                }
            }
        });
        Ok(())
    }

    fn planes_to_lines(&mut self, ranks: &dyn Ranks) -> Result<(), FieldError> {
        let Self { axes, planes, sent, received, .. } = self;
        let row = axes[2].transform.len();
        let plane = axes[1].transform.len() * row;
        sent.clear();
        for share in &self.coefficients {
            for plane in planes.values.chunks_exact(plane) {
                sent.values.extend_from_slice(&plane[share.start * row..share.end * row]);
            }
            sent.end_parcel();
        }
        let own = self.coefficients[self.rank].len();
        received.resize(self.shares.iter().map(|share| share.len() * own * row));
        ranks.exchange(sent, received)?;
        // Parcels in the order of the ranks are planes in the order of x.
        self.lines.convolve(&self.axes, &received.values);
        Ok(())
    }

    fn lines_to_planes(&mut self, ranks: &dyn Ranks) -> Result<(), FieldError> {
        let Self { axes, lines, sent, received, .. } = self;
        let row = axes[2].transform.len();
        let own = self.coefficients[self.rank].len();
        sent.resize(self.shares.iter().map(|share| share.len() * own * row));
        let parts = sent.values.par_chunks_mut((own * row).max(1));
        parts.enumerate().for_each(|(x, part)| lines.write_plane(axes[0].offset + x, part));
        let planes = self.shares[self.rank].len();
        received.resize(self.coefficients.iter().map(|share| planes * share.len() * row));
        ranks.exchange(sent, received)?;
        self.planes.inverse(axes, |x, plane| {
            for (rank, share) in self.coefficients.iter().enumerate() {
                let length = share.len() * row;
                plane[share.start * row..share.end * row]
                    .copy_from_slice(&received.of(rank)[x * length..][..length]);
            }
        });
        Ok(())
    }

    fn planes_to_bricks(&mut self, ranks: &dyn Ranks) -> Result<(), FieldError> {
        let Self { axes, bricks, planes, shares, nodes, sent, received, .. } = self;
        sent.clear();
        for brick in bricks.iter() {
            if let Some(brick) = brick {
                brick.append(axes, planes, &shares[self.rank], &mut sent.values);
            }
            sent.end_parcel();
        }
        let own = bricks[self.rank].as_ref();
        received.resize(shares.iter().map(|share| own.map_or(0, |brick| brick.size_in(share))));
        ranks.exchange(sent, received)?;
        if let Some(brick) = own {
            brick.unfold(axes, &received.values, nodes);
        }
        Ok(())
    }
}
