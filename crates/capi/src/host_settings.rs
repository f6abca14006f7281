//! Settings of a host program, and the scene that they describe.

use amberfield_core::{Boundary, Domain, FieldSettings, Permittivity, Tuning, Vector3};
use amberfield_coupling::SolverSettings;
use amberfield_field::Choice;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::ffi::c_char;
use std::time::Duration;

/// Condition on a face of the box.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AmberfieldBoundary {
    /// A conductor at V = 0.
    Grounded = 0,
    /// A conductor at the potential `value` [V].
    Potential = 1,
    /// A surface with the outward normal field `value` [V/m]; 0 is an insulator.
    NormalField = 2,
    /// Joined to the opposite face.
    Periodic = 3,
    /// Free space beyond.
    Open = 4,
}

/// Face of the box, with the condition there.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct AmberfieldFace {
    /// Condition, a value of AmberfieldBoundary.
    pub boundary: u64,
    /// Potential [V] or outward normal field [V/m]; 0 for other conditions.
    pub value: f64,
}

/// Settings of a host program; the method is p3m, units are SI. Set all to zero, then what differs.
#[repr(C)]
#[derive(Debug)]
pub struct AmberfieldHostSettings {
    /// Lower corner of the box [m].
    pub low: [f64; 3],
    /// Upper corner [m].
    pub high: [f64; 3],
    /// Faces in the order x low, x high, y low, ...; with an OpenFOAM case its box and its patches count
    /// instead.
    pub faces: [AmberfieldFace; 6],
    /// Relative RMS error of E; 0: 1e-2.
    pub tolerance: f64,
    /// Relative permittivity; 0: 1.
    pub relative_permittivity: f64,
    /// 1: a net charge that no face takes is balanced by a uniform background.
    pub neutralising_background: u64,
    /// 1: parameters by the cost model, the same on every machine; 0: by timing candidates once.
    pub model_tuning: u64,
    /// Folder of an OpenFOAM case, whose mesh and conditions count, or NULL: the internal grid.
    pub openfoam_case: *const c_char,
    /// 1: wait for a solver that somebody else starts (electricFieldFoam without -run finds it); 0: start it.
    pub wait_for_solver: u64,
    /// Processes of the solver; 0: 1.
    pub ranks: u64,
    /// Time that an answer of the solver may take [s]; 0: 30.
    pub timeout: f64,
    /// Threads that the library uses; 0: one for each core that this process may use.
    pub threads: u64,
}

/// Box, settings and solver of a host program.
#[derive(Debug)]
pub(crate) struct Scene {
    pub(crate) domain: Domain,
    pub(crate) settings: FieldSettings,
    pub(crate) solver: Option<SolverSettings>,
    /// Parameters that were chosen earlier.
    pub(crate) choice: Option<Choice>,
}

pub(crate) fn read(settings: &AmberfieldHostSettings, case: Option<String>) -> Result<Scene, String> {
    let or = |value: f64, default: f64| if value == 0.0 { default } else { value };
    let face = |index: usize| {
        let AmberfieldFace { boundary, value } = settings.faces[index];
        match boundary {
            known if known == AmberfieldBoundary::Grounded as u64 => Ok(Boundary::Grounded),
            known if known == AmberfieldBoundary::Potential as u64 => Ok(Boundary::Potential(value)),
            known if known == AmberfieldBoundary::NormalField as u64 => {
                Ok(Boundary::Insulating { normal_field_v_m: value })
            }
            known if known == AmberfieldBoundary::Periodic as u64 => Ok(Boundary::Periodic),
            known if known == AmberfieldBoundary::Open as u64 => Ok(Boundary::Open),
            other => Err(format!("faces[{index}].boundary is {other}; give an AmberfieldBoundary")),
        }
    };
    let domain = match &case {
        // The mesh's, once it is known.
        Some(_) => Domain::new(Vector3::zeros(), Vector3::repeat(1.0), [[Boundary::Open; 2]; 3]),
        None => {
            let pair = |index| Ok::<_, String>([face(index)?, face(index + 1)?]);
            let faces = [pair(0)?, pair(2)?, pair(4)?];
            Domain::new(Vector3::from(settings.low), Vector3::from(settings.high), faces)
        }
    };
    let domain = domain.map_err(|error| error.to_string())?;
    let tolerance = or(settings.tolerance, FieldSettings::default().tolerance);
    if !(1e-15..1.0).contains(&tolerance) {
        return Err(format!("tolerance is {tolerance}; give one between 1e-15 and 1"));
    }
    let permittivity = or(settings.relative_permittivity, 1.0);
    if !(1.0..1e6).contains(&permittivity) {
        return Err(format!("relative_permittivity is {permittivity}; give 1 or more"));
    }
    let timeout = or(settings.timeout, 30.0);
    let timeout =
        Duration::try_from_secs_f64(timeout).map_err(|error| format!("timeout is {timeout} s: {error}"))?;
    let ranks = u32::try_from(settings.ranks.max(1)).map_err(|_| format!("ranks is {}", settings.ranks))?;
    Ok(Scene {
        domain,
        settings: FieldSettings {
            tolerance,
            permittivity: Permittivity::from_relative(permittivity),
            neutralising_background: settings.neutralising_background != 0,
            tuning: if settings.model_tuning == 0 { Tuning::Timed } else { Tuning::Model },
            ..FieldSettings::default()
        },
        solver: case.map(|case| SolverSettings {
            workplace: (settings.wait_for_solver == 0).then(|| WORKPLACE.into()),
            ranks,
            timeout,
            far_tolerance: FAR_TOLERANCE * tolerance,
            ..SolverSettings::awaited(case)
        }),
        choice: None,
    })
}

/// Threads of a handle's own; `None` for 0, all that the process has. Where ranks share the field, threads
/// wait for each other's ranks: these are always a handle's own.
pub(crate) fn pool(threads: u64, is_shared: bool) -> Result<Option<ThreadPool>, String> {
    if threads == 0 && !is_shared {
        return Ok(None);
    }
    let count = usize::try_from(threads).ok().filter(|&count| count <= MOST_THREADS);
    let count = count.ok_or_else(|| format!("threads is {threads}; give at most {MOST_THREADS}"))?;
    ThreadPoolBuilder::new().num_threads(count).build().map(Some).map_err(|error| error.to_string())
}

/// Most threads of a handle.
const MOST_THREADS: usize = 4096;

/// Folder in which the field solver works, in that of the host.
const WORKPLACE: &str = "amberfield-solver";
/// Relative tolerance of the linear solver over the field's.
const FAR_TOLERANCE: f64 = 1e-4;
