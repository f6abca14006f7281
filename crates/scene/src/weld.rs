//! Vertices of a surface that are one place.

use nalgebra::Vector3;
use std::collections::HashMap;

/// Distance below which vertices are one, over the largest coordinate: the last digits of text.
const SAME_VERTEX: f64 = 1e-9;

/// Vertices so far, each place once.
#[derive(Debug)]
pub(crate) struct Weld {
    apart: f64,
    pub(crate) vertices: Vec<Vector3<f64>>,
    exact: HashMap<[u64; 3], u32>,
    cells: HashMap<[i64; 3], Vec<u32>>,
}

impl Weld {
    /// Vertices among places whose largest coordinate has this size [m].
    pub(crate) fn new(largest: f64) -> Self {
        let apart = SAME_VERTEX * largest;
        Self { apart, vertices: Vec::new(), exact: HashMap::new(), cells: HashMap::new() }
    }

    /// Number of the vertex at a place [m].
    pub(crate) fn number(&mut self, place: Vector3<f64>) -> u32 {
        // −0 and 0 differ in their bits; adding zero makes them the same vertex.
        let bits = [place.x + 0.0, place.y + 0.0, place.z + 0.0].map(f64::to_bits);
        if let Some(&known) = self.exact.get(&bits) {
            return known;
        }
        let number = self.near(place).unwrap_or_else(|| self.push(place));
        self.exact.insert(bits, number);
        number
    }

    fn cell(&self, place: Vector3<f64>) -> [i64; 3] {
        #[expect(clippy::cast_possible_truncation, reason = "at most 1e9 cells from the origin")]
        let along = |axis: usize| (place[axis] / self.apart).floor() as i64;
        [0, 1, 2].map(along)
    }

    fn near(&self, place: Vector3<f64>) -> Option<u32> {
        let [x, y, z] = self.cell(place);
        let cells = (0..27).map(|n| [x + n / 9 - 1, y + n / 3 % 3 - 1, z + n % 3 - 1]);
        let mut known = cells.filter_map(|cell| self.cells.get(&cell)).flatten();
        known.find(|&&known| (self.vertices[known as usize] - place).norm() <= self.apart).copied()
    }

    fn push(&mut self, place: Vector3<f64>) -> u32 {
        let number = u32::try_from(self.vertices.len()).unwrap_or(u32::MAX);
        self.vertices.push(place);
        self.cells.entry(self.cell(place)).or_default().push(number);
        number
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn last_digits_do_not_part_vertices() {
        let mut weld = Weld::new(0.1);
        let at = |x: f64| Vector3::new(x, -0.1, 0.0);
        let first = weld.number(at(0.099_999_999_99));
        assert_eq!(weld.number(at(0.1)), first);
        assert_eq!(weld.number(at(0.100_000_000_05)), first);
        assert_ne!(weld.number(at(0.100_000_01)), first);
        assert_eq!(weld.vertices.len(), 2);
    }
}
