//! Errors of the DEM crate.

use amberfield_core::Vector3;
use amberfield_field::FieldError;
use amberfield_gas::GasError;

/// Key of a scene, whose place a message can name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SceneKey {
    /// Section.
    pub section: &'static str,
    /// Number of the item in a section that is a list, in the order of the set-up.
    pub number: usize,
    /// Name of the key; of several the one that is given.
    pub names: &'static [&'static str],
}

impl SceneKey {
    /// Key of a section that is no list.
    #[must_use]
    pub fn of(section: &'static str, names: &'static [&'static str]) -> Self {
        Self { section, number: 0, names }
    }

    /// Error about the key.
    pub(crate) fn refuse(self, problem: String) -> DemError {
        DemError::Key { key: self, problem }
    }
}

/// Reason why a scene cannot start or a run cannot go on.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DemError {
    /// A value of the set-up is impossible.
    #[error("{0}")]
    Setup(String),
    /// A value of a key is impossible.
    #[error("{problem}")]
    Key {
        /// Key.
        key: SceneKey,
        /// Fault, and what to do.
        problem: String,
    },
    /// Grains overlap each other or walls too much at the start.
    #[error(
        "{count} overlap(s) at the start are above a hundredth of a radius; the largest is \
         {overlap_m:.3e} m, {share:.3} of a radius, of grain {id} and {partner}; move them apart, or set \
         particles.allow_overlap = true if that is meant"
    )]
    Overlap {
        /// Number of contacts that overlap too much.
        count: usize,
        /// Id of the grain of the largest.
        id: u64,
        /// Grain or wall that it overlaps.
        partner: String,
        /// Overlap [m].
        overlap_m: f64,
        /// Overlap over the smaller radius.
        share: f64,
    },
    /// A contact has become too deep to be sound.
    #[error(
        "at t = {time_s:e} s grain {id} (at ({:.4e}, {:.4e}, {:.4e}) m with ({:.3e}, {:.3e}, {:.3e}) m/s) \
         overlaps {partner} by {overlap_m:.3e} m, {share:.2} of its radius: more than {limit:.2}; the motion \
         is no longer sound, and the grain may end on the other side: make the grains stiffer (young_Pa), \
         time.step_s smaller, or check what presses on this grain",
        position_m.x, position_m.y, position_m.z, velocity_m_s.x, velocity_m_s.y, velocity_m_s.z
    )]
    TooDeep {
        /// Id of the grain.
        id: u64,
        /// Position of the grain [m].
        position_m: Vector3<f64>,
        /// Velocity of the grain [m/s].
        velocity_m_s: Vector3<f64>,
        /// Grain or wall that it overlaps.
        partner: String,
        /// Overlap [m].
        overlap_m: f64,
        /// Overlap over the smaller radius.
        share: f64,
        /// Largest share allowed.
        limit: f64,
        /// Simulated time [s].
        time_s: f64,
    },
    /// Two grains have the same centre.
    #[error("grains {id_i} and {id_j} have the same centre, so their contact has no direction; move one")]
    Coincident {
        /// Id of one grain.
        id_i: u64,
        /// Id of the other.
        id_j: u64,
    },
    /// The step is beyond a stability guard.
    #[error(
        "time step {step_s:e} s is beyond the {guard} limit of {limit_s:e} s at t = {time_s:e} s; \
         make time.step_s smaller, as a number (\"auto\" fits it to {}), or set time.allow_unstable = true",
        known_to_auto(guard)
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
    /// A feed finds no place for a grain.
    #[error(
        "feed \"{feed}\" finds no place for grain {id} at t = {time_s:e} s, and {owed} of its grains are \
         due; make its region larger, its rate smaller or velocity_m_s faster, or set on_blocked = \"wait\""
    )]
    Blocked {
        /// Name of the feed.
        feed: String,
        /// Id of the first grain that waits.
        id: u64,
        /// Number of grains that are due.
        owed: u64,
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

/// Things that an automatic step fits to, as the message of a guard says it.
fn known_to_auto(guard: &str) -> &'static str {
    match guard {
        "plasma" => {
            "the start of a run and to what feeds bring, not to charges that contacts make or that motion \
             brings together), or make electric_field.coupling_interval shorter (\"auto\" is the shortest"
        }
        "electric pair" | "wall image" => {
            "the start of a run and to what feeds bring, not to charges that contacts make"
        }
        _ => "the start of a run",
    }
}
