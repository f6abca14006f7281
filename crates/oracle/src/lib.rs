//! Exact and manufactured solutions, reference fields, norms and observed orders of convergence.
//!
//! The crate shares no code with what it judges: it uses neither `laws` nor `field`.
#![forbid(unsafe_code)]

mod charged_ball;
mod collision;
mod grounded_cylinder;
mod grounded_plane;
mod grounded_sphere;
mod half_plane;
mod madelung;
mod manufactured;
mod norms;
mod parallel_plates;
mod point_charge;
pub mod reference;
pub mod surfaces;
mod wedge;

pub use charged_ball::{ChargedBall, ball_points};
pub use collision::{
    COLLISION_CHARGES, CollisionCharge, DampedHertzImpact, EQUILIBRIUM_CHARGE_PER_EV, HertzImpact,
};
pub use grounded_cylinder::GroundedCylinder;
pub use grounded_plane::GroundedPlane;
pub use grounded_sphere::{GroundedSphere, grounded_cavity};
pub use half_plane::GroundedHalfPlane;
pub use madelung::{Lattice, MADELUNG_NACL, rock_salt};
pub use manufactured::Manufactured;
pub use norms::{ErrorNorms, field_scale, observed_order, rms, rms_difference, rms_scalar};
pub use parallel_plates::ParallelPlates;
pub use point_charge::{ExactField, coulomb_field, coulomb_potential, open_sum};
pub use wedge::GroundedWedge;
