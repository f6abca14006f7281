//! The field of a host program's particles, in one process or shared by ranks.

use crate::foreign::{guarded, slice};
use crate::host_gathered::{Gathered, Own};
use crate::host_ranks::RankServer;
use crate::host_settings::Scene;
use crate::status::AmberfieldStatus;
use amberfield_core::Vector3;
use amberfield_coupling::Announced;
use amberfield_field::far::FarField;
use amberfield_field::{Choice, ElectricField, FieldValues, Ranks, Wanted};
use rayon::ThreadPool;
use std::ffi::CString;
use std::sync::Arc;

/// Message of a handle that was not opened well.
pub(crate) const NOT_OPEN: &str = "the field is not open";

/// The field of a host program's particles.
///
/// A code that runs under MPI opens it with amberfield_host_open_over_ranks; each rank then gives its own
/// particles, and gets their field. One handle for the whole run keeps parameters, memory and a solver's warm
/// start. Call it every so many steps and keep E in between.
#[derive(Debug, Default)]
pub struct AmberfieldHost {
    pub(crate) scene: Option<Scene>,
    pub(crate) workers: Workers,
    /// Chosen for the first particles.
    pub(crate) field: Option<ElectricField>,
    /// Relative error that was measured last; 0 for an exact sum.
    pub(crate) measured: Option<f64>,
    /// Particles of all ranks, on the one that has a solver.
    gathered: Gathered,
    positions: Vec<Vector3<f64>>,
    values: FieldValues,
    /// Parameters in force, as text.
    pub(crate) parameters: CString,
    pub(crate) error: CString,
}

/// Threads that compute, and ranks that they compute with.
#[derive(Debug, Default)]
pub(crate) struct Workers {
    /// Threads of the handle's own; `None`: those of the process, where no ranks share the field.
    pub(crate) threads: Option<ThreadPool>,
    pub(crate) server: Option<RankServer>,
}

impl Workers {
    /// Works in the threads, while the caller serves exchanges between ranks.
    fn run<T: Send>(&self, work: impl FnOnce() -> Result<T, String> + Send) -> Result<T, String> {
        let Some(server) = &self.server else {
            return match &self.threads {
                Some(threads) => threads.install(work),
                None => work(),
            };
        };
        let threads = self.threads.as_ref().ok_or(NOT_OPEN)?;
        let mut outcome = Err(NOT_OPEN.to_owned());
        let (end, room) = (server.end(), &mut outcome);
        threads.in_place_scope(|scope| {
            scope.spawn(move |_| {
                let _end = end;
                *room = work();
            });
            server.serve();
        });
        outcome
    }
}

/// Particles of a host program.
#[derive(Clone, Copy)]
pub(crate) struct Particles<'a> {
    /// Places [m].
    pub(crate) places: &'a [[f64; 3]],
    /// Charges [C].
    pub(crate) charges: &'a [f64],
}

impl Particles<'_> {
    /// Particles in a host's arrays.
    ///
    /// # Safety
    /// The arrays have `count` particles.
    pub(crate) unsafe fn new(count: u64, positions: *const f64, charges: *const f64) -> Self {
        let count = count as usize;
        // SAFETY: the caller's promise; three doubles have the layout of an array of three.
        unsafe { Self { places: slice(positions.cast(), count), charges: slice(charges, count) } }
    }
}

/// Calls a handle's method; an error or a panic becomes the handle's text.
pub(crate) fn call(
    host: &mut AmberfieldHost,
    method: impl FnOnce(&mut AmberfieldHost) -> Result<(), String>,
) -> AmberfieldStatus {
    let mut error = std::mem::take(&mut host.error);
    let mut has_panicked = true;
    let status = guarded(&mut error, || {
        let outcome = method(host);
        has_panicked = false;
        outcome.map(|()| AmberfieldStatus::Ok)
    });
    host.error = error;
    match &host.workers.server {
        Some(server) if has_panicked || server.is_broken() => AmberfieldStatus::Broken,
        _ => status,
    }
}

impl AmberfieldHost {
    /// E and what else is wanted at particles.
    pub(crate) fn evaluate(
        &mut self,
        time: f64,
        particles: Particles<'_>,
        wanted: Wanted,
    ) -> Result<&FieldValues, String> {
        self.compute(particles, |field, own, values| {
            field.set_time(time);
            let Own { positions, charges } = own;
            field.evaluate_at(time, positions, charges, wanted, values).map_err(|error| error.to_string())
        })?;
        Ok(&self.values)
    }

