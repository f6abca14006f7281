//! The host side: a DEM code of your own asks for the field at its particles.

use crate::foreign::{close, guarded, slice_mut};
use crate::host::{AmberfieldHost, Particles, Workers, call};
use crate::host_ranks::{AmberfieldRanks, RankServer};
use crate::host_settings::{AmberfieldHostSettings, pool, read};
use crate::status::AmberfieldStatus;
use amberfield_field::Wanted;
use std::ffi::{CStr, c_char};

/// Opens a field. The result is never NULL; amberfield_host_error is empty when it worked.
///
/// # Safety
/// `settings` may be read; its case is a C string or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_host_open(
    settings: *const AmberfieldHostSettings,
) -> *mut AmberfieldHost {
    // SAFETY: the caller's promise.
    Box::into_raw(unsafe { opened(&*settings, None) })
}

/// Opens a field that ranks share: every rank of the host program opens it with the same settings and its own
/// table, gives its own particles to the calls that follow, and gets their field. All ranks make the same
/// calls in the same order, also those without particles; what fails on one rank fails on all, with the same
/// text. AmberfieldStatus_Broken is a failure of one rank alone, and so is a handle that was not opened well:
/// then end the program. A rank should have the particles of a compact piece of the box. `threads` 0 stands
/// for all cores that this rank may use.
///
/// With an OpenFOAM case rank 0 starts the solver and gets the particles of all ranks.
///
/// # Safety
/// As for amberfield_host_open; `ranks` may be read, and its functions may be called until the handle is
/// closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_host_open_over_ranks(
    settings: *const AmberfieldHostSettings,
    ranks: *const AmberfieldRanks,
) -> *mut AmberfieldHost {
    // SAFETY: the caller's promise.
    Box::into_raw(unsafe { opened(&*settings, Some(*ranks)) })
}

/// A handle, opened or with the reason why not.
///
/// # Safety
/// The case is a C string or NULL.
unsafe fn opened(settings: &AmberfieldHostSettings, ranks: Option<AmberfieldRanks>) -> Box<AmberfieldHost> {
    let mut host = Box::new(AmberfieldHost::default());
    let case = (!settings.openfoam_case.is_null())
        // SAFETY: the caller's promise.
        .then(|| unsafe { CStr::from_ptr(settings.openfoam_case) }.to_string_lossy().into_owned());
    let AmberfieldHost { scene, workers, error, .. } = &mut *host;
    guarded(error, || {
        let server = ranks.map(RankServer::new).transpose()?;
        *workers = Workers { threads: pool(settings.threads, server.is_some())?, server };
        *scene = Some(read(settings, case)?);
        Ok(AmberfieldStatus::Ok)
    });
    host
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
/// itself, unless `potential` is NULL, for all ranks or none. The particles are at `positions` [m], three
/// doubles each, with `charges` [C], at the time `time` [s]. The first call chooses parameters and starts the
/// solver, if there is one.
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
    // SAFETY: the caller's promise.
    let (host, particles) = unsafe { (&mut *host, Particles::new(count, positions, charges)) };
    call(host, |host| {
        let wanted = Wanted { potential: !potential.is_null(), ..Wanted::default() };
        let values = host.evaluate(time, particles, wanted)?;
        // SAFETY: the caller's promise.
        let out = unsafe { slice_mut::<[f64; 3]>(e.cast(), particles.charges.len()) };
        for (out, e) in out.iter_mut().zip(&values.e) {
            *out = (*e).into();
        }
        if !potential.is_null() {
            // SAFETY: the caller's promise.
            let out = unsafe { slice_mut(potential, particles.charges.len()) };
            if out.len() != values.potential.len() {
                return Err("rank 0 has not asked for potentials; all ranks must, or none".into());
            }
            out.copy_from_slice(&values.potential);
        }
        Ok(())
    })
}

/// Computes the energy of the charges [J], whose change with their places gives the forces qE: that of the
/// charges among themselves, their images among them, ½ Σ q V, and that of the charges in the field of the
/// faces' potentials and normal fields, Σ q V. With an OpenFOAM case the second is in the first, once instead
/// of twice a half. Particles are as in amberfield_host_field; ranks that share a field get the energy of the
/// particles of all.
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
    // SAFETY: the caller's promise.
    let (host, particles) = unsafe { (&mut *host, Particles::new(count, positions, charges)) };
    call(host, |host| {
        let [among, given] = host.energy(time, particles)?;
        // SAFETY: the caller's promise.
        unsafe { (*of_charges, *of_faces) = (among, given) };
        Ok(())
    })
}

/// Chooses parameters anew at the next call, for particles that are no longer what they were.
///
/// # Safety
/// `host` comes from amberfield_host_open and is not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_host_retune(host: *mut AmberfieldHost) {
    // SAFETY: the caller's promise.
    call(unsafe { &mut *host }, |host| {
        host.field = None;
        if let Some(scene) = &mut host.scene {
            scene.choice = None;
        }
        Ok(())
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
