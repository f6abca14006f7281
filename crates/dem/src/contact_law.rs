//! One contact: force and torque from overlap, relative motion and history.
//!
//! The tangential spring is kept as a force, advanced by −S_t v_t Δt with the slip v_t at the end of the step
//! (first order: a damping of ½ S_t Δt, which vanishes with the step), and turned with the contact. While the
//! contact unloads it shrinks with the contact radius √(R*δ), so that no energy is made by stretching a spring
//! at high load and releasing it at low load (Thornton, Cummins & Cleary, Powder Technol. 233, 30 (2013)). The
//! normal damping is kept to the end of the contact (δ = 0), where it pulls slightly: that is what makes the
//! coefficient of restitution exact; friction sees no negative load.

use crate::material_pairs::PairConstants;
use amberfield_core::Vector3;
use amberfield_laws::rolling_friction;

/// Geometry and motion of one contact of body i with body j; n points from i to j.
pub(crate) struct Contact {
    pub(crate) overlap: f64,
    pub(crate) normal: Vector3<f64>,
    /// v_i − v_j of the centres.
    pub(crate) velocity: Vector3<f64>,
    /// a_i ω_i + a_j ω_j, a the distance from centre to contact.
    pub(crate) spin: Vector3<f64>,
    /// ω_i − ω_j.
    pub(crate) turning: Vector3<f64>,
    /// R*.
    pub(crate) radius: f64,
    /// 1/m*.
    pub(crate) inverse_mass: f64,
    /// Σ 1/(m r²) of the bodies.
    pub(crate) inverse_moment: f64,
}

/// What the contact does.
pub(crate) struct Response {
    /// Force on i; −force on j.
    pub(crate) force: Vector3<f64>,
    /// n × F_t: times a_i on i, times a_j on j.
    pub(crate) twist: Vector3<f64>,
    /// Rolling torque on i; the opposite on j.
    pub(crate) rolling: Vector3<f64>,
}

/// Inertia of a sphere about its contact over m r².
const CONTACT_INERTIA: f64 = 7.0 / 5.0;

/// `spring` holds the tangential force and the contact radius √(R*δ) of the last step.
#[inline(always)]
pub(crate) fn respond<const FRICTION: bool, const ROLLING: bool, const DAMPING: bool>(
    contact: &Contact,
    pair: &PairConstants,
    step: f64,
    spring: &mut [f64; 4],
    rolling: &mut [f64; 3],
) -> Response {
    let Contact { overlap, normal, velocity, .. } = *contact;
    let contact_radius = (overlap * contact.radius).sqrt();
    let approach = velocity.dot(&normal);
    let damping = if DAMPING { pair.damping * (contact_radius / contact.inverse_mass).sqrt() } else { 0.0 };
    let load = pair.hertz * contact_radius * overlap + damping * approach;
    let mut response = Response { force: normal * -load, twist: Vector3::zeros(), rolling: Vector3::zeros() };
    if FRICTION {
        let sliding = velocity - normal * approach + contact.spin.cross(&normal);
        let stiffness = pair.tangential * contact_radius;
        let dashpot = sliding * (damping * pair.tangential_ratio);
        let mut elastic = turned(Vector3::new(spring[0], spring[1], spring[2]), &normal);
        if contact_radius < spring[3] {
            elastic *= contact_radius / spring[3];
        }
        elastic -= sliding * (stiffness * step);
        let mut tangential = elastic - dashpot;
        let bound = pair.friction * load.max(0.0);
        let size2 = tangential.norm_squared();
        if size2 > bound * bound {
            tangential *= bound / size2.sqrt();
            elastic = tangential + dashpot;
        }
        *spring = [elastic.x, elastic.y, elastic.z, contact_radius];
        response.force += tangential;
        response.twist = normal.cross(&tangential);
    }
    if ROLLING {
        let turning = contact.turning;
        let radius = contact.radius;
        let stiffness = rolling_friction::stiffness(pair.normal * contact_radius, pair.rolling, radius);
        let dashpot = rolling_friction::damping(CONTACT_INERTIA / contact.inverse_moment, stiffness);
        let bound = rolling_friction::largest(pair.rolling, radius, load);
        let (new, torque) = rolling_friction::advance(
            Vector3::from(*rolling),
            turning * step,
            turning,
            stiffness,
            dashpot,
            bound,
        );
        *rolling = new.into();
        response.rolling = torque;
    }
    response
}

/// The vector turned into the plane across `normal`, its length kept.
#[inline(always)]
fn turned(vector: Vector3<f64>, normal: &Vector3<f64>) -> Vector3<f64> {
    let flat = vector - normal * vector.dot(normal);
    let (before, after) = (vector.norm_squared(), flat.norm_squared());
    if after > 0.0 { flat * (before / after).sqrt() } else { flat }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turning_keeps_length_and_leaves_the_plane_empty_of_normal() {
        let normal = Vector3::new(0.0, 0.6, 0.8);
        let flat = turned(Vector3::new(1.0, 2.0, 3.0), &normal);
        assert!((flat.norm() - 14.0_f64.sqrt()).abs() < 1e-14);
        assert!(flat.dot(&normal).abs() < 1e-14);
        assert_eq!(turned(Vector3::zeros(), &normal), Vector3::zeros());
    }
}
