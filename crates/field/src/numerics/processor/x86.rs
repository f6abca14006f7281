//! Vectors of AVX2 and AVX-512.

use super::{BLOCK, PADDING, Vector};
use std::arch::x86_64::*;

/// A vector of the processor's from the names of its instructions.
macro_rules! native {
    ($vector:ty, $number:ty, $lanes:literal, $splat:ident, $load:ident, $store:ident, $add:ident, $sub:ident,
     $mul:ident, $fused:ident, $min:ident, $max:ident, $select:expr, $below:expr, $pack:ident,
     $root:expr, $narrow:ident) => {
        impl Vector for $vector {
            type Number = $number;
            const LANES: usize = $lanes;

            #[inline(always)]
            fn splat(value: $number) -> Self {
                // SAFETY: the caller's processor has the instruction, here and below.
                unsafe { $splat(value) }
            }
            #[inline(always)]
            fn load(from: &[$number]) -> Self {
                let from = &from[..$lanes];
                // SAFETY: as many numbers as lanes were just sliced.
                unsafe { $load(from.as_ptr()) }
            }
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                // SAFETY: as above.
                unsafe { $add(self, other) }
            }
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                // SAFETY: as above.
                unsafe { $sub(self, other) }
            }
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                // SAFETY: as above.
                unsafe { $mul(self, other) }
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                // SAFETY: as above.
                unsafe { $fused(self, factor, term) }
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                // SAFETY: as above.
                unsafe { $min(self, other) }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                // SAFETY: as above.
                unsafe { $max(self, other) }
            }
            #[inline(always)]
            fn below(self, bound: Self) -> u32 {
                // SAFETY: as above.
                unsafe { $below(self, bound) }
            }
            #[inline(always)]
            fn pack(self, lanes: u32, to: &mut [$number]) {
                // SAFETY: as above.
                unsafe { $pack(self, lanes) }.write(to);
            }
            #[inline(always)]
            fn select_below(self, bound: Self, value: Self) -> Self {
                // SAFETY: as above.
                unsafe { $select(self, bound, value) }
            }
            #[inline(always)]
            fn estimate_inverse_root(self) -> Self {
                // SAFETY: as above.
                unsafe { $root(self) }
            }
            #[inline(always)]
            fn narrow(from: &[f64], reference: f64, to: &mut [$number]) {
                let (from, to) = (&from[..BLOCK], &mut to[..BLOCK]);
                // SAFETY: the caller's processor has the instructions; a block lies on either side.
                unsafe { $narrow(from.as_ptr(), reference, to.as_mut_ptr()) }
            }
            #[inline(always)]
            fn write(self, to: &mut [$number]) {
                let to = &mut to[..$lanes];
                // SAFETY: room for every lane was just sliced.
                unsafe { $store(to.as_mut_ptr(), self) };
            }
            #[inline(always)]
            fn store(self) -> [$number; PADDING] {
                let mut values = [0.0; PADDING];
                // SAFETY: the array has room for every lane.
                unsafe { $store(values.as_mut_ptr(), self) };
                values
            }
        }
    };
}
#[target_feature(enable = "avx2,fma")]
unsafe fn single_256(from: *const f64, reference: f64, to: *mut f32) {
    let reference = _mm256_set1_pd(reference);
    // SAFETY: eight numbers on either side.
    unsafe {
        let low = _mm256_cvtpd_ps(_mm256_sub_pd(_mm256_loadu_pd(from), reference));
        let high = _mm256_cvtpd_ps(_mm256_sub_pd(_mm256_loadu_pd(from.add(4)), reference));
        _mm_storeu_ps(to, low);
        _mm_storeu_ps(to.add(4), high);
    }
}

#[target_feature(enable = "avx2,fma")]
unsafe fn double_256(from: *const f64, reference: f64, to: *mut f64) {
    let reference = _mm256_set1_pd(reference);
    // SAFETY: eight numbers on either side.
    unsafe {
        _mm256_storeu_pd(to, _mm256_sub_pd(_mm256_loadu_pd(from), reference));
        _mm256_storeu_pd(to.add(4), _mm256_sub_pd(_mm256_loadu_pd(from.add(4)), reference));
    }
}

#[target_feature(enable = "avx512f,fma")]
unsafe fn single_512(from: *const f64, reference: f64, to: *mut f32) {
    let reference = _mm512_set1_pd(reference);
    // SAFETY: eight numbers on either side.
    unsafe { _mm256_storeu_ps(to, _mm512_cvtpd_ps(_mm512_sub_pd(_mm512_loadu_pd(from), reference))) }
}

#[target_feature(enable = "avx512f,fma")]
unsafe fn double_512(from: *const f64, reference: f64, to: *mut f64) {
    let reference = _mm512_set1_pd(reference);
    // SAFETY: eight numbers on either side.
    unsafe { _mm512_storeu_pd(to, _mm512_sub_pd(_mm512_loadu_pd(from), reference)) }
}

