//! The host side: a DEM code of your own asks for the field at its particles.

use crate::foreign::{close, guarded, slice, slice_mut};
use crate::status::AmberfieldStatus;
use amberfield_core::{Boundary, Domain, FieldSettings, Permittivity, Tuning, Vector3};
use amberfield_coupling::{Announced, SolverSettings};
use amberfield_field::far::FarField;
use amberfield_field::{Choice, ElectricField, FieldValues, Wanted};
use rayon::{ThreadPool, ThreadPoolBuilder};
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
    /// Threads that the library uses; 0: one for each core that this process may use.
    pub threads: u64,
}

/// The field of a host program's particles.
///
/// A code that runs under MPI gathers positions and charges to one rank of each machine (32 bytes a particle,
/// little beside the work), calls the library there and scatters the fields. The library uses all cores that
/// this rank may use. One handle for the whole run keeps parameters, memory and a solver's warm start. Call
/// it every so many steps and keep E in between.
#[derive(Debug)]
pub struct AmberfieldHost {
    pub(crate) scene: Option<Scene>,
    /// Chosen for the first particles.
    pub(crate) field: Option<ElectricField>,
    /// Threads of its own; `None`: those of the process.
    threads: Option<ThreadPool>,
    positions: Vec<Vector3<f64>>,
    values: FieldValues,
    /// Parameters in force, as text.
    pub(crate) parameters: CString,
    pub(crate) error: CString,
}

impl AmberfieldHost {
    /// E and what else is wanted at particles, in `values`.
    fn evaluate(
        &mut self,
        time: f64,
        places: &[[f64; 3]],
        charges: &[f64],
        wanted: Wanted,
    ) -> Result<(), String> {
        let Self { scene, field, threads, positions, values, .. } = self;
        let scene = scene.as_mut().ok_or(NOT_OPEN)?;
        positions.clear();
        positions.extend(places.iter().map(|&place| Vector3::from(place)));
        let mut evaluate = || {
            if field.is_none() {
                *field = Some(scene.field(positions, charges)?);
            }
            let field = field.as_mut().ok_or(NOT_OPEN)?;
            for position in positions.iter_mut() {
                *position = scene.domain.wrap(*position);
            }
            field.set_time(time);
            field.evaluate_at(time, positions, charges, wanted, values).map_err(|error| error.to_string())
        };
        match threads {
            Some(threads) => threads.install(evaluate),
            None => evaluate(),
        }
    }

    /// Measures the error of E; where it has left the tolerance, parameters are chosen anew by the next call.
    pub(crate) fn recheck(&mut self, places: &[[f64; 3]], charges: &[f64]) -> Result<(), String> {
        let Self { scene, field, threads, positions, .. } = self;
        let scene = scene.as_mut().ok_or(NOT_OPEN)?;
        let Some(known) = field.as_mut() else { return Ok(()) };
        positions.clear();
        positions.extend(places.iter().map(|&place| scene.domain.wrap(Vector3::from(place))));
        let mut measure = || known.measure_error(positions, charges);
        let measured = match threads {
            Some(threads) => threads.install(measure),
            None => measure(),
        };
        let measured = measured.map_err(|error| error.to_string())?;
        let has_left = measured.is_some_and(|measured| measured.relative_rms > scene.settings.tolerance);
        if has_left && scene.solver.is_none() {
            *field = None;
        }
        Ok(())
    }
}

#[derive(Debug)]
pub(crate) struct Scene {
    domain: Domain,
    settings: FieldSettings,
    solver: Option<SolverSettings>,
    /// Parameters that were chosen earlier.
    pub(crate) choice: Option<Choice>,
}

