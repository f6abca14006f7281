//! Arrays as vectors: for any processor.

use super::{BLOCK, PADDING, Real, Vector};

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
            fn max(self, other: Self) -> Self {
                std::array::from_fn(|lane| if self[lane] > other[lane] { self[lane] } else { other[lane] })
            }
            #[inline(always)]
            fn below(self, bound: Self) -> u32 {
                (0..$lanes).fold(0, |lanes, lane| lanes | u32::from(self[lane] < bound[lane]) << lane)
            }
            #[inline(always)]
            fn pack(self, lanes: u32, to: &mut [$number]) {
                let mut next = 0;
                for lane in 0..$lanes {
                    if lanes & 1 << lane != 0 {
                        to[next] = self[lane];
                        next += 1;
                    }
                }
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
