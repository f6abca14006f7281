//! Calls of a host program whose ranks share a field. Ranks are threads here, with tables made of channels.

use amberfield_capi::{
    AmberfieldBoundary, AmberfieldHost, AmberfieldHostSettings, AmberfieldRanks, AmberfieldStatus,
    amberfield_host_close, amberfield_host_energy, amberfield_host_error, amberfield_host_field,
    amberfield_host_measured_error, amberfield_host_open, amberfield_host_open_over_ranks,
    amberfield_host_parameters, amberfield_host_recheck, amberfield_host_use_parameters,
};
use amberfield_field::{Parcels, Ranks, ThreadRank};
use std::ffi::{CStr, CString, c_void};

const COUNT: usize = 300;
const EDGE: f64 = 0.01;
/// Relative differences that another order of adding makes.
const ROUND_OFF: f64 = 1e-11;

/// Exchanges numbers as MPI_Alltoallv does.
unsafe extern "C" fn exchange(
    context: *mut c_void,
    sent: *const f64,
    sent_counts: *const u64,
    received: *mut f64,
    received_counts: *const u64,
) -> i32 {
    // SAFETY: the context is a rank, the arrays have the numbers that the library promises.
    unsafe {
        let rank = &*context.cast::<ThreadRank>();
        let sizes = |counts: *const u64| {
            let counts = std::slice::from_raw_parts(counts, rank.count());
            counts.iter().map(|&count| count as usize).collect::<Vec<_>>()
        };
        let (mut to, mut from) = (Parcels::default(), Parcels::default());
        to.resize(sizes(sent_counts));
        from.resize(sizes(received_counts));
        let count = to.values.len();
        to.values.copy_from_slice(std::slice::from_raw_parts(sent, count));
        let outcome = rank.exchange(&to, &mut from);
        std::slice::from_raw_parts_mut(received, from.values.len()).copy_from_slice(&from.values);
        i32::from(outcome.is_err())
    }
}

/// Sums numbers as MPI_Allreduce does.
unsafe extern "C" fn sum(context: *mut c_void, values: *mut f64, count: u64) -> i32 {
    // SAFETY: as above.
    let outcome = unsafe {
        let values = std::slice::from_raw_parts_mut(values, count as usize);
        (*context.cast::<ThreadRank>()).sum(values)
    };
    i32::from(outcome.is_err())
}

fn table(rank: &ThreadRank) -> AmberfieldRanks {
    AmberfieldRanks {
        rank: rank.rank() as u64,
        count: rank.count() as u64,
        context: std::ptr::from_ref(rank).cast_mut().cast(),
        exchange: Some(exchange),
        sum: Some(sum),
    }
}

/// A handle that closes itself.
struct Host(*mut AmberfieldHost);

fn settings(threads: u64) -> AmberfieldHostSettings {
    // SAFETY: all zero is a good start, as the header says.
    let mut settings: AmberfieldHostSettings = unsafe { std::mem::zeroed() };
    settings.high = [EDGE; 3];
    for face in &mut settings.faces[..4] {
        face.boundary = AmberfieldBoundary::Periodic as u64;
    }
    settings.faces[5].boundary = AmberfieldBoundary::Potential as u64;
    settings.faces[5].value = 300.0;
    (settings.tolerance, settings.model_tuning, settings.threads) = (1e-6, 1, threads);
    settings
}

impl Host {
    fn alone() -> Self {
        let settings = settings(1);
        // SAFETY: the settings live.
        Self(unsafe { amberfield_host_open(&raw const settings) })
    }

    fn over(table: &AmberfieldRanks, threads: u64) -> Self {
        let settings = settings(threads);
        // SAFETY: the settings and the table live.
        Self(unsafe { amberfield_host_open_over_ranks(&raw const settings, table) })
    }

    fn error(&self) -> String {
        // SAFETY: the handle is open.
        unsafe { CStr::from_ptr(amberfield_host_error(self.0)) }.to_string_lossy().into_owned()
    }

