//! The place at which Ewald's sum is split, and the functions of each axis that carry its smooth part.

use crate::geometry::images::{AxisKind, BoundingBox, FaceKind, Geometry, axis_kinds};
use amberfield_core::{Axis, Domain};
use nalgebra::Vector3;
use std::f64::consts::PI;

/// α r_c and k_max/(2α): terms left out are below e^{−s²} ≈ 2.5e-15 of those kept.
const REACH: f64 = 5.8;
/// Cost of one pair over that of one mode at one particle, both passes; measured.
const PAIR_COST: f64 = 40.0;

/// Shape of the functions of one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    /// 1, cos k₁x, sin k₁x, cos k₂x, …
    Both,
    /// sin k₀x, sin k₁x, …
    Sine,
    /// cos k₀x, cos k₁x, …
    Cosine,
}

/// Orthogonal functions of one axis that obey its faces, and the weight of each in the Green function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AxisBasis {
    shape: Shape,
    /// Place at which the functions' argument is zero [m].
    origin: f64,
    /// Distance of wave numbers [1/m].
    step: f64,
    /// First wave number over `step`.
    first: f64,
    /// Weight of the constant function and of all others [1/m].
    weights: [f64; 2],
    /// Whether the axis has an open face.
    pub(crate) is_open: bool,
}

impl AxisBasis {
    /// Functions of a closed axis from `low` to `high` [m].
    fn closed(kind: AxisKind, low: f64, high: f64) -> Self {
        use FaceKind::Conductor;
        let length = high - low;
        let (shape, step, first) = match kind {
            AxisKind::Periodic => (Shape::Both, 2.0 * PI / length, 0.0),
            AxisKind::Faces(Conductor, Conductor) => (Shape::Sine, PI / length, 1.0),
            AxisKind::Faces(Conductor, _) => (Shape::Sine, PI / length, 0.5),
            AxisKind::Faces(_, Conductor) => (Shape::Cosine, PI / length, 0.5),
            AxisKind::Faces(..) => (Shape::Cosine, PI / length, 0.0),
        };
        let weights = [1.0 / length, 2.0 / length];
        Self { shape, origin: low, step, first, weights, is_open: false }
    }

    /// Functions of an axis with an open face that reproduce the Green function over the period [m].
    fn open(kind: AxisKind, low: f64, high: f64, period: f64) -> Self {
        use FaceKind::{Conductor, Open};
        let (step, centre) = (2.0 * PI / period, 0.5 * (low + high));
        // A mirror image doubles what survives of each function.
        let (shape, origin, first, factor) = match kind {
            AxisKind::Faces(Conductor, _) => (Shape::Sine, low, 1.0, 2.0),
            AxisKind::Faces(Open, Conductor) => (Shape::Sine, high, 1.0, 2.0),
            AxisKind::Faces(Open, Open) | AxisKind::Periodic => (Shape::Both, centre, 0.0, 1.0),
            AxisKind::Faces(Open, _) => (Shape::Cosine, high, 0.0, 2.0),
            AxisKind::Faces(..) => (Shape::Cosine, low, 0.0, 2.0),
        };
        let weights = [factor / period, 2.0 * factor / period];
        Self { shape, origin, step, first, weights, is_open: true }
    }

    /// Wave number [1/m] of a function.
    pub(crate) fn wave_number(&self, function: usize) -> f64 {
        let order = if self.shape == Shape::Both { function.div_ceil(2) } else { function };
        (order as f64 + self.first) * self.step
    }

    /// Weight of a function [1/m].
    pub(crate) fn weight(&self, function: usize) -> f64 {
        self.weights[usize::from(self.wave_number(function) > 0.0)]
    }

    /// Number of functions with wave numbers up to `limit` [1/m].
    pub(crate) fn count(&self, limit: f64) -> usize {
        let orders = (limit / self.step - self.first).floor() + 1.0;
        if orders < 1.0 {
            return 0;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "positive, checked above"
        )]
        let orders = orders as usize;
        if self.shape == Shape::Both { 2 * orders - 1 } else { orders }
    }

    /// Values and slopes [1/m] of the first functions at a coordinate [m], for every `stride`-th place.
    pub(crate) fn fill(&self, at: f64, count: usize, stride: usize, values: &mut [f64], slopes: &mut [f64]) {
        let at = at - self.origin;
        let mut function = 0;
        while function < count {
            let wave_number = self.wave_number(function);
            let (sine, cosine) = (wave_number * at).sin_cos();
            let place = function * stride;
            if self.shape == Shape::Sine {
                (values[place], slopes[place]) = (sine, wave_number * cosine);
            } else {
                (values[place], slopes[place]) = (cosine, -wave_number * sine);
            }
            function += 1;
            if self.shape == Shape::Both && wave_number > 0.0 && function < count {
                let place = function * stride;
                (values[place], slopes[place]) = (sine, wave_number * cosine);
                function += 1;
            }
        }
    }
}

