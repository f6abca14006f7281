//! Closed-form physical laws, one per file: pure functions of a few scalars.
//!
//! All quantities are in SI units. The electric field points away from positive charge. Unit vectors n point
//! from body i to body j.
#![forbid(unsafe_code)]

pub mod beetstra_drag;
pub mod charge_transfer;
pub mod charged_triangle;
pub mod contact_area;
pub mod coulomb_friction;
pub mod cubic_table;
pub mod damped_step;
pub mod di_felice_drag;
pub mod dielectric_breakdown;
pub mod dmt;
pub mod drag;
pub mod force_limit;
pub mod gidaspow_drag;
pub mod hertz_mindlin;
pub mod image_in_plane;
pub mod jkr;
pub mod kaiser_bessel_cloud;
pub mod kept_charge;
pub mod magnus_lift;
pub mod particle_reynolds;
pub mod point_charge;
pub mod restitution;
pub mod rolling_cdt;
pub mod rolling_epsd;
pub mod rolling_epsd2;
pub mod rolling_friction;
pub mod rotation_vector;
pub mod saffman_lift;
pub mod schiller_naumann_drag;
pub mod self_disturbance;
pub mod servo;
pub mod stokes_drag;
pub mod time_step_limits;
pub mod vibration;
pub mod wedge;
pub mod work_of_adhesion;
