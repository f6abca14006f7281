//! The arithmetic that one core can do: independent fused multiply-adds in registers.

use crate::timing::median;
use std::hint::black_box;
use std::time::Instant;

/// Independent sums, enough to hide the latency of two units.
const SUMS: usize = 12;
const ROUNDS: usize = 4_000_000;

/// Operations per second in double and in single precision, a fused multiply-add counted as two.
pub(super) fn peaks() -> [f64; 2] {
    #[cfg(target_arch = "x86_64")]
    {
        if std::arch::is_x86_feature_detected!("avx512f") {
            // SAFETY: the processor has the instructions, here and below.
            return [
                best(8, || unsafe { x86::avx512_double() }),
                best(16, || unsafe { x86::avx512_single() }),
            ];
        }
        if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
            // SAFETY: as above.
            return [best(4, || unsafe { x86::avx2_double() }), best(8, || unsafe { x86::avx2_single() })];
        }
    }
    [best(2, portable::<f64, 2>), best(4, portable::<f32, 4>)]
}

/// Median rate of a loop over vectors of so many lanes.
fn best(lanes: usize, work: impl Fn()) -> f64 {
    let rate = |_| {
        let start = Instant::now();
        work();
        (2 * lanes * SUMS * ROUNDS) as f64 / start.elapsed().as_secs_f64()
    };
    median(&mut (0..7).map(rate).collect::<Vec<_>>())
}

/// Plain code, as the compiler makes it.
fn portable<T, const LANES: usize>()
where
    T: Copy + From<f32> + std::ops::Mul<Output = T> + std::ops::Add<Output = T>,
{
    let (factor, mut sums) = (black_box(T::from(0.999_f32)), [[T::from(1.0_f32); LANES]; SUMS]);
    for _ in 0..ROUNDS {
        for sum in sums.iter_mut().flatten() {
            *sum = *sum * factor + factor;
        }
    }
    black_box(sums);
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{ROUNDS, SUMS};
    use std::arch::x86_64::*;
    use std::hint::black_box;

    macro_rules! sums {
        ($name:ident, $features:literal, $set:ident, $fused:ident) => {
            #[target_feature(enable = $features)]
            pub(super) fn $name() {
                let (factor, mut sums) = ($set(black_box(0.999)), [$set(1.0); SUMS]);
                for _ in 0..ROUNDS {
                    for sum in &mut sums {
                        *sum = $fused(*sum, factor, factor);
                    }
                }
                black_box(sums);
            }
        };
    }
    sums!(avx512_double, "avx512f", _mm512_set1_pd, _mm512_fmadd_pd);
    sums!(avx512_single, "avx512f", _mm512_set1_ps, _mm512_fmadd_ps);
    sums!(avx2_double, "avx2,fma", _mm256_set1_pd, _mm256_fmadd_pd);
    sums!(avx2_single, "avx2,fma", _mm256_set1_ps, _mm256_fmadd_ps);
}