    /// Energy of the charges of all ranks among themselves, and in the field of the faces [J].
    pub(crate) fn energy(&mut self, time: f64, particles: Particles<'_>) -> Result<[f64; 2], String> {
        let mut energies = [0.0; 2];
        self.compute(particles, |field, own, values| {
            field.set_time(time);
            let Own { positions, charges } = own;
            let wanted = Wanted { potential: true, ..Wanted::default() };
            field.evaluate_at(time, positions, charges, wanted, values).map_err(|error| error.to_string())?;
            for ((place, charge), potential) in positions.iter().zip(charges).zip(&values.potential) {
                let of_faces = field.given(place).faces.potential;
                energies[0] += 0.5 * charge * (potential - of_faces);
                energies[1] += charge * of_faces;
            }
            Ok(())
        })?;
        let Workers { server, .. } = &self.workers;
        let Some(ranks) = server.as_ref().map(RankServer::ranks) else { return Ok(energies) };
        self.workers.run(|| {
            ranks.sum(&mut energies).map_err(|error| error.to_string())?;
            Ok(energies)
        })
    }

    /// Measures the error of E; where it has left the tolerance, parameters are chosen anew by the next call.
    pub(crate) fn recheck(&mut self, particles: Particles<'_>) -> Result<(), String> {
        self.compute(particles, |field, own, values| {
            values.e.clear();
            values.potential.clear();
            let measured = field.measure_error(own.positions, own.charges);
            measured.map(drop).map_err(|error| error.to_string())
        })?;
        let scene = self.scene.as_ref().ok_or(NOT_OPEN)?;
        let has_left = self.measured.is_some_and(|measured| measured > scene.settings.tolerance);
        if has_left && scene.solver.is_none() {
            self.field = None;
        }
        Ok(())
    }

    /// Computes something at all particles that a field knows: this rank's own on the internal grid, those of
    /// all ranks, on rank 0, where a solver answers. The first call makes the field.
    fn compute(
        &mut self,
        particles: Particles<'_>,
        mut work: impl FnMut(&mut ElectricField, Own<'_>, &mut FieldValues) -> Result<(), String> + Send,
    ) -> Result<(), String> {
        let Self { scene, workers, field, measured, gathered, positions, values, .. } = self;
        let scene = scene.as_mut().ok_or(NOT_OPEN)?;
        positions.clear();
        positions.extend(particles.places.iter().map(|&place| Vector3::from(place)));
        let ranks = workers.server.as_ref().map(RankServer::ranks);
        workers.run(|| {
            let has_solver = scene.solver.is_some();
            let mut at = |own: Own<'_>, values: &mut FieldValues| {
                if field.is_none() {
                    *field = Some(scene.field(ranks, &own)?);
                }
                let field = field.as_mut().ok_or(NOT_OPEN)?;
                // Where a solver has the box it is known only now.
                for position in own.positions.iter_mut() {
                    *position = scene.domain.wrap(*position);
                }
                work(field, own, values)?;
                Ok(measured_error(field))
            };
            let own = Own { positions, charges: particles.charges };
            let found = match ranks {
                Some(ranks) if has_solver => gathered.compute(ranks.as_ref(), &own, values, at)?,
                _ => at(own, values)?,
            };
            *measured = found.or(*measured);
            Ok(())
        })
    }
}

/// Relative error of a field's E that was measured last; 0 where the sum is exact.
fn measured_error(field: &ElectricField) -> Option<f64> {
    match (field.choice(), field.error_measured()) {
        (_, Some(measured)) => Some(measured.relative_rms),
        (Choice::AllPairs | Choice::Direct, None) => Some(0.0),
        _ => None,
    }
}

impl Scene {
    /// Builds the field, with parameters for these particles; over ranks, if there are any and no solver.
    fn field(&mut self, ranks: Option<&Arc<dyn Ranks>>, own: &Own<'_>) -> Result<ElectricField, String> {
        let (domain, settings) = (&self.domain, &self.settings);
        let (positions, charges): (&[Vector3<f64>], _) = (own.positions, own.charges);
        let choice = self.choice.take();
        let field = match (&self.solver, ranks) {
            (Some(solver), _) => {
                let connected = Announced::new(solver.clone()).and_then(Announced::connect);
                let connected = Box::new(connected.map_err(|error| error.to_string())?);
                self.domain = connected.mesh().domain().clone();
                match choice {
                    Some(choice) => ElectricField::over_mesh_with_choice(connected, settings, &choice),
                    None => ElectricField::over_mesh(connected, settings, positions, charges),
                }
            }
            (None, Some(ranks)) => match choice {
                // Parameters of one process may be none that ranks can share.
                Some(choice @ Choice::P3m(_)) => {
                    ElectricField::over_ranks_with_choice(Arc::clone(ranks), domain, settings, &choice)
                }
                _ => ElectricField::over_ranks(Arc::clone(ranks), domain, settings, positions, charges),
            },
            (None, None) => match choice {
                Some(choice) => ElectricField::with_choice(domain, settings, &choice),
                None => ElectricField::new(domain, settings, positions, charges),
            },
        };
        field.map_err(|error| error.to_string())
    }
}
