//! Velocity Verlet, in two passes around the forces.
//!
//! First pass: v += ½Δt a (a of the last forces), x += Δt v: the velocity of the middle of the step, by which
//! surfaces slip; v + ½Δt a is its forecast for the end of the step, which a gas and, as far as that is
//! stable, the damping of contacts see. Second pass: v += ½Δt a_new. Angular velocity likewise; a sphere
//! needs no orientation. Grains that never move have 1/m = 0, and gravity does not pull them; passes over
//! grains without such ones are built without the question.

use crate::motion::chunks::{CHUNK, Loads, Push, Vectors, chunk_count, for_each_chunk, is_parallel};
use crate::motion::grains::Grains;
use amberfield_core::{Side, Vector3};
use rayon::prelude::*;

/// Moment of inertia of a solid sphere over m r².
const SPHERE_INERTIA: f64 = 0.4;

/// Findings of the first pass in a chunk.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ChunkMotion {
    /// Largest squared speed of the drift [m²/s²].
    speed2: f64,
    /// Whether a grain left the box.
    outside: bool,
}

/// Findings of the first pass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    /// Largest speed of the drift [m/s].
    pub(crate) speed: f64,
    /// Whether a grain left the box.
    pub(crate) outside: bool,
}

/// The box that grains may not leave: infinite along periodic axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    pub(crate) min: [f64; 3],
    pub(crate) max: [f64; 3],
}

/// Face of the box that a grain is beyond.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beyond {
    pub(crate) axis: usize,
    /// Side of the axis; `None` for a coordinate that is not a number.
    pub(crate) side: Option<Side>,
}

impl Bounds {
    /// The face that a position is beyond; `None` when inside. NaN is outside too.
    pub(crate) fn beyond(&self, centre: &[f64; 4]) -> Option<Beyond> {
        (0..3).find(|&a| !self.holds(a, centre[a])).map(|a| {
            let side = if centre[a] < self.min[a] {
                Some(Side::Min)
            } else if centre[a] > self.max[a] {
                Some(Side::Max)
            } else {
                None
            };
            Beyond { axis: a, side }
        })
    }

    /// Whether an axis has no end.
    pub(crate) fn is_periodic(&self) -> bool {
        self.min.contains(&f64::NEG_INFINITY)
    }

    #[inline(always)]
    fn holds(&self, axis: usize, x: f64) -> bool {
        x >= self.min[axis] && x <= self.max[axis]
    }
}

/// Moves the grains, in the first pass; their velocities are those of the middle of the step then.
pub(crate) fn drift(
    grains: &mut Grains,
    gravity: Vector3<f64>,
    step: f64,
    bounds: &Bounds,
    found: &mut [ChunkMotion],
) -> Motion {
    if grains.some_fixed {
        drift_all::<true>(grains, gravity, step, bounds, found)
    } else {
        drift_all::<false>(grains, gravity, step, bounds, found)
    }
}

/// Acceleration [m/s²] of a grain by a force [N] and gravity; none of one that never moves, whatever acts on
/// it.
#[inline(always)]
fn acceleration<const FIXED: bool>(
    force: &Vector3<f64>,
    inverse_mass: f64,
    gravity: Vector3<f64>,
) -> Vector3<f64> {
    if FIXED && inverse_mass == 0.0 { Vector3::zeros() } else { force * inverse_mass + gravity }
}

/// [`drift`] of grains of which some never move, or none.
fn drift_all<const FIXED: bool>(
    grains: &mut Grains,
    gravity: Vector3<f64>,
    step: f64,
    bounds: &Bounds,
    found: &mut [ChunkMotion],
) -> Motion {
    let count = grains.len();
    let (parallel, chunks) = (is_parallel(count), chunk_count(count));
    let Grains { centre, velocity, forecast, angular, force, torque, inverse_mass, .. } = grains;
    let half = 0.5 * step;
    for_each_chunk!(
        parallel,
        chunks,
        (centre / CHUNK, velocity / CHUNK, forecast / CHUNK, found / 1),
        |k: usize,
         (centre, velocity, forecast, found): (
            &mut [[f64; 4]],
            Vectors<'_>,
            Vectors<'_>,
            &mut [ChunkMotion]
        )| {
            let first = k * CHUNK;
            let (mut speed2, mut inside) = (0.0_f64, true);
            let length = centre.len();
            let (force, inverse_mass) = (&force[first..first + length], &inverse_mass[first..first + length]);
            let moving = centre.iter_mut().zip(velocity).zip(forecast);
            for (((c, v), later), (f, &im)) in moving.zip(force.iter().zip(inverse_mass)) {
                let kick = acceleration::<FIXED>(f, im, gravity) * half;
                let middle = *v + kick;
                c[0] += middle.x * step;
                c[1] += middle.y * step;
                c[2] += middle.z * step;
                *v = middle;
                *later = middle + kick;
                speed2 = speed2.max(middle.norm_squared());
                inside &= bounds.holds(0, c[0]) & bounds.holds(1, c[1]) & bounds.holds(2, c[2]);
            }
            found[0] = ChunkMotion { speed2, outside: !inside };
        }
    );
    if !torque.is_empty() {
        turn(parallel, angular, |i| torque[i] * (half * inverse_inertia(inverse_mass[i], &centre[i])));
    }
    Motion {
        speed: found[..chunks].iter().map(|m| m.speed2).fold(0.0, f64::max).sqrt(),
        outside: found[..chunks].iter().any(|m| m.outside),
    }
}

