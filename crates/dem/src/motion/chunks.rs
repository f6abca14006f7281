//! Fixed chunks of grains: the unit of parallel work.
//!
//! The chunk length never depends on the number of threads. Every chunk adds its own contributions in list
//! order and hands the others over through slots that are read in a fixed order, so that sums, and with them
//! all results, have the same bits for any number of threads.

use amberfield_core::Vector3;

/// Grains per chunk.
pub(crate) const CHUNK: usize = 1024;

/// Vectors of the grains of a chunk.
pub(crate) type Vectors<'a> = &'a mut [Vector3<f64>];

/// Force, torque and damping that one chunk hands over to a grain of another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Push {
    /// Force [N].
    pub(crate) force: Vector3<f64>,
    /// Torque [N·m].
    pub(crate) torque: Vector3<f64>,
    /// Rate at which the contact slows the grain [1/s].
    pub(crate) slowing: f64,
}

/// Push of no force and no torque.
pub(crate) const NO_PUSH: Push =
    Push { force: Vector3::new(0.0, 0.0, 0.0), torque: Vector3::new(0.0, 0.0, 0.0), slowing: 0.0 };

/// Sums of what acts on each grain, in the making.
#[derive(Debug, Default)]
pub(crate) struct Loads {
    /// Forces [N].
    pub(crate) force: Vec<Vector3<f64>>,
    /// Torques [N·m]; empty where nothing can turn a grain.
    pub(crate) torque: Vec<Vector3<f64>>,
    /// Rates Γ at which all contacts of a grain slow it [1/s].
    pub(crate) slowing: Vec<f64>,
}

impl Loads {
    /// Fits the arrays to a number of grains that may turn or not.
    pub(crate) fn resize(&mut self, count: usize, turns: bool) {
        self.force.resize(count, Vector3::zeros());
        self.torque.resize(if turns { count } else { 0 }, Vector3::zeros());
        self.slowing.resize(count, 0.0);
    }
}

/// Sums of what acts on each grain of a chunk, in the making; see [`Loads`].
#[derive(Debug)]
pub(crate) struct ChunkLoads<'a> {
    pub(crate) force: &'a mut [Vector3<f64>],
    pub(crate) torque: &'a mut [Vector3<f64>],
    pub(crate) slowing: &'a mut [f64],
}

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

/// Runs `body(k, list, loads)` for every chunk `k` of lists and loads, in parallel where there are many
/// grains.
pub(crate) fn for_each_load<T: Send>(
    lists: &mut [T],
    loads: &mut Loads,
    body: impl Fn(usize, &mut T, ChunkLoads<'_>) + Sync,
) {
    let Loads { force, torque, slowing } = loads;
    let count = force.len();
    let (parallel, chunks) = (is_parallel(count), chunk_count(count));
    if torque.is_empty() {
        for_each_chunk!(parallel, chunks, (lists / 1, force / CHUNK, slowing / CHUNK), |k: usize,
                                                                                        (
            list,
            force,
            slowing,
        ): (
            &mut [T],
            &mut [Vector3<f64>],
            &mut [f64]
        )| {
            body(k, &mut list[0], ChunkLoads { force, torque: &mut [], slowing });
        });
    } else {
        for_each_chunk!(
            parallel,
            chunks,
            (lists / 1, force / CHUNK, torque / CHUNK, slowing / CHUNK),
            |k: usize, (list, force, torque, slowing): (&mut [T], Vectors<'_>, Vectors<'_>, &mut [f64])| body(
                k,
                &mut list[0],
                ChunkLoads { force, torque, slowing }
            )
        );
    }
}
