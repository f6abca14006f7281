//! Forces of grains on walls.

use super::WallContact;
use crate::contacts::law::Response;
use amberfield_core::Vector3;

/// Sum of what the grains do to a wall.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WallLoad {
    /// Force along the normals of the contacts: elastic and normal damping [N].
    pub normal: Vector3<f64>,
    /// Force across the normals: friction and tangential damping [N].
    pub tangential: Vector3<f64>,
    /// Torque about the origin, rolling friction included [N·m].
    pub torque: Vector3<f64>,
}

impl WallLoad {
    /// Adds one contact of a grain at `centre` [m], at the distance `arm` [m] from it. `lean` [N] is taken
    /// off the force on the grain, at its centre.
    #[inline(always)]
    pub(super) fn add_contact(
        &mut self,
        contact: &WallContact,
        response: &Response<f64>,
        lean: Vector3<f64>,
        centre: Vector3<f64>,
        arm: f64,
    ) {
        let along = contact.normal * response.force.dot(&contact.normal);
        let place = centre + contact.normal * arm;
        self.normal += lean - along;
        self.tangential += along - response.force;
        self.torque += centre.cross(&lean) - place.cross(&response.force) - response.rolling;
    }

    /// Adds another part of the sum.
    pub(super) fn add(&mut self, other: &Self) {
        self.normal += other.normal;
        self.tangential += other.tangential;
        self.torque += other.torque;
    }
}