    fn field(&self, places: &[f64], charges: &[f64]) -> Result<(Vec<f64>, Vec<f64>), String> {
        let (mut e, mut potential) = (vec![0.0; places.len()], vec![0.0; charges.len()]);
        let (count, x, q) = (charges.len() as u64, places.as_ptr(), charges.as_ptr());
        // SAFETY: the handle is open, the arrays have the lengths.
        let status = unsafe {
            amberfield_host_field(self.0, 0.0, count, x, q, e.as_mut_ptr(), potential.as_mut_ptr())
        };
        if status == AmberfieldStatus::Ok { Ok((e, potential)) } else { Err(self.error()) }
    }

    fn energy(&self, places: &[f64], charges: &[f64]) -> [f64; 2] {
        let [mut among, mut given] = [0.0; 2];
        let (count, x, q) = (charges.len() as u64, places.as_ptr(), charges.as_ptr());
        // SAFETY: the handle is open, the arrays have the lengths.
        let status =
            unsafe { amberfield_host_energy(self.0, 0.0, count, x, q, &raw mut among, &raw mut given) };
        assert_eq!(status, AmberfieldStatus::Ok, "{}", self.error());
        [among, given]
    }

    /// Error before and after it is measured anew.
    fn errors(&self, places: &[f64], charges: &[f64]) -> [f64; 2] {
        let (count, x, q) = (charges.len() as u64, places.as_ptr(), charges.as_ptr());
        // SAFETY: the handle is open, the arrays have the lengths.
        unsafe {
            let before = amberfield_host_measured_error(self.0);
            assert_eq!(amberfield_host_recheck(self.0, count, x, q), AmberfieldStatus::Ok);
            [before, amberfield_host_measured_error(self.0)]
        }
    }

    fn parameters(&self) -> String {
        // SAFETY: the handle is open.
        unsafe { CStr::from_ptr(amberfield_host_parameters(self.0)) }.to_string_lossy().into_owned()
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        // SAFETY: it is closed once.
        unsafe { amberfield_host_close(self.0) };
    }
}

fn particles() -> (Vec<f64>, Vec<f64>) {
    let at = |i: usize, step: f64| EDGE * (0.02 + 0.96 * (i as f64 * step).fract());
    let places = (0..COUNT).flat_map(|i| [at(i, 0.618_03), at(i, 0.414_21), at(i, 0.302_78)]).collect();
    (places, (0..COUNT).map(|i| 1e-12 * (i % 5) as f64 - 1.5e-12).collect())
}

/// Does the same on ranks that are threads, each with its part of the particles along x.
fn on_ranks<T: Send>(count: usize, work: impl Fn(&AmberfieldRanks, &[usize]) -> T + Sync) -> Vec<T> {
    let (places, _) = particles();
    let (work, places) = (&work, &places);
    std::thread::scope(|scope| {
        let threads = ThreadRank::all(count).into_iter().map(|rank| {
            scope.spawn(move || {
                let slab = |i: &usize| (places[3 * i] / EDGE * count as f64) as usize == rank.rank();
                let own: Vec<usize> = (0..COUNT).filter(slab).collect();
                work(&table(&rank), &own)
            })
        });
        let threads: Vec<_> = threads.collect();
        threads.into_iter().map(|thread| thread.join().expect("no rank panics")).collect()
    })
}

fn part(own: &[usize]) -> (Vec<f64>, Vec<f64>) {
    let (places, charges) = particles();
    let places = own.iter().flat_map(|&i| places[3 * i..3 * i + 3].to_vec()).collect();
    (places, own.iter().map(|&i| charges[i]).collect())
}

fn close(a: f64, b: f64, scale: f64) -> bool {
    (a - b).abs() <= ROUND_OFF * scale
}

