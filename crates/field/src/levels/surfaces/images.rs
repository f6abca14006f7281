//! Images of the grains in the surfaces.

use super::elements::Elements;
use crate::levels::walls::{Buckets, FacetImages, FacetSide, FacetWalls};
use amberfield_core::{Axis, Boundary, Domain, Side};
use nalgebra::Vector3;
use std::cell::Cell;

/// Distance over a facet's size up to which grains are looked for on its sides.
const LOOK: f64 = 2.0;
/// Cosine of the angle between two facets up to which they are one sheet, and difference of a grain's heights
/// above them over their size.
const ALIKE: f64 = 0.5;
const LEVEL: f64 = 0.5;

/// Images of the grains that are near a surface.
#[derive(Debug)]
pub(super) struct SurfaceImages {
    walls: FacetWalls,
    /// Box that no image may leave, where its faces have images of their own; endless elsewhere.
    low: Vector3<f64>,
    high: Vector3<f64>,
    /// Whether there are grains on the side of each facet to which its normal points, and on the other.
    occupied: Vec<[bool; 2]>,
    pub(super) places: Vec<Vector3<f64>>,
    pub(super) charges: Vec<f64>,
    /// Charge of the images in each conductor [C].
    pub(super) of_conductor: Vec<f64>,
}

impl SurfaceImages {
    /// Images in walls that so many conductors in a box have.
    pub(super) fn new(walls: FacetWalls, domain: &Domain, conductors: usize) -> Self {
        let (mut low, mut high) = (Vector3::repeat(f64::NEG_INFINITY), Vector3::repeat(f64::INFINITY));
        for axis in Axis::ALL.into_iter().filter(|axis| !domain.is_periodic(*axis)) {
            let k = axis.index();
            if domain.face(axis, Side::Min) != Boundary::Open {
                low[k] = domain.min()[k];
            }
            if domain.face(axis, Side::Max) != Boundary::Open {
                high[k] = domain.max()[k];
            }
        }
        Self {
            walls,
            low,
            high,
            occupied: Vec::new(),
            places: Vec::new(),
            charges: Vec::new(),
            of_conductor: vec![0.0; conductors],
        }
    }

    /// Depth up to which images can lie behind the facets [m].
    pub(super) fn deepest(&self) -> f64 {
        self.walls.deepest()
    }

    /// Finds the images of grains at these places [m] with these charges [C]. A side of a facet mirrors if
    /// there are no grains behind it.
    pub(super) fn find(
        &mut self,
        elements: &Elements,
        buckets: &Buckets,
        grains: &[Vector3<f64>],
        charges: &[f64],
    ) {
        self.look(elements, buckets, grains);
        self.places.clear();
        self.charges.clear();
        self.of_conductor.fill(0.0);
        let mut found = FacetImages::default();
        let conductor = Cell::new(0);
        for (grain, &charge) in grains.iter().zip(charges).filter(|(_, charge)| **charge != 0.0) {
            let is_allowed = |FacetSide { facet, is_front }: FacetSide| {
                conductor.set(elements.all[facet].conductor as usize);
                !self.occupied[facet][usize::from(is_front)]
            };
            for (place, charge) in self.walls.plain_images(grain, charge, is_allowed, &mut found) {
                if (0..3).all(|axis| place[axis] >= self.low[axis] && place[axis] <= self.high[axis]) {
                    self.places.push(place);
                    self.charges.push(charge);
                    self.of_conductor[conductor.get()] += charge;
                }
            }
        }
    }

    /// Looks on which sides of the facets there are grains: of those that go on from the facet nearest to a
    /// grain it is on the same side.
    fn look(&mut self, elements: &Elements, buckets: &Buckets, grains: &[Vector3<f64>]) {
        self.occupied.clear();
        self.occupied.resize(elements.len(), [false; 2]);
        for grain in grains {
            let distance = |number: usize| elements.all[number].distance_at_least(grain);
            let near = buckets.near(grain);
            let Some(nearest) = near.min_by(|a, b| distance(*a).total_cmp(&distance(*b)).then(a.cmp(b)))
            else {
                continue;
            };
            let below = &elements.all[nearest];
            let above = below.normal.dot(&(grain - below.centre));
            for number in buckets.near(grain) {
                let element = &elements.all[number];
                let apart = grain - element.centre;
                let height = element.normal.dot(&apart);
                let turned = element.normal.dot(&below.normal);
                let goes_on =
                    turned.abs() > ALIKE && (height.abs() - above.abs()).abs() < LEVEL * element.size;
                if goes_on && apart.norm() < LOOK * element.size + above.abs() {
                    self.occupied[number][usize::from(above * turned < 0.0)] = true;
                }
            }
        }
    }
}