/// A splitting of the sum for given particles.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Splitting {
    /// Splitting parameter α [1/m].
    pub(crate) alpha: f64,
    /// Cut-off radius of the pairs [m].
    pub(crate) radius: f64,
    /// Largest wave number [1/m].
    pub(crate) wave_limit: f64,
    /// Functions of each axis.
    pub(crate) bases: [AxisBasis; 3],
    /// Place at which the Green function is cut: beyond all that the particles see.
    pub(crate) cut: Cut,
}

/// Place at which the Green function of the open axes is cut, about a charge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Cut {
    /// No axis is open.
    Nowhere,
    /// Distance of the cut along the one open axis [m].
    Layer(f64),
    /// Radius of the cut in the plane of the two open axes, and length of the closed axis [m].
    Cylinder { radius: f64, unit: f64 },
}

impl Splitting {
    /// The splitting of least cost for `count` particles in the given box.
    pub(crate) fn cheapest(
        domain: &Domain,
        geometry: Geometry,
        particles: &BoundingBox,
        count: usize,
    ) -> Self {
        let longest = domain.extent().max();
        let candidates = (0..200).map(|power| REACH / (6.0 * longest) * 1.05_f64.powi(power));
        let cost = |alpha: f64| Self::new(domain, geometry, particles, alpha).cost(domain, count);
        let best = candidates.min_by(|a, b| cost(*a).total_cmp(&cost(*b)));
        Self::new(domain, geometry, particles, best.expect("there are 200 candidates"))
    }

    /// The splitting with a given α [1/m].
    pub(crate) fn new(domain: &Domain, geometry: Geometry, particles: &BoundingBox, alpha: f64) -> Self {
        let kinds = axis_kinds(domain);
        let radius = REACH / alpha;
        // Greatest distance between a particle and a particle or mirror image along an open axis.
        let farthest = Axis::ALL.map(|axis| {
            let index = axis.index();
            let (bottom, top) = (particles.min[index], particles.max[index]);
            match kinds[index] {
                kind if !kind.is_open() => 0.0,
                AxisKind::Faces(FaceKind::Open, FaceKind::Open) => top - bottom,
                AxisKind::Faces(FaceKind::Open, _) => 2.0 * (domain.max()[index] - bottom),
                _ => 2.0 * (top - domain.min()[index]),
            }
        });
        let reach = Vector3::from(farthest).norm() + radius;
        let cut = match geometry {
            Geometry::Slab(_) => Cut::Layer(reach),
            Geometry::Gap(closed) => Cut::Cylinder { radius: reach, unit: domain.extent()[closed.index()] },
            Geometry::Closed | Geometry::Open => Cut::Nowhere,
        };
        let bases = Axis::ALL.map(|axis| {
            let (index, kind) = (axis.index(), kinds[axis.index()]);
            let (low, high) = (domain.min()[index], domain.max()[index]);
            if !kind.is_open() {
                return AxisBasis::closed(kind, low, high);
            }
            let (low, high) = if kind == AxisKind::Faces(FaceKind::Open, FaceKind::Open) {
                (particles.min[index], particles.max[index])
            } else {
                (low, high)
            };
            AxisBasis::open(kind, low, high, farthest[index] + reach + radius)
        });
        Self { alpha, radius, wave_limit: 2.0 * alpha * REACH, bases, cut }
    }

    fn cost(&self, domain: &Domain, count: usize) -> f64 {
        let modes: f64 =
            self.bases.iter().map(|basis| basis.count(self.wave_limit) as f64 + 1.0).product::<f64>() * PI
                / 6.0;
        let closed = |axis: &usize| !self.bases[*axis].is_open;
        let density = count as f64 / (0..3).filter(closed).map(|axis| domain.extent()[axis]).product::<f64>();
        let ball = 4.0 / 3.0 * PI * self.radius.powi(3);
        let pairs = match self.cut {
            Cut::Nowhere => density * ball,
            // Charges per area, in a layer that may be thinner than the ball.
            Cut::Layer(cut) => density * (ball / (cut - self.radius)).min(PI * self.radius * self.radius),
            // Charges per length, in a column that may be narrower than the ball.
            Cut::Cylinder { radius: cut, .. } => {
                density * (ball / (cut - self.radius).powi(2)).min(2.0 * self.radius)
            }
        };
        PAIR_COST * pairs + modes
    }
}
