//! Vectors of numbers in single or double precision, by the instructions that this processor has.

/// Values behind the last one of an array that is read in whole lanes: the most lanes of any processor.
pub(crate) const PADDING: usize = 16;
/// Numbers narrowed at a time.
pub(crate) const BLOCK: usize = 8;

/// Vector instructions of this processor, found at run time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Instructions {
    #[cfg(target_arch = "x86_64")]
    Avx512,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    Portable,
}

impl Instructions {
    pub(crate) fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            let fused = std::arch::is_x86_feature_detected!("fma");
            if fused && std::arch::is_x86_feature_detected!("avx512f") {
                return Self::Avx512;
            }
            if fused && std::arch::is_x86_feature_detected!("avx2") {
                return Self::Avx2;
            }
        }
        Self::Portable
    }
}

/// Compiles a function for every set of instructions, and calls the one of this processor. The function that it is made
/// from has one parameter more, the vector of f64 to compute with; a const parameter `P` is handed on.
macro_rules! dispatched {
    ($(#[$doc:meta])* $visibility:vis fn $name:ident $(<const $p:ident: usize>)? ($($argument:ident: $type:ty),* $(,)?)
     $(-> $result:ty)? = $body:ident) => {
        $(#[$doc])*
        #[inline(always)]
        $visibility fn $name $(<const $p: usize>)? (
            instructions: $crate::processor::Instructions, $($argument: $type),*
        ) $(-> $result)? {
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,fma")]
            fn avx2 $(<const $p: usize>)? ($($argument: $type),*) $(-> $result)? {
                $body::<$($p,)? std::arch::x86_64::__m256d>($($argument),*)
            }
            match instructions {
                #[cfg(target_arch = "x86_64")]
                // SAFETY: `Instructions::detect` found AVX2 on this processor, which AVX-512 implies.
                $crate::processor::Instructions::Avx2 | $crate::processor::Instructions::Avx512 => unsafe {
                    avx2 $(::<$p>)? ($($argument),*)
                },
                $crate::processor::Instructions::Portable => $body::<$($p,)? [f64; 2]>($($argument),*),
            }
        }
    };
}
pub(crate) use dispatched;

/// A number that the kernel computes with.
pub(crate) trait Real: nalgebra::RealField + Copy + Default {
    /// Whether it has 53 bits.
    const DOUBLE: bool;
    /// The nearest number.
    fn narrow(value: f64) -> Self;
    /// The same number.
    fn wide(self) -> f64;
}

impl Real for f32 {
    const DOUBLE: bool = false;

    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "single precision is meant")]
    fn narrow(value: f64) -> Self {
        value as Self
    }

    #[inline(always)]
    fn wide(self) -> f64 {
        f64::from(self)
    }
}

impl Real for f64 {
    const DOUBLE: bool = true;

    #[inline(always)]
    fn narrow(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn wide(self) -> f64 {
        self
    }
}

/// A vector of numbers. Except for the portable ones, its functions may only run where its instructions exist.
pub(crate) trait Vector: Copy {
    /// Its numbers.
    type Number: Real;
    /// How many.
    const LANES: usize;
    /// The same number in every lane.
    fn splat(value: Self::Number) -> Self;
    /// The first numbers of a slice that has as many.
    fn load(from: &[Self::Number]) -> Self;
    /// self + other.
    fn add(self, other: Self) -> Self;
    /// self − other.
    fn sub(self, other: Self) -> Self;
    /// self · other.
    fn mul(self, other: Self) -> Self;
    /// self · factor + term, fused where the instructions have it (elsewhere `mul_add` would call a function).
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// The smaller in every lane.
    fn min(self, other: Self) -> Self;
    /// `value` where self is below `bound`, else 0.
    fn select_below(self, bound: Self, value: Self) -> Self;
    /// An estimate of 1/√self, good to 2⁻¹¹ or better; of 0 it may be anything.
    fn estimate_inverse_root(self) -> Self;
    /// The first [`BLOCK`] numbers of a slice less a reference, to the beginning of another.
    fn narrow(from: &[f64], reference: f64, to: &mut [Self::Number]);
    /// Writes the numbers to the beginning of a slice.
    fn write(self, to: &mut [Self::Number]);
    /// The numbers, at the beginning of an array.
    fn store(self) -> [Self::Number; PADDING];

