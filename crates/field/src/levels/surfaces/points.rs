//! Elements' charges as points, as p3m takes them.

use super::elements::{Element, Elements};
use crate::levels::walls::Buckets;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Distance between a facet's points over that of the nearest grain, at most: the ripple of a lattice of
/// points a distance d away goes as exp(−2π d/spacing).
const SPACING: f64 = 1.0;
/// Most cuts of a facet: 3·4³ points.
const MOST_CUTS: u8 = 3;
/// Distance of a grain over the largest facet's size beyond which no facet is cut.
const REACH: f64 = 2.5;

/// Points that carry the facets' charges: each third of a facet is cut into 4 pieces `cuts` times, and each
/// piece has a point at its centroid. None lies at the facet's own.
#[derive(Debug, Default)]
pub(super) struct Points {
    cuts: Vec<u8>,
    /// Begin of each facet's points; one more than there are facets.
    first: Vec<u32>,
    pub(super) places: Vec<Vector3<f64>>,
    pub(super) charges: Vec<f64>,
}

impl Points {
    /// Cuts facets as finely as the nearest grains [m] ask for.
    pub(super) fn place(&mut self, elements: &Elements, buckets: &Buckets, grains: &[Vector3<f64>]) {
        let mut nearest = vec![f64::INFINITY; elements.len()];
        for grain in grains {
            for element in buckets.near(grain) {
                nearest[element] = nearest[element].min(elements.all[element].distance_at_least(grain));
            }
        }
        let cuts = |(element, nearest): (&Element, &f64)| {
            let mut cuts = 0;
            while cuts < MOST_CUTS && element.size / number(cuts).sqrt() > SPACING * nearest {
                cuts += 1;
            }
            cuts
        };
        self.cuts.clear();
        self.cuts.extend(elements.all.iter().zip(&nearest).map(cuts));
        self.first.clear();
        self.places.clear();
        for (element, &cuts) in elements.all.iter().zip(&self.cuts) {
            self.first.push(self.places.len() as u32);
            for k in 0..3 {
                let third = [element.centre, element.corners[k], element.corners[(k + 1) % 3]];
                cut(third, cuts, &mut self.places);
            }
        }
        self.first.push(self.places.len() as u32);
    }

    /// Gives the points the charges [C] of a density [C/m²] that is linear on each facet.
    pub(super) fn charge(&mut self, elements: &Elements, density: &[f64]) {
        self.charges.clear();
        self.charges.resize(self.places.len(), 0.0);
        for (number, element) in elements.all.iter().enumerate() {
            let slope = elements.slope(number, density);
            let range = self.of(number);
            let share = element.area / range.len() as f64;
            for point in range {
                let step = self.places[point] - element.centre;
                self.charges[point] = share * (density[number] + slope.dot(&step));
            }
        }
    }

    /// Points of a facet.
    pub(super) fn of(&self, element: usize) -> std::ops::Range<usize> {
        self.first[element] as usize..self.first[element + 1] as usize
    }

    pub(super) fn memory_bytes(&self) -> usize {
        32 * self.places.capacity() + 5 * self.cuts.capacity()
    }
}

/// Buckets in which grains find the facets that they are near.
pub(super) fn buckets_of(elements: &Elements) -> Buckets {
    let largest = elements.all.iter().map(|element| element.size).fold(0.0, f64::max);
    Buckets::new(elements.all.iter().map(|element| &element.centre), REACH * largest)
}

/// Number of points of a facet.
fn number(cuts: u8) -> f64 {
    3.0 * 4.0_f64.powi(i32::from(cuts))
}

/// Appends the centroids of a triangle's pieces.
fn cut([a, b, c]: [Vector3<f64>; 3], cuts: u8, places: &mut Vec<Vector3<f64>>) {
    if cuts == 0 {
        places.push((a + b + c) / 3.0);
        return;
    }
    let (ab, bc, ca) = ((a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0);
    for piece in [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]] {
        cut(piece, cuts - 1, places);
    }
}

/// Potentials at the centroids that even densities of the facets near each one, and of itself, have beyond
/// their points, over Coulomb's constant [C/m].
pub(super) fn shortfall(
    elements: &Elements,
    near: &[Vec<u32>],
    points: &Points,
    density: &[f64],
    entry: impl Fn(usize, usize) -> f64 + Sync,
    shortest: impl Fn(Vector3<f64>) -> Vector3<f64> + Sync,
) -> Vec<f64> {
    let of_element = |at: usize| {
        let centre = elements.all[at].centre;
        let of_other = |&other: &u32| {
            let other = other as usize;
            let copy = centre - elements.all[other].centre;
            let here = elements.all[other].centre + shortest(copy);
            let of_points: f64 =
                points.of(other).map(|k| points.charges[k] / (points.places[k] - here).norm()).sum();
            entry(at, other) * density[other] - of_points
        };
        near[at].iter().map(of_other).sum()
    };
    (0..elements.len()).into_par_iter().map(of_element).collect()
}
