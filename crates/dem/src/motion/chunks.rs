//! Fixed chunks of grains: the unit of parallel work.
//!
//! The chunk length never depends on the number of threads. Every chunk adds its own contributions in list
//! order and hands the others over through slots that are read in a fixed order, so that sums, and with them
//! all results, have the same bits for any number of threads.

use amberfield_core::Vector3;

/// Grains per chunk.
pub(crate) const CHUNK: usize = 1024;

/// Force and torque that one chunk hands over to a grain of another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Push {
    /// Force [N].
    pub(crate) force: Vector3<f64>,
    /// Torque [N·m].
    pub(crate) torque: Vector3<f64>,
}

/// Push of no force and no torque.
pub(crate) const NO_PUSH: Push =
    Push { force: Vector3::new(0.0, 0.0, 0.0), torque: Vector3::new(0.0, 0.0, 0.0) };

/// Number of chunks of `count` grains.
pub(crate) fn chunk_count(count: usize) -> usize {
    count.div_ceil(CHUNK)
}

/// Whether work on `count` grains is spread over threads at all.
pub(crate) fn is_parallel(count: usize) -> bool {
    count > CHUNK && rayon::current_num_threads() > 1
}

/// The part of `array` that belongs to chunk `k` of length `size`.
pub(crate) fn part<T>(array: &mut [T], size: usize, k: usize) -> &mut [T] {
    let end = array.len().min((k + 1) * size);
    &mut array[k * size..end]
}

/// Runs `body(k, (part of each array))` for every chunk `k`, in parallel when `parallel`.
macro_rules! for_each_chunk {
    ($parallel:expr, $chunks:expr, ($($array:ident / $size:expr),+ $(,)?), $body:expr) => {{
        let body = $body;
        if $parallel {
            use rayon::prelude::{
                IndexedParallelIterator, IntoParallelIterator, ParallelIterator, ParallelSliceMut,
            };
            ($($array.par_chunks_mut($size),)+)
                .into_par_iter()
                .enumerate()
                .for_each(|(k, parts)| body(k, parts));
        } else {
            for k in 0..$chunks {
                body(k, ($($crate::motion::chunks::part(&mut $array[..], $size, k),)+));
            }
        }
    }};
}
pub(crate) use for_each_chunk;
