//! Random packings of spheres.

use crate::foam_case::Random;
use std::collections::HashMap;
use std::f64::consts::PI;

/// Rounds in which spheres push each other apart.
const ROUNDS: usize = 400;
/// Part of an overlap that a round takes away: a sphere in a packing has several.
const PUSH: f64 = 0.7;

/// Spheres packed at random between the bottom, the top and the mantle of a cylinder around the z axis.
pub struct Packing {
    /// Centres [m].
    pub places: Vec<[f64; 3]>,
    /// Deepest overlap that is left, over the diameter.
    pub overlap: f64,
}

impl Packing {
    /// Packs spheres of a diameter into a cylinder of a radius and a height, all in m: spheres at random
    /// places push each other apart.
    #[must_use]
    pub fn new(count: usize, diameter: f64, radius: f64, height: f64) -> Self {
        let (mut random, half) = (Random(3), 0.5 * diameter);
        let mut place = |_| {
            let (r, angle) = ((radius - half) * random.number().sqrt(), 2.0 * PI * random.number());
            [r * angle.cos(), r * angle.sin(), half + (height - diameter) * random.number()]
        };
        let mut packing = Self { places: (0..count).map(&mut place).collect(), overlap: 1.0 };
        for _ in 0..ROUNDS {
            packing.push_apart(diameter);
            for [x, y, z] in &mut packing.places {
                let r = x.hypot(*y);
                let inside = (radius - half).min(r) / r.max(f64::MIN_POSITIVE);
                (*x, *y, *z) = (*x * inside, *y * inside, z.clamp(half, height - half));
            }
        }
        packing
    }

    /// Moves every sphere out of its neighbours.
    fn push_apart(&mut self, diameter: f64) {
        let cell = |place: &[f64; 3]| place.map(|x| (x / diameter).floor() as i32);
        let mut cells: HashMap<[i32; 3], Vec<usize>> = HashMap::new();
        for (i, place) in self.places.iter().enumerate() {
            cells.entry(cell(place)).or_default().push(i);
        }
        let mut moved = self.places.clone();
        self.overlap = 0.0;
        for (i, here) in self.places.iter().enumerate() {
            let middle = cell(here);
            for step in 0..27 {
                let beside = [step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1];
                let near = [0, 1, 2].map(|axis| middle[axis] + beside[axis]);
                for &other in cells.get(&near).into_iter().flatten().filter(|other| **other != i) {
                    let away = [0, 1, 2].map(|axis| here[axis] - self.places[other][axis]);
                    let distance = away.iter().map(|x| x * x).sum::<f64>().sqrt();
                    if distance < diameter {
                        self.overlap = self.overlap.max(1.0 - distance / diameter);
                        let push = 0.5 * PUSH * (diameter - distance) / distance;
                        (0..3).for_each(|axis| moved[i][axis] += push * away[axis]);
                    }
                }
            }
        }
        self.places = moved;
    }
}
