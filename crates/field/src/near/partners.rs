//! Partners within the cut-off, packed: the few that count among the many that the cells offer.

use super::instructions::Instructions;
use std::ops::Range;

/// Partners handled together.
pub(crate) const LANES: usize = 8;
/// Partners held before they are summed.
const CAPACITY: usize = 512;
/// Sources looked at between two checks of the room left.
const CHUNK: usize = 128;
/// Values that arrays of sources hold behind the last one, so that the last ones can be read as whole lanes.
pub(crate) const PADDING: usize = LANES;

/// Sources in separate arrays, with [`PADDING`] more values behind the last.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sources<'a> {
    pub(crate) x: &'a [f64],
    pub(crate) y: &'a [f64],
    pub(crate) z: &'a [f64],
    pub(crate) charge: &'a [f64],
}

/// What a sum is taken at: a place, and the index of the source that is the target itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Target {
    pub(crate) position: [f64; 3],
    pub(crate) own: usize,
}

/// Offsets (target less source) and charges of partners within the cut-off.
#[derive(Debug)]
pub(crate) struct Partners {
    x: [f64; CAPACITY],
    y: [f64; CAPACITY],
    z: [f64; CAPACITY],
    charge: [f64; CAPACITY],
    len: usize,
}

impl Default for Partners {
    fn default() -> Self {
        let zero = [0.0; CAPACITY];
        Self { x: zero, y: zero, z: zero, charge: zero, len: 0 }
    }
}

impl Partners {
    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }

    /// Completes the last block with charges of nothing at a harmless distance.
    pub(crate) fn fill_last_lanes(&mut self, distance: f64) {
        for at in self.len..self.len.next_multiple_of(LANES) {
            (self.x[at], self.y[at], self.z[at], self.charge[at]) = (distance, 0.0, 0.0, 0.0);
        }
    }

    /// Blocks of x, y, z offsets and charges.
    #[inline(always)]
    pub(crate) fn blocks(&self) -> impl Iterator<Item = [&[f64; LANES]; 4]> {
        let whole = self.len.next_multiple_of(LANES);
        let [x, y, z, charge] = [&self.x, &self.y, &self.z, &self.charge]
            .map(|array| array[..whole].as_chunks::<LANES>().0.iter());
        x.zip(y).zip(z).zip(charge).map(|(((x, y), z), charge)| [x, y, z, charge])
    }

    /// Keeps the value written last where it is within the cut-off.
    #[inline(always)]
    fn push(&mut self, d: [f64; 3], charge: f64, keep: bool) {
        let at = self.len;
        (self.x[at], self.y[at], self.z[at], self.charge[at]) = (d[0], d[1], d[2], charge);
        self.len += usize::from(keep);
    }
}

/// Picks the partners within a cut-off from runs of sources.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gather {
    cutoff_squared: f64,
    instructions: Instructions,
}

impl Gather {
    pub(crate) fn new(cutoff_squared: f64, instructions: Instructions) -> Self {
        Self { cutoff_squared, instructions }
    }

    /// Appends the partners in a run, the target excepted; `flush` must empty the partners when they are full.
    #[inline(always)]
    pub(crate) fn append(
        &self,
        target: Target,
        sources: Sources<'_>,
        run: Range<usize>,
        partners: &mut Partners,
        mut flush: impl FnMut(&mut Partners),
    ) {
        for start in run.clone().step_by(CHUNK) {
            if partners.len > CAPACITY - CHUNK - LANES {
                flush(partners);
            }
            let chunk = start..run.end.min(start + CHUNK);
            match self.instructions {
                #[cfg(target_arch = "x86_64")]
                // SAFETY: `Instructions::detect` found AVX-512 on this processor; the arrays are padded.
                Instructions::Avx512 => unsafe {
                    append_avx512(self.cutoff_squared, target, sources, chunk, partners);
                },
                _ => append_each(self.cutoff_squared, target, sources, chunk, partners),
            }
        }
    }
}

