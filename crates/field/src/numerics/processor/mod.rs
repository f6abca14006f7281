//! Vectors of numbers in single or double precision, by the instructions that this processor has.

mod portable;
#[cfg(target_arch = "x86_64")]
mod x86;

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
            let wide = std::arch::is_x86_feature_detected!("avx512f");
            if fused && wide && std::arch::is_x86_feature_detected!("avx2") {
                return Self::Avx512;
            }
            if fused && std::arch::is_x86_feature_detected!("avx2") {
                return Self::Avx2;
            }
        }
        Self::Portable
    }

    /// Returns these instructions, or narrower ones where so few numbers in a row leave half of the lanes
    /// idle.
    pub(crate) fn for_numbers(self, numbers: usize) -> Self {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 if numbers <= 4 => Self::Avx2,
            other => other,
        }
    }
}

/// Compiles a function for every set of instructions, and calls the one of this processor. The function
/// that it is made from has one parameter more, the vector of f64 to compute with; a const parameter `P` is
/// handed on.
macro_rules! dispatched {
    ($(#[$doc:meta])* $visibility:vis fn $name:ident $(<const $p:ident: usize>)?
        ($($argument:ident: $type:ty),* $(,)?)
     $(-> $result:ty)? = $body:ident) => {
        $(#[$doc])*
        #[inline(always)]
        $visibility fn $name $(<const $p: usize>)? (
            instructions: $crate::numerics::processor::Instructions, $($argument: $type),*
        ) $(-> $result)? {
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,fma")]
            fn avx2 $(<const $p: usize>)? ($($argument: $type),*) $(-> $result)? {
                $body::<$($p,)? std::arch::x86_64::__m256d>($($argument),*)
            }
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f,fma")]
            fn avx512 $(<const $p: usize>)? ($($argument: $type),*) $(-> $result)? {
                $body::<$($p,)? std::arch::x86_64::__m512d>($($argument),*)
            }
            match instructions {
                #[cfg(target_arch = "x86_64")]
                // SAFETY: `Instructions::detect` found the instructions on this processor, here and below.
                $crate::numerics::processor::Instructions::Avx512 => unsafe {
                    avx512 $(::<$p>)? ($($argument),*)
                },
                #[cfg(target_arch = "x86_64")]
                // SAFETY: as above.
                $crate::numerics::processor::Instructions::Avx2 => unsafe {
                    avx2 $(::<$p>)? ($($argument),*)
                },
                $crate::numerics::processor::Instructions::Portable => {
                    $body::<$($p,)? [f64; 2]>($($argument),*)
                }
            }
        }
    };
}
pub(crate) use dispatched;

/// A number that the kernel computes with.
pub(crate) trait Real: nalgebra::RealField + Copy + Default {
    /// A vector of them on any processor.
    type Portable: Vector<Number = Self>;
    /// A vector of them in AVX2.
    #[cfg(target_arch = "x86_64")]
    type Avx2: Vector<Number = Self>;
    /// A vector of them in AVX-512.
    #[cfg(target_arch = "x86_64")]
    type Avx512: Vector<Number = Self>;
    /// Whether it has 53 bits.
    const DOUBLE: bool;
    /// The nearest number.
    fn narrow(value: f64) -> Self;
    /// Returns the number in double precision.
    fn wide(self) -> f64;
}

impl Real for f32 {
    type Portable = [Self; 4];
    #[cfg(target_arch = "x86_64")]
    type Avx2 = std::arch::x86_64::__m256;
    #[cfg(target_arch = "x86_64")]
    type Avx512 = std::arch::x86_64::__m512;
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
    type Portable = [Self; 2];
    #[cfg(target_arch = "x86_64")]
    type Avx2 = std::arch::x86_64::__m256d;
    #[cfg(target_arch = "x86_64")]
    type Avx512 = std::arch::x86_64::__m512d;
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

/// A vector of numbers. Except for the portable ones, its functions may only run where its instructions
/// exist.
pub(crate) trait Vector: Copy {
    /// Number in a lane.
    type Number: Real;
    /// Number of lanes.
    const LANES: usize;
    /// Puts one number into every lane.
    fn splat(value: Self::Number) -> Self;
    /// The first numbers of a slice that has as many.
    fn load(from: &[Self::Number]) -> Self;
    /// self + other.
    fn add(self, other: Self) -> Self;
    /// self − other.
    fn sub(self, other: Self) -> Self;
    /// self · other.
    fn mul(self, other: Self) -> Self;
    /// self · factor + term, fused where the instructions have it (elsewhere `mul_add` would call a
    /// function).
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// The smaller in every lane.
    fn min(self, other: Self) -> Self;
    /// The larger in every lane.
    fn max(self, other: Self) -> Self;
    /// `value` where self is below `bound`, else 0.
    fn select_below(self, bound: Self, value: Self) -> Self;
    /// Mask of the lanes below `bound`, the first in the lowest bit.
    fn below(self, bound: Self) -> u32;
    /// Writes the lanes of a mask one after another to the beginning of a slice with room for all lanes;
    /// what lies behind the last of them is lost.
    fn pack(self, lanes: u32, to: &mut [Self::Number]);
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