    /// 1/√self to some units in the last place: y (1 + e/2 + 3e²/8 …), e = 1 − x y², from the estimate y.
    #[inline(always)]
    fn inverse_root(self) -> Self {
        let number = |value| Self::splat(Self::Number::narrow(value));
        let (minus_half, half, three_halves) = (number(-0.5), number(0.5), number(1.5));
        let mut y = self.estimate_inverse_root();
        if Self::Number::DOUBLE {
            // Halley's step first: an error of 2⁻³³ then becomes one of round-off.
            let e = self.mul(y).mul(y);
            let e = number(1.0).sub(e);
            y = y.mul(e).mul_add(e.mul_add(number(0.375), half), y);
        }
        let square = self.mul(minus_half).mul(y);
        y.mul(square.mul_add(y, three_halves))
    }

    /// Sum over the lanes.
    #[inline(always)]
    fn total(self) -> f64 {
        halved::<Self>(self.store(), |a, b| a + b)
    }

    /// Smallest of the lanes.
    #[inline(always)]
    fn smallest(self) -> f64 {
        halved::<Self>(self.store(), |a, b| if a < b { a } else { b })
    }
}

/// Joins the upper half of the lanes to the lower one until one is left.
#[inline(always)]
fn halved<V: Vector>(
    mut lanes: [V::Number; PADDING],
    join: impl Fn(V::Number, V::Number) -> V::Number,
) -> f64 {
    let mut half = V::LANES / 2;
    while half > 0 {
        for lane in 0..half {
            lanes[lane] = join(lanes[lane], lanes[lane + half]);
        }
        half /= 2;
    }
    lanes[0].wide()
}

/// Lanes of any processor.
macro_rules! portable {
    ($number:ty, $lanes:literal) => {
        impl Vector for [$number; $lanes] {
            type Number = $number;
            const LANES: usize = $lanes;

            #[inline(always)]
            fn splat(value: $number) -> Self {
                [value; $lanes]
            }
            #[inline(always)]
            fn load(from: &[$number]) -> Self {
                from[..$lanes].try_into().expect("as many numbers as lanes")
            }
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                std::array::from_fn(|lane| self[lane] + other[lane])
            }
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                std::array::from_fn(|lane| self[lane] - other[lane])
            }
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                std::array::from_fn(|lane| self[lane] * other[lane])
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                std::array::from_fn(|lane| self[lane] * factor[lane] + term[lane])
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                std::array::from_fn(|lane| if self[lane] < other[lane] { self[lane] } else { other[lane] })
            }
            #[inline(always)]
            fn select_below(self, bound: Self, value: Self) -> Self {
                std::array::from_fn(|lane| if self[lane] < bound[lane] { value[lane] } else { 0.0 })
            }
            #[inline(always)]
            fn estimate_inverse_root(self) -> Self {
                std::array::from_fn(|lane| 1.0 / self[lane].sqrt())
            }
            #[inline(always)]
            fn narrow(from: &[f64], reference: f64, to: &mut [$number]) {
                let to: &mut [$number; BLOCK] = (&mut to[..BLOCK]).try_into().expect("a block");
                let from: &[f64; BLOCK] = from[..BLOCK].try_into().expect("a block");
                *to = std::array::from_fn(|lane| <$number>::narrow(from[lane] - reference));
            }
            #[inline(always)]
            fn write(self, to: &mut [$number]) {
                to[..$lanes].copy_from_slice(&self);
            }
            #[inline(always)]
            fn store(self) -> [$number; PADDING] {
                let mut values = [0.0; PADDING];
                values[..$lanes].copy_from_slice(&self);
                values
            }
        }
    };
}
portable!(f32, 4);
portable!(f64, 2);

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{BLOCK, PADDING, Vector};
    use std::arch::x86_64::*;

    /// A vector of the processor's from the names of its instructions.
    macro_rules! native {
        ($vector:ty, $number:ty, $lanes:literal, $splat:ident, $load:ident, $store:ident, $add:ident, $sub:ident,
         $mul:ident, $fused:ident, $min:ident, $below:expr, $root:expr, $narrow:ident) => {
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
                fn select_below(self, bound: Self, value: Self) -> Self {
                    // SAFETY: as above.
                    unsafe { $below(self, bound, value) }
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
        |a, bound, value| _mm256_and_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(a, bound), value),
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
        |a, bound, value| _mm256_and_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(a, bound), value),
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
        |a, bound, value| _mm512_maskz_mov_ps(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, bound), value),
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
        |a, bound, value| _mm512_maskz_mov_pd(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, bound), value),
        |a| _mm512_rsqrt14_pd(a),
        double_512
    );
}
