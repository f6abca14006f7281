//! Calls of a host program: energy, parameters and threads.

use amberfield_capi::{
    AmberfieldBoundary, AmberfieldHost, AmberfieldHostSettings, AmberfieldStatus, amberfield_host_close,
    amberfield_host_energy, amberfield_host_error, amberfield_host_field, amberfield_host_measured_error,
    amberfield_host_open, amberfield_host_parameters, amberfield_host_recheck,
    amberfield_host_use_parameters,
};
use std::ffi::{CStr, CString};

const COUNT: usize = 400;
const EDGE: f64 = 0.01;
/// Potential of the upper face [V].
const POTENTIAL: f64 = 500.0;

/// A handle that closes itself.
struct Host(*mut AmberfieldHost);

impl Host {
    /// A box with plates across z.
    fn new(threads: u64) -> Self {
        // SAFETY: all zero is a good start, as the header says.
        let mut settings: AmberfieldHostSettings = unsafe { std::mem::zeroed() };
        settings.high = [EDGE; 3];
        for face in &mut settings.faces[..4] {
            face.boundary = AmberfieldBoundary::Periodic as u64;
        }
        settings.faces[5].boundary = AmberfieldBoundary::Potential as u64;
        settings.faces[5].value = POTENTIAL;
        (settings.tolerance, settings.model_tuning, settings.threads) = (1e-6, 1, threads);
        // SAFETY: the settings live.
        Self(unsafe { amberfield_host_open(&raw const settings) })
    }

    fn error(&self) -> String {
        // SAFETY: the handle is open.
        unsafe { CStr::from_ptr(amberfield_host_error(self.0)) }.to_string_lossy().into_owned()
    }

    fn field(&self, places: &[f64], charges: &[f64]) -> Vec<f64> {
        let mut e = vec![0.0; places.len()];
        let (count, none) = (charges.len() as u64, std::ptr::null_mut());
        // SAFETY: the handle is open, the arrays have the lengths.
        let status = unsafe {
            amberfield_host_field(self.0, 0.0, count, places.as_ptr(), charges.as_ptr(), e.as_mut_ptr(), none)
        };
        assert_eq!(status, AmberfieldStatus::Ok, "{}", self.error());
        e
    }

    /// Energies among the charges, and in the faces' field.
    fn energy(&self, places: &[f64], charges: &[f64]) -> [f64; 2] {
        let [mut among, mut given] = [0.0; 2];
        let (count, x, q) = (charges.len() as u64, places.as_ptr(), charges.as_ptr());
        // SAFETY: the handle is open, the arrays have the lengths.
        let status =
            unsafe { amberfield_host_energy(self.0, 0.0, count, x, q, &raw mut among, &raw mut given) };
        assert_eq!(status, AmberfieldStatus::Ok, "{}", self.error());
        [among, given]
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        // SAFETY: the handle is open and not used again.
        unsafe { amberfield_host_close(self.0) }
    }
}

/// Places and charges from a sequence that fills the box evenly.
fn particles() -> (Vec<f64>, Vec<f64>) {
    let part = |k: usize, step: f64| (k as f64 * step).fract() * 0.9 * EDGE + 0.05 * EDGE;
    let places = (0..COUNT).flat_map(|k| [part(k, 0.819_172_5), part(k, 0.671_043_6), part(k, 0.549_700_5)]);
    let charges = (0..COUNT).map(|k| if k % 2 == 0 { 1e-13 } else { -1.2e-13 });
    (places.collect(), charges.collect())
}

#[test]
fn energy_falls_by_the_work_of_the_force() {
    let (mut places, charges) = particles();
    let host = Host::new(0);
    let e = host.field(&places, &charges);
    let (grain, axis, step) = (7, 2, 1e-6);
    let mut at = |shift: f64| {
        places[3 * grain + axis] += shift;
        let [among, given] = host.energy(&places, &charges);
        among + given
    };
    let slope = (at(step) - at(-2.0 * step)) / (2.0 * step);
    let force = charges[grain] * e[3 * grain + axis];
    assert!((slope + force).abs() < 1e-3 * force.abs(), "{slope:e} {force:e}");
    let [_, given] = host.energy(&places, &charges);
    let expected: f64 =
        charges.iter().enumerate().map(|(k, q)| q * POTENTIAL * places[3 * k + 2] / EDGE).sum();
    assert!((given / expected - 1.0).abs() < 1e-9, "{given:e} {expected:e}");
}

#[test]
fn parameters_are_chosen_anew_where_the_error_has_left_the_tolerance() {
    let (places, charges) = particles();
    let host = Host::new(0);
    // Parameters for a few charges in the middle are none for pairs that nearly touch.
    let few: Vec<f64> = charges.iter().enumerate().map(|(k, q)| if k < 3 { *q } else { 0.0 }).collect();
    host.field(&places, &few);
    let recheck = |charges: &[f64]| {
        // SAFETY: the handle is open, the arrays have the lengths.
        let status =
            unsafe { amberfield_host_recheck(host.0, COUNT as u64, places.as_ptr(), charges.as_ptr()) };
        assert_eq!(status, AmberfieldStatus::Ok, "{}", host.error());
        host.field(&places, charges);
        // SAFETY: the handle is open.
        unsafe { amberfield_host_measured_error(host.0) }
    };
    assert!((0.0..=1e-6).contains(&recheck(&charges)));
    assert!((0.0..=1e-6).contains(&recheck(&charges)));
}

#[test]
fn parameters_of_an_earlier_run_and_any_threads_give_the_same_field() {
    let (places, charges) = particles();
    let host = Host::new(1);
    let e = host.field(&places, &charges);
    // SAFETY: the handle is open.
    let (measured, text) = unsafe {
        let text = CStr::from_ptr(amberfield_host_parameters(host.0)).to_owned();
        (amberfield_host_measured_error(host.0), text)
    };
    assert!((0.0..1e-6).contains(&measured), "{measured:e}");
    let again = Host::new(2);
    // SAFETY: the handle is open, the text is a C string.
    let status = unsafe { amberfield_host_use_parameters(again.0, text.as_ptr()) };
    assert_eq!(status, AmberfieldStatus::Ok, "{}", again.error());
    assert_eq!(again.field(&places, &charges), e);
    let nonsense = CString::new("{}").unwrap();
    // SAFETY: the handle is open, the text is a C string.
    let status = unsafe { amberfield_host_use_parameters(again.0, nonsense.as_ptr()) };
    assert!(status == AmberfieldStatus::Failed && again.error().contains("parameters of an earlier run"));
}
