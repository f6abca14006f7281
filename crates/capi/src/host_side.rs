//! The host side: a DEM code of your own asks for the field at its particles.

use crate::foreign::{close, guarded, slice, slice_mut};
use crate::status::AmberfieldStatus;
use amberfield_core::{Boundary, Domain, FieldSettings, Permittivity, Tuning, Vector3};
use amberfield_coupling::{Announced, SolverSettings};
use amberfield_field::far::FarField;
use amberfield_field::{ElectricField, FieldValues, Wanted};
use std::ffi::{CStr, CString, c_char};
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
}

/// The field of a host program's particles.
///
/// A code that runs under MPI gathers positions and charges to one rank of each machine (32 bytes a particle,
/// little beside the work), calls the library there and scatters the fields. The library uses all cores that
/// this rank may use. One handle for the whole run keeps parameters, memory and a solver's warm start. Call
/// it every so many steps and keep E in between.
#[derive(Debug)]
pub struct AmberfieldHost {
    scene: Option<Scene>,
    /// Chosen for the first particles.
    field: Option<ElectricField>,
    positions: Vec<Vector3<f64>>,
    values: FieldValues,
    error: CString,
}

#[derive(Debug)]
struct Scene {
    domain: Domain,
    settings: FieldSettings,
    solver: Option<SolverSettings>,
}

impl Scene {
    /// Builds the field, with parameters for these particles.
    fn field(&mut self, positions: &[Vector3<f64>], charges: &[f64]) -> Result<ElectricField, String> {
        let text = |error: &dyn std::fmt::Display| error.to_string();
        let Some(solver) = &self.solver else {
            return ElectricField::new(&self.domain, &self.settings, positions, charges)
                .map_err(|error| text(&error));
        };
        let connected = Announced::new(solver.clone()).and_then(Announced::connect);
        let connected = connected.map_err(|error| text(&error))?;
        self.domain = connected.mesh().domain().clone();
        ElectricField::over_mesh(Box::new(connected), &self.settings, positions, charges)
            .map_err(|error| text(&error))
    }
}

/// Opens a field. The result is never NULL; amberfield_host_error is empty when it worked.
///
/// # Safety
/// `settings` may be read; its case is a C string or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_host_open(
    settings: *const AmberfieldHostSettings,
) -> *mut AmberfieldHost {
    let mut host = Box::new(AmberfieldHost {
        scene: None,
        field: None,
        positions: Vec::new(),
        values: FieldValues::default(),
        error: CString::default(),
    });
    // SAFETY: the caller's promise.
    let settings = unsafe { &*settings };
    let case = (!settings.openfoam_case.is_null())
        // SAFETY: the caller's promise.
        .then(|| unsafe { CStr::from_ptr(settings.openfoam_case) }.to_string_lossy().into_owned());
    let AmberfieldHost { scene, error, .. } = &mut *host;
    guarded(error, || {
        *scene = Some(read(settings, case)?);
        Ok(AmberfieldStatus::Ok)
    });
    Box::into_raw(host)
}

/// Returns the reason why the last call on a handle failed; empty if it did not. The text is valid until the
/// next call.
///
/// # Safety
/// `host` comes from amberfield_host_open and is not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_host_error(host: *const AmberfieldHost) -> *const c_char {
    // SAFETY: the caller's promise.
    unsafe { &*host }.error.as_ptr()
}

/// Computes E [V/m] at every particle, three doubles each, and the potential [V] of all but the particle
/// itself, unless `potential` is NULL. The particles are at `positions` [m], three doubles each, with
/// `charges` [C], at the time `time` [s]. The first call chooses parameters and starts the solver, if there
/// is one.
///
/// # Safety
/// `host` comes from amberfield_host_open and is not closed; the arrays have room for `count` particles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_host_field(
    host: *mut AmberfieldHost,
    time: f64,
    count: u64,
    positions: *const f64,
    charges: *const f64,
    e: *mut f64,
    potential: *mut f64,
) -> AmberfieldStatus {
    let count = count as usize;
    // SAFETY: the caller's promise; three doubles have the layout of an array of three.
    let (places, charges) = unsafe { (slice::<[f64; 3]>(positions.cast(), count), slice(charges, count)) };
    // SAFETY: the caller's promise.
    let AmberfieldHost { scene, field, positions, values, error } = unsafe { &mut *host };
    guarded(error, || {
        let scene = scene.as_mut().ok_or("the field is not open")?;
        positions.clear();
        positions.extend(places.iter().map(|&place| Vector3::from(place)));
        if field.is_none() {
            *field = Some(scene.field(positions, charges)?);
        }
        let field = field.as_mut().ok_or("the field is not open")?;
        for position in positions.iter_mut() {
            *position = scene.domain.wrap(*position);
        }
        let wanted = Wanted { potential: !potential.is_null(), ..Wanted::default() };
        field.set_time(time);
        field.evaluate_at(time, positions, charges, wanted, values).map_err(|error| error.to_string())?;
        // SAFETY: the caller's promise.
        let out = unsafe { slice_mut::<[f64; 3]>(e.cast(), count) };
        for (out, e) in out.iter_mut().zip(&values.e) {
            *out = (*e).into();
        }
        if !potential.is_null() {
            // SAFETY: the caller's promise.
            unsafe { slice_mut(potential, count) }.copy_from_slice(&values.potential);
        }
        Ok(AmberfieldStatus::Ok)
    })
}

/// Chooses parameters anew at the next call, for particles that are no longer what they were.
///
/// # Safety
/// `host` comes from amberfield_host_open and is not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_host_retune(host: *mut AmberfieldHost) {
    // SAFETY: the caller's promise.
    let AmberfieldHost { field, error, .. } = unsafe { &mut *host };
    guarded(error, || {
        *field = None;
        Ok(AmberfieldStatus::Ok)
    });
}

/// Ends the solver, if there is one, and closes a handle of the host side. NULL is allowed.
///
/// # Safety
/// `host` comes from amberfield_host_open and is not closed; the handle is gone afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_host_close(host: *mut AmberfieldHost) {
    // SAFETY: the caller's promise.
    unsafe { close(host) };
}

fn read(settings: &AmberfieldHostSettings, case: Option<String>) -> Result<Scene, String> {
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
    })
}

/// Folder in which the field solver works, in that of the host.
const WORKPLACE: &str = "amberfield-solver";
/// Relative tolerance of the linear solver over the field's.
const FAR_TOLERANCE: f64 = 1e-4;
