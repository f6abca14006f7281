//! Smoothing of what grains do: diffusion among the nodes, for a short while.
//!
//! dn_k/dt = (1/V_k) Σ G_kk' (n_k' − n_k) over t from 0 to 1
//!
//! V_k are the nodes' volumes, G the conductances between them (`nodes.rs`). No flux leaves through walls:
//! nothing is lost there, and what is even stays even, on any mesh and to round-off. The operator is
//! symmetric in the volumes, so that the same one takes the flow to grains.
//!
//! The time is gone through in two equal parts, each by damped Chebyshev polynomials of the rate of change
//! (van der Houwen & Sommeijer, Z. Angew. Math. Mech. 60, 479 (1980)): their number of stages grows as the
//! root of the stiffness, what is left of short waves is small, and the square of a part turns no wave over.

use super::sparse::Rows;
use rayon::prelude::*;

/// Largest G over the smaller node's volume: nothing is smoothed over more than some 25 nodes.
const MOST: f64 = 300.0;
/// Share of short waves that a part of the time leaves, inverted.
const DAMPING: f64 = 12.0;
/// Parts of the time.
const PARTS: u32 = 2;
/// Nodes that one thread takes at a time.
const CHUNK: usize = 512;

/// Diffusion for a while.
#[derive(Clone, Debug)]
pub(super) struct Smoothing {
    /// G/V by node and neighbour.
    rates: Rows,
    /// Argument of the polynomials where nothing changes.
    still: f64,
    /// Degree of the polynomials, and how much of the rate of change moves their argument by one.
    stages: u32,
    step: f64,
}

/// Chebyshev polynomials T_s at x ≥ 1, and their derivatives.
fn chebyshev(s: u32, x: f64) -> [f64; 2] {
    let (s, angle) = (f64::from(s), x.acosh());
    [(s * angle).cosh(), s * (s * angle).sinh() / angle.sinh()]
}

impl Smoothing {
    /// Smoothing by conductances G [m³] between nodes with volumes [m³]; each is there from both sides.
    pub(super) fn new(volumes: &[f64], edges: Vec<(u32, u32, f64)>) -> Self {
        let limited = |(cell, other, conductance): (u32, u32, f64)| {
            let most = MOST * volumes[cell as usize].min(volumes[other as usize]);
            (cell, other, conductance.min(most))
        };
        let edges = edges.into_iter().map(limited).collect();
        let rates = Rows::new(volumes.len(), edges).with(|cell, _, conductance| conductance / volumes[cell]);
        // The fastest decay is no faster than twice the largest sum; a part has half of it.
        let fastest = (0..volumes.len()).map(|node| rates.sum(node)).fold(0.0, f64::max);
        let with = |stages: u32| {
            let still = (DAMPING.acosh() / f64::from(stages)).cosh();
            let [value, slope] = chebyshev(stages, still);
            (stages, still, value / slope)
        };
        let reaches = |&(_, still, step): &(u32, f64, f64)| (1.0 + still) / step >= fastest;
        let (stages, still, step) = (1_u32..).map(with).find(reaches).expect("rates are limited");
        Self { rates, still, stages, step: step / f64::from(PARTS) }
    }

    /// Spreads values by node; `Σ V n` stays as it is.
    pub(super) fn apply<const N: usize>(&self, mut values: Vec<[f64; N]>) -> Vec<[f64; N]> {
        let mut other = vec![[0.0; N]; values.len()];
        for _ in 0..PARTS {
            self.part(&mut values, &mut other);
        }
        values
    }

    /// Goes through a part of the time; what is in `other` does not matter.
    fn part<const N: usize>(&self, values: &mut Vec<[f64; N]>, other: &mut Vec<[f64; N]>) {
        let scale = |stage: u32| chebyshev(stage, self.still)[0];
        self.combine(1.0, values, 0.0, other, self.step / self.still);
        for stage in 2..=self.stages {
            std::mem::swap(values, other);
            let one_less = 2.0 * scale(stage - 1) / scale(stage);
            let two_less = scale(stage - 2) / scale(stage);
            self.combine(one_less * self.still, values, -two_less, other, one_less * self.step);
        }
        std::mem::swap(values, other);
    }

    /// Makes `y` be `a x + b y + c L x`, with the rate of change L.
    fn combine<const N: usize>(&self, a: f64, x: &[[f64; N]], b: f64, y: &mut [[f64; N]], c: f64) {
        y.par_iter_mut().with_min_len(CHUNK).enumerate().for_each(|(node, y)| {
            let mut change = [0.0; N];
            let here = &x[node];
            for (other, rate) in self.rates.of(node) {
                let there = &x[other];
                for k in 0..N {
                    change[k] += rate * (there[k] - here[k]);
                }
            }
            for k in 0..N {
                y[k] = a * here[k] + b * y[k] + c * change[k];
            }
        });
    }
}
