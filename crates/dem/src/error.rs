//! Errors of the DEM crate.

use amberfield_core::Vector3;
use amberfield_field::FieldError;
use amberfield_gas::GasError;

/// Reason why a scene cannot start or a run cannot go on.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DemError {
    /// A value of the set-up is impossible.
    #[error("{0}")]
    Setup(String),
    /// Two grains overlap too much at the start.
    #[error(
        "grains {id_i} and {id_j} overlap by {overlap_m:e} m at the start, more than {limit_m:e} m \
         (half the smaller radius); move them apart or set allow_overlap = true"
    )]
    Overlap {
        /// Id of one grain.
        id_i: u64,
        /// Id of the other.
        id_j: u64,
        /// Overlap [m].
        overlap_m: f64,
        /// Largest overlap accepted [m].
        limit_m: f64,
    },
    /// Two grains have the same centre.
    #[error("grains {id_i} and {id_j} have the same centre, so their contact has no direction; move one")]
    Coincident {
        /// Id of one grain.
        id_i: u64,
        /// Id of the other.
        id_j: u64,
    },
    /// A grain is too deep in a wall at the start.
    #[error(
        "grain {id} overlaps wall '{wall}' by {overlap_m:e} m at the start, more than {limit_m:e} m \
         (half its radius); move it or set allow_overlap = true"
    )]
    WallOverlap {
        /// Id of the grain.
        id: u64,
        /// Name of the wall.
        wall: String,
        /// Overlap [m].
        overlap_m: f64,
        /// Largest overlap accepted [m].
        limit_m: f64,
    },
    /// The step is beyond a stability guard.
    #[error(
        "time step {step_s:e} s is beyond the {guard} limit of {limit_s:e} s at t = {time_s:e} s; \
         make step_s smaller, use step_s = \"auto\", or set allow_unstable = true"
    )]
    Unstable {
        /// Name of the guard.
        guard: &'static str,
        /// Step [s].
        step_s: f64,
        /// Limit [s].
        limit_s: f64,
        /// Simulated time [s].
        time_s: f64,
    },
    /// A grain left the domain.
    #[error(
        "grain {id} left the domain through face {face} at ({:e}, {:e}, {:e}) m, t = {time_s:e} s; \
         add a wall there, enlarge the domain, or set particles.on_exit = \"delete\"",
        position_m.x, position_m.y, position_m.z
    )]
    Left {
        /// Id of the grain.
        id: u64,
        /// Position of the grain [m].
        position_m: Vector3<f64>,
        /// The face, such as `z_min`.
        face: String,
        /// Simulated time [s].
        time_s: f64,
    },
    /// A grain's position is no longer finite.
    #[error("grain {id} has a position that is not finite at t = {time_s:e} s; use a smaller step_s")]
    NotFinite {
        /// Id of the grain.
        id: u64,
        /// Simulated time [s].
        time_s: f64,
    },
    /// The electric field failed.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// The gas's flow failed.
    #[error(transparent)]
    Gas(#[from] GasError),
    /// Gas and grains exchange too rarely.
    #[error(
        "gas.interval_s is {interval_s:e} s, longer than the {response_s:e} s in which a grain takes up \
         the gas's velocity, at t = {time_s:e} s; make it shorter, or set allow_unstable = true"
    )]
    GasInterval {
        /// Interval [s].
        interval_s: f64,
        /// Shortest response time [s].
        response_s: f64,
        /// Simulated time [s].
        time_s: f64,
    },
    /// A checkpoint does not belong to the scene.
    #[error("the checkpoint does not fit the scene: {0}; resume with the scene that wrote it")]
    State(String),
}