fn append_each(
    cutoff_squared: f64,
    target: Target,
    sources: Sources<'_>,
    run: Range<usize>,
    partners: &mut Partners,
) {
    for source in run {
        let d = [
            target.position[0] - sources.x[source],
            target.position[1] - sources.y[source],
            target.position[2] - sources.z[source],
        ];
        let r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        partners.push(d, sources.charge[source], r2 < cutoff_squared && source != target.own);
    }
}

/// Eight sources at a time, packed by the mask of those that count.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,fma,popcnt")]
fn append_avx512(
    cutoff_squared: f64,
    target: Target,
    sources: Sources<'_>,
    run: Range<usize>,
    partners: &mut Partners,
) {
    use std::arch::x86_64::{
        __m512d, _CMP_LT_OQ, _mm512_cmp_pd_mask, _mm512_fmadd_pd, _mm512_loadu_pd, _mm512_maskz_compress_pd,
        _mm512_mul_pd, _mm512_set1_pd, _mm512_storeu_pd, _mm512_sub_pd,
    };
    let limit = _mm512_set1_pd(cutoff_squared);
    let place = target.position.map(|coordinate| _mm512_set1_pd(coordinate));
    let load = |array: &[f64], start: usize| -> __m512d {
        let lanes = &array[start..start + LANES];
        // SAFETY: eight values were just sliced.
        unsafe { _mm512_loadu_pd(lanes.as_ptr()) }
    };
    for start in run.clone().step_by(LANES) {
        let x = _mm512_sub_pd(place[0], load(sources.x, start));
        let y = _mm512_sub_pd(place[1], load(sources.y, start));
        let z = _mm512_sub_pd(place[2], load(sources.z, start));
        let r2 = _mm512_fmadd_pd(x, x, _mm512_fmadd_pd(y, y, _mm512_mul_pd(z, z)));
        let within = _mm512_cmp_pd_mask::<_CMP_LT_OQ>(r2, limit);
        let in_run = if start + LANES <= run.end { 0xff } else { (1_u16 << (run.end - start)) as u8 - 1 };
        let own = target.own.wrapping_sub(start);
        let not_own = if own < LANES { !(1_u8 << own) } else { 0xff };
        let mask = within & in_run & not_own;
        let at = partners.len;
        let store = |array: &mut [f64; CAPACITY], values: __m512d| {
            let lanes = &mut array[at..at + LANES];
            // SAFETY: room for eight values was just sliced.
            unsafe { _mm512_storeu_pd(lanes.as_mut_ptr(), _mm512_maskz_compress_pd(mask, values)) };
        };
        store(&mut partners.x, x);
        store(&mut partners.y, y);
        store(&mut partners.z, z);
        store(&mut partners.charge, load(sources.charge, start));
        partners.len += mask.count_ones() as usize;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_instruction_set_picks_the_same_partners() {
        const COUNT: usize = 701;
        let value = |i: usize, k: f64| (i as f64 * k).fract() - 0.5;
        let arrays: [Vec<f64>; 4] =
            [0.618, 0.414, 0.303, 0.732].map(|k| (0..COUNT + PADDING).map(|i| value(i, k)).collect());
        let sources = Sources { x: &arrays[0], y: &arrays[1], z: &arrays[2], charge: &arrays[3] };
        let pick = |instructions| {
            let gather = Gather::new(0.2, instructions);
            let (mut partners, mut picked) = (Partners::default(), Vec::new());
            let mut keep = |partners: &mut Partners| {
                for i in 0..partners.len {
                    picked.push([partners.x[i], partners.y[i], partners.z[i], partners.charge[i]]);
                }
                partners.clear();
            };
            let target = Target { position: [0.01, 0.02, -0.03], own: 10 };
            for run in [0..3, 3..20, 20..20, 21..COUNT] {
                gather.append(target, sources, run, &mut partners, &mut keep);
            }
            keep(&mut partners);
            picked
        };
        let portable = pick(Instructions::Portable);
        assert!(portable.len() > 100);
        assert_eq!(pick(Instructions::detect()), portable);
    }
}