impl Scene {
    /// Builds the field, with parameters for these particles.
    fn field(&mut self, positions: &[Vector3<f64>], charges: &[f64]) -> Result<ElectricField, String> {
        let text = |error: &dyn std::fmt::Display| error.to_string();
        let choice = self.choice.take();
        let Some(solver) = &self.solver else {
            let field = match choice {
                Some(choice) => ElectricField::with_choice(&self.domain, &self.settings, &choice),
                None => ElectricField::new(&self.domain, &self.settings, positions, charges),
            };
            return field.map_err(|error| text(&error));
        };
        let connected = Announced::new(solver.clone()).and_then(Announced::connect);
        let connected = Box::new(connected.map_err(|error| text(&error))?);
        self.domain = connected.mesh().domain().clone();
        let field = match choice {
            Some(choice) => ElectricField::over_mesh_with_choice(connected, &self.settings, &choice),
            None => ElectricField::over_mesh(connected, &self.settings, positions, charges),
        };
        field.map_err(|error| text(&error))
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
        threads: None,
        positions: Vec::new(),
        values: FieldValues::default(),
        parameters: CString::default(),
        error: CString::default(),
    });
    // SAFETY: the caller's promise.
    let settings = unsafe { &*settings };
    let case = (!settings.openfoam_case.is_null())
        // SAFETY: the caller's promise.
        .then(|| unsafe { CStr::from_ptr(settings.openfoam_case) }.to_string_lossy().into_owned());
    let AmberfieldHost { scene, threads, error, .. } = &mut *host;
    guarded(error, || {
        *scene = Some(read(settings, case)?);
        *threads = pool(settings.threads)?;
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
    let host = unsafe { &mut *host };
    let mut error = std::mem::take(&mut host.error);
    let status = guarded(&mut error, || {
        let wanted = Wanted { potential: !potential.is_null(), ..Wanted::default() };
        host.evaluate(time, places, charges, wanted)?;
        // SAFETY: the caller's promise.
        let out = unsafe { slice_mut::<[f64; 3]>(e.cast(), count) };
        for (out, e) in out.iter_mut().zip(&host.values.e) {
            *out = (*e).into();
        }
        if !potential.is_null() {
            // SAFETY: the caller's promise.
            unsafe { slice_mut(potential, count) }.copy_from_slice(&host.values.potential);
        }
        Ok(AmberfieldStatus::Ok)
    });
    host.error = error;
    status
}

/// Computes the energy of the charges [J], whose change with their places gives the forces qE: that of the
/// charges among themselves, their images among them, ½ Σ q V, and that of the charges in the field of the
/// faces' potentials and normal fields, Σ q V. With an OpenFOAM case the second is in the first, once instead
/// of twice a half. Particles are as in amberfield_host_field.
///
/// # Safety
/// `host` comes from amberfield_host_open and is not closed; the arrays have `count` particles; both energies
/// may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_host_energy(
    host: *mut AmberfieldHost,
    time: f64,
    count: u64,
    positions: *const f64,
    charges: *const f64,
    of_charges: *mut f64,
    of_faces: *mut f64,
) -> AmberfieldStatus {
    let count = count as usize;
    // SAFETY: the caller's promise; three doubles have the layout of an array of three.
    let (places, charges) = unsafe { (slice::<[f64; 3]>(positions.cast(), count), slice(charges, count)) };
    // SAFETY: the caller's promise.
    let host = unsafe { &mut *host };
    let mut error = std::mem::take(&mut host.error);
    let status = guarded(&mut error, || {
        host.evaluate(time, places, charges, Wanted { potential: true, ..Wanted::default() })?;
        let field = host.field.as_ref().ok_or(NOT_OPEN)?;
        let (mut among, mut given) = (0.0, 0.0);
        for ((place, charge), potential) in host.positions.iter().zip(charges).zip(&host.values.potential) {
            let of_faces = field.given(place).faces.potential;
            among += 0.5 * charge * (potential - of_faces);
            given += charge * of_faces;
        }
        // SAFETY: the caller's promise.
        unsafe { (*of_charges, *of_faces) = (among, given) };
        Ok(AmberfieldStatus::Ok)
    });
    host.error = error;
    status
}

/// Chooses parameters anew at the next call, for particles that are no longer what they were.
///
/// # Safety
/// `host` comes from amberfield_host_open and is not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_host_retune(host: *mut AmberfieldHost) {
    // SAFETY: the caller's promise.
    let AmberfieldHost { scene, field, error, .. } = unsafe { &mut *host };
    guarded(error, || {
        *field = None;
        if let Some(scene) = scene {
            scene.choice = None;
        }
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
        choice: None,
    })
}

/// Threads of a handle's own; `None` for 0.
fn pool(threads: u64) -> Result<Option<ThreadPool>, String> {
    if threads == 0 {
        return Ok(None);
    }
    let count = usize::try_from(threads).ok().filter(|&count| count <= MOST_THREADS);
    let count = count.ok_or_else(|| format!("threads is {threads}; give at most {MOST_THREADS}"))?;
    ThreadPoolBuilder::new().num_threads(count).build().map(Some).map_err(|error| error.to_string())
}

/// Message of a handle that was not opened well.
pub(crate) const NOT_OPEN: &str = "the field is not open";
/// Most threads of a handle.
const MOST_THREADS: usize = 4096;

/// Folder in which the field solver works, in that of the host.
const WORKPLACE: &str = "amberfield-solver";
/// Relative tolerance of the linear solver over the field's.
const FAR_TOLERANCE: f64 = 1e-4;
