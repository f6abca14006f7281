//! Potentials on faces of several axes, and normal fields beside conductors: integrals of heat kernels.
//!
//! A harmonic function is the mean of its boundary values over where a diffusing point leaves. In a box the
//! three coordinates diffuse independently, hence
//!
//! ```text
//! φ(x) = V_0 + Σ_faces w ∫₀^∞ dt B(x_a, t) U(x_b, t) U(x_c, t)
//! ```
//!
//! with w = V − V_0 and B the rate of first passage for a conductor on axis a, w = −E·n and B the kernel at
//! the face for an insulator, and U what survives along the other axes. V_0 is the potential of the nearest
//! conductor, so that nothing cancels close to it.

use super::heat::AxisHeat;
use crate::error::FieldError;
use crate::geometry::images::{AxisKind, axis_kinds};
use crate::values::FieldAt;
use amberfield_core::{Axis, Boundary, Domain, Side};
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Distance to a wall, over the domain's length, below which a point counts as this far from it.
const LEAST_DISTANCE: f64 = 1e-12;
/// Start of the integral: d²/4t = 45 for the nearest face that counts.
const START: f64 = 180.0;
/// End of the integral: λt with λ the slowest decay.
const END: f64 = 42.0;
/// End over size² where everything leaves slowly because the box is open; what is left falls as 1/t.
const OPEN_END: f64 = 1e14;

/// A face with a value.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Face {
    axis: usize,
    side: usize,
    /// V [V] of a conductor, −E·n [V/m] of an insulator.
    value: f64,
    is_conductor: bool,
}

/// Boundary field of a box with conductors on one axis or more, by quadrature.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct General {
    min: Vector3<f64>,
    max: Vector3<f64>,
    kinds: [AxisKind; 3],
    faces: Vec<Face>,
    /// Slowest decay λ [1/m²]; zero when no closed axis has a conductor.
    decay: f64,
    /// Step in ln t.
    step: f64,
}

impl General {
    /// `tolerance` is the relative error of the quadrature.
    ///
    /// # Errors
    /// Normal fields in a box that is open along every axis with a conductor: the field has no bound.
    pub(super) fn new(domain: &Domain, tolerance: f64) -> Result<Self, FieldError> {
        let kinds = axis_kinds(domain);
        let mut faces = Vec::new();
        for axis in Axis::ALL {
            for side in [Side::Min, Side::Max] {
                let face = domain.face(axis, side);
                let value = match face {
                    Boundary::Insulating { normal_field_v_m } => -normal_field_v_m,
                    _ => face.potential().unwrap_or(0.0),
                };
                let is_conductor = face.is_conductor();
                if is_conductor || value != 0.0 {
                    faces.push(Face { axis: axis.index(), side: side as usize, value, is_conductor });
                }
            }
        }
        let decay = decay(domain, &kinds);
        if decay == 0.0
            && let Some(face) = faces.iter().find(|face| !face.is_conductor)
        {
            return Err(FieldError::Settings(format!(
                "the normal field of {} V/m on face {} has no bounded solution beside conductors whose axes \
                 are open; give normal_field_V_m = 0 there or close the axis of the conductor",
                -face.value,
                Axis::FACE_NAMES[2 * face.axis + face.side]
            )));
        }
        // The integrand is analytic for |arg t| < π/2: the trapezoid errs by some e⁸ e^{−π²/step}.
        let step = PI * PI / (8.0 - tolerance.ln());
        Ok(Self { min: domain.min(), max: domain.max(), kinds, faces, decay, step })
    }

    /// Takes the present potentials of a domain's faces.
    pub(super) fn set_potentials(&mut self, domain: &Domain) {
        for face in self.faces.iter_mut().filter(|face| face.is_conductor) {
            let condition = domain.faces()[face.axis][face.side];
            face.value = condition.potential().expect("a conductor stays one");
        }
    }

    /// Field [V/m] and potential [V] at a point.
    pub(super) fn evaluate(&self, x: &Vector3<f64>) -> FieldAt {
        let least = (self.max - self.min) * LEAST_DISTANCE;
        let distances = [0, 1, 2].map(|axis| {
            let most = if self.kinds[axis].is_open() {
                f64::INFINITY
            } else {
                self.max[axis] - self.min[axis] - least[axis]
            };
            // Both measured: one from the other would lose digits near a wall.
            [x[axis] - self.min[axis], self.max[axis] - x[axis]]
                .map(|distance| distance.clamp(least[axis], most))
        });
        let distance = |face: &Face| distances[face.axis][face.side];
        let conductors = self.faces.iter().filter(|face| face.is_conductor);
        let nearest = conductors.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let reference = nearest.map_or(0.0, |face| face.value);
        let weight = |face: &Face| if face.is_conductor { face.value - reference } else { face.value };
        let active = || self.faces.iter().filter(|face| weight(face) != 0.0);
        let Some(closest) = active().map(distance).min_by(f64::total_cmp) else {
            return FieldAt::of_potential(reference);
        };
        let (mut e, mut potential) = (Vector3::zeros(), 0.0);
        let (first, last) = self.range(closest, &distances);
        for node in first..=last {
            let t = (f64::from(node) * self.step).exp();
            let heat: [AxisHeat; 3] =
                std::array::from_fn(|a| AxisHeat::new(self.kinds[a], distances[a][0], distances[a][1], t));
            for face in active() {
                let (a, b, c) = (face.axis, (face.axis + 1) % 3, (face.axis + 2) % 3);
                let [source, slope] = heat[a].faces[face.side];
                let [survival_b, slope_b] = heat[b].survival;
                let [survival_c, slope_c] = heat[c].survival;
                let amount = weight(face) * t;
                potential += amount * source * survival_b * survival_c;
                e[a] -= amount * slope * survival_b * survival_c;
                e[b] -= amount * source * slope_b * survival_c;
                e[c] -= amount * source * survival_b * slope_c;
            }
        }
        FieldAt { e: e * self.step, potential: reference + potential * self.step }
    }

    /// First and last node, t = e^{node·step}.
    #[expect(clippy::cast_possible_truncation, reason = "logarithms of times are small numbers")]
    fn range(&self, closest: f64, distances: &[[f64; 2]; 3]) -> (i32, i32) {
        let end = if self.decay > 0.0 {
            END / self.decay
        } else {
            let size = distances.iter().flatten().fold(0.0_f64, |all, distance| all.max(distance.abs()));
            OPEN_END * size * size
        };
        let start = closest * closest / START;
        ((start.ln() / self.step).floor() as i32, (end.ln() / self.step).ceil() as i32)
    }
}

/// Slowest rate at which everything leaves through the conductors of closed axes [1/m²].
fn decay(domain: &Domain, kinds: &[AxisKind; 3]) -> f64 {
    let rate = |axis: usize| {
        let kind = kinds[axis];
        if kind.is_open() || !kind.has_conductor() {
            return 0.0;
        }
        let AxisKind::Faces(lower, upper) = kind else { return 0.0 };
        let quarter = if lower == upper { 1.0 } else { 0.5 };
        (quarter * PI / domain.extent()[axis]).powi(2)
    };
    (0..3).map(rate).sum()
}
