//! A target's sums over candidates, all in lanes.

use super::candidates::NearSources;
use crate::numerics::processor::{Real, Vector};
use crate::values::FieldAt;

/// Field (x, y, z) and potential of a target in the kernel's units (4πε = 1), and the square of the
/// distance to the nearest candidate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct NearSum {
    pub(crate) field: [f64; 3],
    pub(crate) potential: f64,
    pub(crate) nearest_squared: f64,
}

impl NearSum {
    /// Field and potential without the distance.
    pub(super) fn field_at(&self) -> FieldAt {
        FieldAt { e: self.field.into(), potential: self.potential }
    }
}

/// Polynomials for field and potential.
pub(super) type Polynomials<'a, T, const N: usize> = (&'a [T; N], &'a [T; N]);

/// A target and its sums, candidate by candidate in lanes. Spelled out axis by axis: vectors in arrays end
/// in memory.
struct Target<V> {
    x: V,
    y: V,
    z: V,
    ex: V,
    ey: V,
    ez: V,
    potential: V,
    nearest: V,
}

impl<V: Vector> Target<V> {
    #[inline(always)]
    fn new([x, y, z]: [V::Number; 3]) -> Self {
        let (x, y, z) = (V::splat(x), V::splat(y), V::splat(z));
        let number = |value| V::splat(V::Number::narrow(value));
        let (zero, nearest) = (number(0.0), number(2.0));
        Self { x, y, z, ex: zero, ey: zero, ez: zero, potential: zero, nearest }
    }

    /// Adds the terms of candidates, the squares of whose distances are increased by `apart`.
    #[inline(always)]
    fn add<const N: usize, const POTENTIAL: bool>(
        &mut self,
        (field, potential): Polynomials<'_, V::Number, N>,
        [x, y, z, charge]: [V; 4],
        apart: V,
    ) {
        let number = |value| V::splat(V::Number::narrow(value));
        let (dx, dy, dz) = (self.x.sub(x), self.y.sub(y), self.z.sub(z));
        let r2 = dx.mul_add(dx, dy.mul_add(dy, dz.mul_add(dz, apart)));
        self.nearest = self.nearest.min(r2);
        let inverse = r2.inverse_root();
        let argument = r2.mul_add(number(2.0), number(-1.0));
        let point = inverse.mul(inverse).mul(inverse);
        let weight = charge.mul(point.sub(horner(field, argument)));
        let weight = r2.select_below(number(1.0), weight);
        self.ex = weight.mul_add(dx, self.ex);
        self.ey = weight.mul_add(dy, self.ey);
        self.ez = weight.mul_add(dz, self.ez);
        if POTENTIAL {
            let value = charge.mul(inverse.sub(horner(potential, argument)));
            self.potential = self.potential.add(r2.select_below(number(1.0), value));
        }
    }

    #[inline(always)]
    fn sum(&self) -> NearSum {
        NearSum {
            field: [self.ex.total(), self.ey.total(), self.ez.total()],
            potential: self.potential.total(),
            nearest_squared: self.nearest.smallest(),
        }
    }
}

/// Place at which a sum is taken, and the candidate there that does not count: [`NearSources::len`] if there
/// is none.
pub(super) type Place<T> = ([T; 3], usize);

/// Sums at a place.
#[inline(always)]
pub(super) fn sum_one<V: Vector, const N: usize, const POTENTIAL: bool>(
    polynomials: Polynomials<'_, V::Number, N>,
    candidates: &NearSources<V::Number>,
    (place, own): Place<V::Number>,
) -> NearSum {
    let mut target = Target::<V>::new(place);
    let apart = candidates.apart(own);
    for at in (0..candidates.len()).step_by(V::LANES) {
        target.add::<N, POTENTIAL>(polynomials, candidates.load::<V>(at), V::load(&apart[at..]));
    }
    target.sum()
}

/// Two targets side by side: their chains of operations fill each other's waiting times, and loads are
/// shared.
#[inline(always)]
pub(super) fn sum_two<V: Vector, const N: usize, const POTENTIAL: bool>(
    polynomials: Polynomials<'_, V::Number, N>,
    candidates: &NearSources<V::Number>,
    [(place_one, first), (place_two, second)]: [Place<V::Number>; 2],
) -> [NearSum; 2] {
    let mut one = Target::<V>::new(place_one);
    let mut two = Target::<V>::new(place_two);
    let (apart_one, apart_two) = (candidates.apart(first), candidates.apart(second));
    for at in (0..candidates.len()).step_by(V::LANES) {
        let some = candidates.load::<V>(at);
        one.add::<N, POTENTIAL>(polynomials, some, V::load(&apart_one[at..]));
        two.add::<N, POTENTIAL>(polynomials, some, V::load(&apart_two[at..]));
    }
    [one.sum(), two.sum()]
}

/// Polynomial in every lane, highest power last in `coefficients`.
#[inline(always)]
fn horner<V: Vector, const N: usize>(coefficients: &[V::Number; N], argument: V) -> V {
    let mut value = V::splat(coefficients[N - 1]);
    for power in (0..N - 1).rev() {
        value = value.mul_add(argument, V::splat(coefficients[power]));
    }
    value
}
