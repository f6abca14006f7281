//! Places in buckets, to find those near a point.

use nalgebra::Vector3;
use std::ops::Range;

/// Buckets for each place at most, and besides.
const FOR_EACH: usize = 4;
const BESIDES: usize = 64;
/// Factor by which buckets grow until they are few enough.
const LARGER: f64 = 1.25;

/// Places by their bucket.
#[derive(Clone, Debug, Default)]
pub(crate) struct Buckets {
    low: Vector3<f64>,
    edge: f64,
    reach: f64,
    /// Buckets around a point's own in which a search looks.
    rings: i64,
    counts: [i64; 3],
    /// Begin of each bucket in `numbers`; one more than there are buckets.
    first: Vec<u32>,
    numbers: Vec<u32>,
}

impl Buckets {
    /// Puts places [m] into buckets; a search finds at least those up to `reach` [m] away.
    pub(crate) fn new<'a>(places: impl Iterator<Item = &'a Vector3<f64>> + Clone, reach: f64) -> Self {
        Self::with_rings(places, reach, 1)
    }

    /// Puts places [m] into buckets whose edge is a part of `reach` [m], so that a search looks at less.
    pub(crate) fn with_rings<'a>(
        places: impl Iterator<Item = &'a Vector3<f64>> + Clone,
        reach: f64,
        rings: u32,
    ) -> Self {
        let count = places.clone().count();
        let Some(first) = places.clone().next() else { return Self::default() };
        let (low, high) = places.clone().fold((*first, *first), |(low, high), x| (low.inf(x), high.sup(x)));
        let mut edge = reach / f64::from(rings);
        let number_of = |edge: f64| (high - low).map(|extent| (extent / edge).floor() + 1.0);
        while number_of(edge).product() > (FOR_EACH * count + BESIDES) as f64 {
            edge *= LARGER;
        }
        #[expect(clippy::cast_possible_truncation, reason = "few buckets, see above")]
        let counts: [i64; 3] = number_of(edge).map(|number| number as i64).into();
        #[expect(clippy::cast_possible_truncation, reason = "at most `rings`")]
        let rings = (reach / edge).ceil() as i64;
        let buckets = counts.iter().product::<i64>() as usize;
        let mut sorted =
            Self { low, edge, reach, rings, counts, first: vec![0; buckets + 1], numbers: vec![0; count] };
        for place in places.clone() {
            let bucket = sorted.row(sorted.bucket(place));
            sorted.first[bucket + 1] += 1;
        }
        for bucket in 0..buckets {
            sorted.first[bucket + 1] += sorted.first[bucket];
        }
        let mut next = sorted.first.clone();
        for (number, place) in places.enumerate() {
            let bucket = sorted.row(sorted.bucket(place));
            sorted.numbers[next[bucket] as usize] = number as u32;
            next[bucket] += 1;
        }
        sorted
    }

    /// Numbers of the places in the buckets around a point.
    pub(crate) fn near(&self, point: &Vector3<f64>) -> impl Iterator<Item = usize> + '_ {
        self.rows(point).flat_map(|row| self.numbers[row].iter().map(|&number| number as usize))
    }

    /// Ranges of [`Self::order`] in which the places in the buckets around a point stand.
    pub(crate) fn rows(&self, point: &Vector3<f64>) -> impl Iterator<Item = Range<usize>> + '_ {
        let here = self.bucket(point);
        let from = here.map(|place| (place - self.rings).max(0));
        let to: [i64; 3] = std::array::from_fn(|axis| (here[axis] + self.rings).min(self.counts[axis] - 1));
        let columns = (from[0]..=to[0]).flat_map(move |x| (from[1]..=to[1]).map(move |y| [x, y]));
        columns.filter(move |_| from[2] <= to[2]).map(move |[x, y]| {
            let [begin, end] = [from[2], to[2]].map(|z| self.row([x, y, z]));
            self.first[begin] as usize..self.first[end + 1] as usize
        })
    }

    /// Numbers of all places, bucket by bucket.
    pub(crate) fn order(&self) -> &[u32] {
        &self.numbers
    }

    /// Distance up to which a search finds every place [m].
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }

    fn row(&self, [x, y, z]: [i64; 3]) -> usize {
        ((x * self.counts[1] + y) * self.counts[2] + z) as usize
    }

    /// Bucket of a point; one far outside is still outside.
    fn bucket(&self, point: &Vector3<f64>) -> [i64; 3] {
        /// Buckets beyond which a point is far outside.
        const FAR: f64 = 1e9;
        #[expect(clippy::cast_possible_truncation, reason = "clamped")]
        let index =
            |axis: usize| ((point[axis] - self.low[axis]) / self.edge).floor().clamp(-FAR, FAR) as i64;
        std::array::from_fn(index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn search_finds_every_place_within_reach() {
        let places: Vec<Vector3<f64>> = (0..500_u32)
            .map(|number| Vector3::new(0.37, 0.73, 0.59) * f64::from(number))
            .map(|place| place.map(f64::fract).component_mul(&Vector3::new(3.0, 1.0, 0.2)))
            .collect();
        for (reach, rings) in [(0.05, 1), (0.3, 1), (0.3, 2), (5.0, 3)] {
            let buckets = Buckets::with_rings(places.iter(), reach, rings);
            for point in places.iter().step_by(7).map(|place| place * 1.1) {
                let near: Vec<usize> = buckets.near(&point).collect();
                for (number, place) in places.iter().enumerate() {
                    let times = near.iter().filter(|other| **other == number).count();
                    let expected = usize::from((place - point).norm() <= reach);
                    assert!(times >= expected && times <= 1, "{reach} {rings} {point} {place}");
                }
            }
        }
        assert_eq!(Buckets::new([].iter(), 1.0).near(&Vector3::zeros()).count(), 0);
    }
}
