//! One contact: force and torque from overlap, relative motion and history.
//!
//! Velocities are those of the middle of the step. The tangential spring is kept as a force, advanced by −S_t
//! v_t Δt, which is the slip of the step exactly, and turned with the contact. Dashpots act as far as the
//! step bears it (`amberfield_laws::damped_step`). While the contact unloads it shrinks with the contact
//! radius √(R*δ), so that no energy is made by stretching a spring at high load and releasing it at low load
//! (Thornton, Cummins & Cleary, Powder Technol. 233, 30 (2013)). The normal damping is kept to the end of the
//! contact (δ = 0), where it pulls slightly: that is what makes the coefficient of restitution exact;
//! friction sees no negative load.
//!
//! The elastic normal force and the contact radius are those of a law of `crate::contacts::normal`.
//!
//! Numbers are one contact's, or those of several side by side: there is no branch in the law but that of the
//! rolling model, which is one in a scene.

use crate::contacts::material_pairs::PairConstants;
use crate::contacts::memory::Spring;
use crate::contacts::normal::{Elastic, NormalLaw};
use amberfield_core::{RollingModel, Vector3};
use amberfield_laws::{damped_step, rolling_cdt, rolling_epsd, rolling_epsd2, rolling_friction};
use nalgebra::SimdRealField;

/// Geometry and motion of one contact of body i with body j; n points from i to j.
pub(crate) struct Contact<T> {
    pub(crate) normal: Vector3<T>,
    /// v_i − v_j of the centres in the middle of the step.
    pub(crate) velocity: Vector3<T>,
    /// v_i − v_j of the centres as forecast for the end of the step.
    pub(crate) forecast: Vector3<T>,
    /// a_i ω_i + a_j ω_j, a the distance from centre to contact.
    pub(crate) spin: Vector3<T>,
    /// ω_i − ω_j.
    pub(crate) turning: Vector3<T>,
    /// R*.
    pub(crate) radius: T,
    /// 1/m*.
    pub(crate) inverse_mass: T,
    /// Σ 1/(m r²) of the bodies.
    pub(crate) inverse_moment: T,
    /// Γ_i + Γ_j: rates at which all contacts of the bodies slowed them in the last step [1/s].
    pub(crate) slowing: T,
}

/// Memory of a contact.
pub(crate) struct History<T> {
    /// Tangential force of the spring [N].
    pub(crate) spring: Vector3<T>,
    /// Contact radius of the last step [m].
    pub(crate) contact_radius: T,
    /// Torque of the rolling spring [N·m].
    pub(crate) rolling: Vector3<T>,
}

impl History<f64> {
    /// Reads a history as it is stored: tangential spring, rolling spring [N·m].
    #[inline(always)]
    pub(crate) fn stored(spring: Spring, rolling: [f64; 3]) -> Self {
        Self { spring: spring.force.into(), contact_radius: spring.contact_radius, rolling: rolling.into() }
    }

    /// History as it is stored: tangential spring, rolling spring [N·m].
    #[inline(always)]
    pub(crate) fn to_store(&self) -> (Spring, [f64; 3]) {
        let spring = Spring { force: self.spring.into(), contact_radius: self.contact_radius };
        (spring, self.rolling.into())
    }
}

/// Forces and torques of a contact.
pub(crate) struct Response<T> {
    /// Force on i; −force on j.
    pub(crate) force: Vector3<T>,
    /// n × F_t: times a_i on i, times a_j on j.
    pub(crate) twist: Vector3<T>,
    /// Rolling torque on i; the opposite on j.
    pub(crate) rolling: Vector3<T>,
    /// M_c: largest damping coefficient in any direction [N·s/m].
    pub(crate) damping: T,
}

impl<T: SimdRealField<Element = f64> + Copy> Response<T> {
    /// Response along the normal alone.
    #[inline(always)]
    fn along(force: Vector3<T>, damping: T) -> Self {
        Self { force, twist: Vector3::zeros(), rolling: Vector3::zeros(), damping }
    }
}

/// Inertia of a sphere about its centre over m r².
const SPHERE_INERTIA: f64 = 2.0 / 5.0;
/// Inertia of a sphere about its contact over m r².
const CONTACT_INERTIA: f64 = 7.0 / 5.0;

