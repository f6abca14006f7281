//! Places in buckets, to find those near a point.

use nalgebra::Vector3;
use std::collections::HashMap;

/// Places by their bucket.
#[derive(Debug, Default)]
pub(super) struct Buckets {
    edge: f64,
    numbers: HashMap<[i64; 3], Vec<u32>>,
}

impl Buckets {
    /// Puts places [m] into buckets; a search finds at least those up to `reach` [m] away.
    pub(super) fn new<'a>(places: impl Iterator<Item = &'a Vector3<f64>>, reach: f64) -> Self {
        let mut buckets = Self { edge: reach, numbers: HashMap::new() };
        for (number, place) in places.enumerate() {
            let bucket = buckets.bucket(place);
            buckets.numbers.entry(bucket).or_default().push(number as u32);
        }
        buckets
    }

    /// Numbers of the places in the buckets around a point.
    pub(super) fn near(&self, point: &Vector3<f64>) -> impl Iterator<Item = usize> + '_ {
        let [x, y, z] = self.bucket(point);
        let around = (-1..=1)
            .flat_map(move |i| (-1..=1).flat_map(move |j| (-1..=1).map(move |k| [x + i, y + j, z + k])));
        around.filter_map(|place| self.numbers.get(&place)).flatten().map(|&number| number as usize)
    }

    /// Distance up to which a search finds every place [m].
    pub(super) fn reach(&self) -> f64 {
        self.edge
    }

    fn bucket(&self, point: &Vector3<f64>) -> [i64; 3] {
        #[expect(clippy::cast_possible_truncation, reason = "a mesh has not so many buckets")]
        let index = |x: f64| (x / self.edge).floor() as i64;
        [index(point.x), index(point.y), index(point.z)]
    }
}
