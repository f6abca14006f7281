//! The words of amberfield: what every other crate means by a particle, a domain face, a material or a
//! method. No algorithm, no input or output.
//!
//! SI units everywhere, angles in radians. Electric field `E` in V/m points away from positive charge;
//! potential `V` in volts with `E = −∇V`.
#![forbid(unsafe_code)]

mod charge_transfer;
mod cohesion;
mod conductor;
pub mod constants;
mod contact_rules;
mod course;
mod domain;
mod far_question;
mod feed;
mod field_settings;
mod fingerprint;
mod gas;
mod material;
mod material_pair;
mod outlet;
mod particles;
mod permittivity;
mod plan;
mod rolling_model;
mod time_settings;
mod triangle_mesh;
mod volume;
mod wall;
mod wall_motion;

pub use charge_transfer::ChargeTransfer;
pub use cohesion::Cohesion;
pub use conductor::{Conductor, ConductorState};
pub use contact_rules::{ContactRules, WallRule};
pub use course::{Course, CourseRow, FieldCourse, LEAST_PER_PERIOD, PotentialCourse};
pub use domain::{Axis, Boundary, Domain, DomainError, FaceCourse, Side};
pub use far_question::{FarQuestion, SourceCloud};
pub use feed::{Feed, FeedRegion, Feeds, OnBlocked};
pub use field_settings::{CouplingInterval, FieldSettings, ForceLimit, Method, Tuning};
pub use fingerprint::Fingerprint;
pub use gas::{DragLaw, Gas, GasFlow, GasModel};
pub use material::{Material, MaterialId};
pub use material_pair::MaterialPair;
pub use nalgebra::{Matrix3, Vector3};
pub use outlet::{Outlet, OutletRegion};
pub use particles::{Grain, GroupId, Particles};
pub use permittivity::Permittivity;
pub use plan::{Plan, PlanEntry};
pub use rolling_model::RollingModel;
pub use time_settings::{OnExit, Skin, Step, TimeSettings};
pub use triangle_mesh::{SMOOTH_ANGLE, SmoothPatch, TriangleMesh};
pub use volume::Volume;
pub use wall::{Wall, WallCharging, WallShape};
pub use wall_motion::{MotionKind, MotionRow, Placement, WallMotion};