/// Force and torque now, of a contact whose elastic state is known; `step` [s] advances the springs.
#[inline(always)]
pub(crate) fn respond<T, L, const FRICTION: bool, const ROLLING: bool, const DAMPING: bool>(
    contact: &Contact<T>,
    elastic: &Elastic<T>,
    pair: &PairConstants<T>,
    rolling: RollingModel,
    step: T,
    history: &mut History<T>,
) -> Response<T>
where
    T: SimdRealField<Element = f64> + Copy,
    L: NormalLaw,
{
    let Contact { normal, velocity, radius, .. } = *contact;
    let (zero, one) = (T::zero(), T::one());
    let contact_radius = elastic.contact_radius;
    let dashpots = if DAMPING || ROLLING {
        Dashpots::of::<L, FRICTION, ROLLING>(contact, elastic, pair, rolling, step)
    } else {
        Dashpots { normal: zero, tangential: zero, rolling: zero, forecast: zero, largest: zero }
    };
    let approach = velocity.dot(&normal);
    let later = contact.forecast.dot(&normal);
    let damped = approach + dashpots.forecast * (later - approach);
    let load = elastic.load + dashpots.normal * damped;
    let held = L::held(load, elastic.grip);
    let mut response = Response::along(normal * -load, dashpots.largest);
    if FRICTION {
        let sliding = velocity - normal * approach + contact.spin.cross(&normal);
        let stiffness = pair.tangential * contact_radius;
        let dashpot = sliding * dashpots.tangential;
        let unloading = contact_radius.simd_lt(history.contact_radius);
        let shrunk = (contact_radius / history.contact_radius).select(unloading, one);
        let stretched = turned(history.spring, &normal) * shrunk - sliding * (stiffness * step);
        let trial = stretched - dashpot;
        let bound = pair.friction * held.simd_max(zero);
        let size2 = trial.norm_squared();
        let slipping = size2.simd_gt(bound * bound);
        let tangential = trial * (bound / size2.simd_sqrt()).select(slipping, one);
        let slipped = tangential + dashpot;
        history.spring = slipped.zip_map(&stretched, |slipped, kept| slipped.select(slipping, kept));
        history.contact_radius = contact_radius;
        response.force += tangential;
        response.twist = normal.cross(&tangential);
    }
    if ROLLING {
        let turning = contact.turning;
        let bound = rolling_friction::largest(pair.rolling, radius, held);
        match rolling {
            RollingModel::Epsd => {
                let stiffness = rolling_epsd::stiffness(pair.normal * contact_radius, pair.rolling, radius);
                let (spring, turn) = (history.rolling, turning * step);
                let torque = rolling_epsd::advance(spring, turn, turning, stiffness, dashpots.rolling, bound);
                (history.rolling, response.rolling) = (torque.spring, torque.total);
            }
            RollingModel::Epsd2 => {
                let stiffness = rolling_epsd2::stiffness(pair.tangential * contact_radius, radius);
                history.rolling = rolling_epsd2::advance(history.rolling, turning * step, stiffness, bound);
                response.rolling = history.rolling;
            }
            RollingModel::Cdt => {
                response.rolling =
                    -turning * rolling_cdt::coefficient(dashpots.rolling, bound, turning.norm());
            }
        }
    }
    response
}

/// Damping coefficients of a contact in a step.
struct Dashpots<T> {
    /// γ_n [N·s/m].
    normal: T,
    /// γ_t [N·s/m].
    tangential: T,
    /// C_r, or the largest coefficient of a constant torque [N·m·s].
    rolling: T,
    /// Part of the forecast in the velocity that γ_n sees.
    forecast: T,
    /// M_c [N·s/m].
    largest: T,
}

impl<T: SimdRealField<Element = f64> + Copy> Dashpots<T> {
    /// Damping coefficients of an elastic state, as far as a step [s] bears them.
    #[inline(always)]
    fn of<L: NormalLaw, const FRICTION: bool, const ROLLING: bool>(
        contact: &Contact<T>,
        elastic: &Elastic<T>,
        pair: &PairConstants<T>,
        model: RollingModel,
        step: T,
    ) -> Self {
        let Contact { radius, inverse_mass, inverse_moment, slowing, .. } = *contact;
        let (zero, contact_radius) = (T::zero(), elastic.contact_radius);
        let normal = pair.damping * (contact_radius / inverse_mass).simd_sqrt();
        let tangential = if FRICTION { normal * pair.tangential_ratio } else { zero };
        // C_r, and the part of it that acts.
        let (rolling, acting) = match model {
            RollingModel::Epsd if ROLLING => {
                let stiffness = rolling_epsd::stiffness(pair.normal * contact_radius, pair.rolling, radius);
                let damping = rolling_epsd::damping(T::splat(CONTACT_INERTIA) / inverse_moment, stiffness);
                (damping, damping)
            }
            RollingModel::Cdt if ROLLING => {
                let most = rolling_cdt::most(T::splat(SPHERE_INERTIA) / inverse_moment, step);
                let held = L::held(elastic.load, elastic.grip);
                let bound = rolling_friction::largest(pair.rolling, radius, held);
                (most, rolling_cdt::coefficient(most, bound, contact.turning.norm()))
            }
            _ => (zero, zero),
        };
        let turning = if ROLLING { acting * (inverse_moment / inverse_mass) } else { zero };
        let largest = damped_step::largest(normal, tangential, turning * T::splat(1.0 / SPHERE_INERTIA));
        let per_mass = step * inverse_mass;
        let stiffness = pair.normal * contact_radius * per_mass * step;
        let others = (slowing * step - largest * per_mass).simd_max(zero);
        let surface = T::splat(damped_step::SURFACE);
        let bearable = damped_step::bearable(normal * per_mass, others);
        let bearable_sliding = damped_step::bearable(tangential * surface * per_mass, others);
        let bearable_turning = damped_step::bearable(largest * per_mass, others);
        Self {
            normal: normal * damped_step::share(bearable, stiffness),
            tangential: tangential * damped_step::share(bearable_sliding, zero),
            rolling: rolling * damped_step::share(bearable_turning, zero),
            forecast: damped_step::forecast(bearable),
            largest,
        }
    }
}

/// The vector turned into the plane across `normal`, its length kept.
#[inline(always)]
fn turned<T: SimdRealField<Element = f64> + Copy>(vector: Vector3<T>, normal: &Vector3<T>) -> Vector3<T> {
    let flat = vector - *normal * vector.dot(normal);
    let (before, after) = (vector.norm_squared(), flat.norm_squared());
    flat * (before / after).simd_sqrt().select(after.simd_gt(T::zero()), T::one())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turning_keeps_length_and_leaves_the_plane_empty_of_normal() {
        let normal = Vector3::new(0.0, 0.6, 0.8);
        let flat: Vector3<f64> = turned(Vector3::new(1.0, 2.0, 3.0), &normal);
        assert!((flat.norm() - 14.0_f64.sqrt()).abs() < 1e-14);
        assert!(flat.dot(&normal).abs() < 1e-14);
        assert_eq!(turned(Vector3::zeros(), &normal), Vector3::zeros());
    }
}