/// 1/I of a solid sphere [1/(kg·m²)].
#[inline(always)]
fn inverse_inertia(inverse_mass: f64, centre: &[f64; 4]) -> f64 {
    inverse_mass / (SPHERE_INERTIA * centre[3] * centre[3])
}

/// Adds a change to every angular velocity.
fn turn(parallel: bool, angular: &mut [Vector3<f64>], change: impl Fn(usize) -> Vector3<f64> + Sync) {
    if parallel {
        angular.par_chunks_mut(CHUNK).enumerate().for_each(|(k, part)| {
            part.iter_mut().enumerate().for_each(|(n, w)| *w += change(k * CHUNK + n));
        });
    } else {
        angular.iter_mut().enumerate().for_each(|(i, w)| *w += change(i));
    }
}

/// Finishes the velocities, in the second pass, with the new forces.
///
/// `pushes` gives what other chunks do to the grains of chunk k: index in the chunk, and push. It is added to
/// `loads`, which hold the new values and are swapped with the grains'.
pub(crate) fn kick<'a, P: Iterator<Item = (usize, &'a Push)>>(
    grains: &mut Grains,
    gravity: Vector3<f64>,
    pushes: impl Fn(usize) -> P + Sync,
    step: f64,
    loads: &mut Loads,
) {
    if grains.some_fixed {
        kick_all::<true, P>(grains, gravity, pushes, step, loads);
    } else {
        kick_all::<false, P>(grains, gravity, pushes, step, loads);
    }
}

/// [`kick`] of grains of which some never move, or none.
fn kick_all<'a, const FIXED: bool, P: Iterator<Item = (usize, &'a Push)>>(
    grains: &mut Grains,
    gravity: Vector3<f64>,
    pushes: impl Fn(usize) -> P + Sync,
    step: f64,
    loads: &mut Loads,
) {
    let half = 0.5 * step;
    let Grains { centre, velocity, angular, force, torque, slowing, inverse_mass, .. } = grains;
    let (centre, inverse_mass) = (&centre[..], &inverse_mass[..]);
    let chunks = chunk_count(velocity.len());
    let parallel = is_parallel(velocity.len());
    {
        let Loads { force, slowing, .. } = &mut *loads;
        let (velocity, force, slowing) = (&mut velocity[..], &mut force[..], &mut slowing[..]);
        for_each_chunk!(
            parallel,
            chunks,
            (velocity / CHUNK, force / CHUNK, slowing / CHUNK),
            |k: usize, (velocity, force, slowing): (&mut [Vector3<f64>], &mut [Vector3<f64>], &mut [f64])| {
                for (local, push) in pushes(k) {
                    force[local] += push.force;
                    slowing[local] += push.slowing;
                }
                let first = k * CHUNK;
                for (n, (v, f)) in velocity.iter_mut().zip(&*force).enumerate() {
                    *v += acceleration::<FIXED>(f, inverse_mass[first + n], gravity) * half;
                }
            }
        );
    }
    if !torque.is_empty() {
        let (angular, new) = (&mut angular[..], &mut loads.torque[..]);
        for_each_chunk!(parallel, chunks, (angular / CHUNK, new / CHUNK), |k: usize,
                                                                           (angular, new): (
            &mut [Vector3<f64>],
            &mut [Vector3<f64>]
        )| {
            for (local, push) in pushes(k) {
                new[local] += push.torque;
            }
            for (n, (w, t)) in angular.iter_mut().zip(&*new).enumerate() {
                let i = k * CHUNK + n;
                *w += t * (half * inverse_inertia(inverse_mass[i], &centre[i]));
            }
        });
        std::mem::swap(torque, &mut loads.torque);
    }
    std::mem::swap(force, &mut loads.force);
    std::mem::swap(slowing, &mut loads.slowing);
}