/// Places of the bits of each mask, lowest first.
static BITS: [[u32; 8]; 256] = bits();

const fn bits() -> [[u32; 8]; 256] {
    let mut table = [[0; 8]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut bit, mut next) = (0, 0);
        while bit < 8 {
            if mask & 1 << bit != 0 {
                table[mask][next] = bit;
                next += 1;
            }
            bit += 1;
        }
        mask += 1;
    }
    table
}

/// Places of the halves of the doubles of each mask of four.
static HALVES: [[u32; 8]; 16] = halves();

const fn halves() -> [[u32; 8]; 16] {
    let mut table = [[0; 8]; 16];
    let mut mask = 0;
    while mask < 16 {
        let mut lane = 0;
        while lane < 4 {
            table[mask][2 * lane] = 2 * BITS[mask][lane];
            table[mask][2 * lane + 1] = 2 * BITS[mask][lane] + 1;
            lane += 1;
        }
        mask += 1;
    }
    table
}

#[target_feature(enable = "avx2,fma")]
fn pack_256_single(values: __m256, lanes: u32) -> __m256 {
    let places = &BITS[lanes as usize & 255];
    // SAFETY: eight numbers are read from an array of eight.
    let places = unsafe { _mm256_loadu_si256(places.as_ptr().cast()) };
    _mm256_permutevar8x32_ps(values, places)
}

#[target_feature(enable = "avx2,fma")]
fn pack_256_double(values: __m256d, lanes: u32) -> __m256d {
    let places = &HALVES[lanes as usize & 15];
    // SAFETY: eight numbers are read from an array of eight.
    let places = unsafe { _mm256_loadu_si256(places.as_ptr().cast()) };
    _mm256_castps_pd(_mm256_permutevar8x32_ps(_mm256_castpd_ps(values), places))
}

#[target_feature(enable = "avx512f,fma")]
#[expect(clippy::cast_possible_truncation, reason = "sixteen lanes")]
fn pack_512_single(values: __m512, lanes: u32) -> __m512 {
    _mm512_maskz_compress_ps(lanes as u16, values)
}

#[target_feature(enable = "avx512f,fma")]
#[expect(clippy::cast_possible_truncation, reason = "eight lanes")]
fn pack_512_double(values: __m512d, lanes: u32) -> __m512d {
    _mm512_maskz_compress_pd(lanes as u8, values)
}

native!(
    __m256,
    f32,
    8,
    _mm256_set1_ps,
    _mm256_loadu_ps,
    _mm256_storeu_ps,
    _mm256_add_ps,
    _mm256_sub_ps,
    _mm256_mul_ps,
    _mm256_fmadd_ps,
    _mm256_min_ps,
    _mm256_max_ps,
    |a, bound, value| _mm256_and_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(a, bound), value),
    |a, bound| _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(a, bound)).cast_unsigned(),
    pack_256_single,
    |a| _mm256_rsqrt_ps(a),
    single_256
);
native!(
    __m256d,
    f64,
    4,
    _mm256_set1_pd,
    _mm256_loadu_pd,
    _mm256_storeu_pd,
    _mm256_add_pd,
    _mm256_sub_pd,
    _mm256_mul_pd,
    _mm256_fmadd_pd,
    _mm256_min_pd,
    _mm256_max_pd,
    |a, bound, value| _mm256_and_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(a, bound), value),
    |a, bound| _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(a, bound)).cast_unsigned(),
    pack_256_double,
    |a| _mm256_cvtps_pd(_mm_rsqrt_ps(_mm256_cvtpd_ps(a))),
    double_256
);
native!(
    __m512,
    f32,
    16,
    _mm512_set1_ps,
    _mm512_loadu_ps,
    _mm512_storeu_ps,
    _mm512_add_ps,
    _mm512_sub_ps,
    _mm512_mul_ps,
    _mm512_fmadd_ps,
    _mm512_min_ps,
    _mm512_max_ps,
    |a, bound, value| _mm512_maskz_mov_ps(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, bound), value),
    |a, bound| u32::from(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, bound)),
    pack_512_single,
    |a| _mm512_rsqrt14_ps(a),
    single_512
);
native!(
    __m512d,
    f64,
    8,
    _mm512_set1_pd,
    _mm512_loadu_pd,
    _mm512_storeu_pd,
    _mm512_add_pd,
    _mm512_sub_pd,
    _mm512_mul_pd,
    _mm512_fmadd_pd,
    _mm512_min_pd,
    _mm512_max_pd,
    |a, bound, value| _mm512_maskz_mov_pd(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, bound), value),
    |a, bound| u32::from(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, bound)),
    pack_512_double,
    |a| _mm512_rsqrt14_pd(a),
    double_512
);