#[test]
fn ranks_get_the_field_and_the_energy_of_one_process() {
    let (places, charges) = particles();
    let alone = Host::alone();
    let (e, potential) = alone.field(&places, &charges).expect("a field");
    let energy = alone.energy(&places, &charges);
    let parameters = CString::new(alone.parameters()).expect("no zero");
    let largest = e.iter().fold(0.0, |most: f64, e| most.max(e.abs()));
    let highest = potential.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    for (count, threads) in [(1, 1), (2, 1), (3, 2), (5, 0)] {
        on_ranks(count, |table, own| {
            let host = Host::over(table, threads);
            // The last digits of parameters that ranks choose may differ.
            // SAFETY: the handle is open, the text lives.
            let status = unsafe { amberfield_host_use_parameters(host.0, parameters.as_ptr()) };
            assert_eq!(status, AmberfieldStatus::Ok, "{}", host.error());
            let (places, charges) = part(own);
            let found = host.field(&places, &charges).expect("a field");
            for (place, &i) in own.iter().enumerate() {
                assert!(close(found.1[place], potential[i], highest));
                assert!((0..3).all(|axis| close(found.0[3 * place + axis], e[3 * i + axis], largest)));
            }
            let found = host.energy(&places, &charges);
            assert!(
                close(found[0], energy[0], energy[0].abs()) && close(found[1], energy[1], energy[1].abs())
            );
            assert_eq!(host.parameters().as_bytes(), parameters.as_bytes());
        });
    }
}

#[test]
fn ranks_choose_parameters_and_measure_together() {
    let errors = on_ranks(3, |table, own| {
        let host = Host::over(table, 1);
        let (places, charges) = part(own);
        host.field(&places, &charges).expect("a field");
        let errors = host.errors(&places, &charges);
        (errors, host.parameters())
    });
    assert!(errors.iter().all(|other| *other == errors[0]), "{errors:?}");
    let [before, after] = errors[0].0;
    assert!(before > 0.0 && before < 1e-6 && close(before, after, before * 1e3), "{before:e} {after:e}");
}

#[test]
fn what_one_rank_refuses_all_refuse() {
    let words = on_ranks(3, |table, own| {
        let host = Host::over(table, 1);
        let (places, mut charges) = part(own);
        if table.rank == 1 {
            charges[0] = f64::NAN;
        }
        let refused = host.field(&places, &charges).expect_err("a charge is none");
        let (_, charges) = part(own);
        host.field(&places, &charges).expect("all is well again");
        refused
    });
    assert!(words.iter().all(|text| text.contains("not finite") && *text == words[0]), "{words:?}");
}

/// A table function that fails, as MPI might.
unsafe extern "C" fn fails(_: *mut c_void, _: *mut f64, _: u64) -> i32 {
    7
}

#[test]
fn a_host_whose_function_fails_is_told_to_end() {
    let rank = ThreadRank::all(1).remove(0);
    let host = Host::over(&AmberfieldRanks { sum: Some(fails), ..table(&rank) }, 1);
    let (places, charges) = particles();
    let mut e = vec![0.0; places.len()];
    let (count, none) = (charges.len() as u64, std::ptr::null_mut());
    // SAFETY: the handle is open, the arrays have the lengths.
    let status = unsafe {
        amberfield_host_field(host.0, 0.0, count, places.as_ptr(), charges.as_ptr(), e.as_mut_ptr(), none)
    };
    assert_eq!(status, AmberfieldStatus::Broken);
    assert!(host.error().contains("function returned 7"), "{}", host.error());
}

#[test]
fn tables_that_cannot_be_used_are_refused() {
    let rank = ThreadRank::all(1).remove(0);
    let good = table(&rank);
    for (table, expected) in [
        (AmberfieldRanks { rank: 1, ..good }, "rank is 1 of count 1"),
        (AmberfieldRanks { count: 0, ..good }, "rank is 0 of count 0"),
        (AmberfieldRanks { sum: None, ..good }, "NULL"),
        (AmberfieldRanks { exchange: None, ..good }, "NULL"),
    ] {
        let host = Host::over(&table, 1);
        assert!(host.error().contains(expected), "{}", host.error());
        assert!(host.field(&[0.0; 3], &[1e-12]).is_err());
    }
}
