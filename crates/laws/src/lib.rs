//! One closed-form physical law per file: pure functions, few scalars in, few out.
//!
//! SI units. Electric field points away from positive charge. Unit vectors n point from i to j.
#![forbid(unsafe_code)]

pub mod beetstra_drag;
pub mod charge_transfer;
pub mod contact_area;
pub mod coulomb_friction;
pub mod di_felice_drag;
pub mod dielectric_breakdown;
pub mod drag;
pub mod force_limit;
pub mod gidaspow_drag;
pub mod hertz_mindlin;
pub mod image_in_plane;
pub mod kaiser_bessel_cloud;
pub mod magnus_lift;
pub mod particle_reynolds;
pub mod point_charge;
pub mod restitution;
pub mod rolling_friction;
pub mod saffman_lift;
pub mod schiller_naumann_drag;
pub mod stokes_drag;
pub mod time_step_limits;
