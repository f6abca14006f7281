//! Stopwatches.

use std::time::Instant;

/// Median seconds of a body, called again until `least_s` seconds have gone by, at least three times.
pub(crate) fn median_seconds(least_s: f64, mut body: impl FnMut()) -> f64 {
    let begun = Instant::now();
    let mut times = Vec::new();
    while times.len() < 3 || begun.elapsed().as_secs_f64() < least_s {
        let start = Instant::now();
        body();
        times.push(start.elapsed().as_secs_f64());
    }
    median(&mut times)
}

/// Median of values, of which there is one at least.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Runs a body in a pool of so many threads.
pub(crate) fn on_threads<R: Send>(threads: usize, body: impl FnOnce() -> R + Send) -> R {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
    pool.install(body)
}
