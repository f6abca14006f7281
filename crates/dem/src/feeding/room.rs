//! Room between the loose grains in and around a region.

use crate::contacts::loose::GAP;
use amberfield_core::{Axis, Domain, Vector3};
use std::collections::HashMap;

/// Loose grains in and around a region, by cells.
pub(super) struct Room<'a> {
    domain: &'a Domain,
    low: Vector3<f64>,
    high: Vector3<f64>,
    /// Edge of a cell, the largest distance of centres that is asked for [m].
    edge: f64,
    cells: HashMap<[i64; 3], Vec<[f64; 4]>>,
}

impl<'a> Room<'a> {
    /// Empty room around a region between two corners [m], in a scene with grains up to a radius [m] and
    /// gaps up to `gap` [m].
    pub(super) fn new(domain: &'a Domain, [low, high]: [Vector3<f64>; 2], largest: f64, gap: f64) -> Self {
        // Grains that came through a face stand off it by a radius.
        let beyond = Vector3::repeat(4.0 * largest + gap);
        let (low, high) = (low - beyond, high + beyond);
        Self { domain, low, high, edge: 2.0 * largest + gap, cells: HashMap::new() }
    }

    /// Adds a grain with its images, where they are near the region.
    pub(super) fn add(&mut self, centre: [f64; 4]) {
        let [x, y, z, radius] = centre;
        let place = Vector3::new(x, y, z);
        if self.is_far(&place) {
            return;
        }
        let place = self.domain.wrap(place);
        let extent = self.domain.extent();
        let periods = Axis::ALL.map(|axis| if self.domain.is_periodic(axis) { -1..=1 } else { 0..=0 });
        for a in periods[0].clone() {
            for b in periods[1].clone() {
                for c in periods[2].clone() {
                    let shift = Vector3::new(f64::from(a), f64::from(b), f64::from(c));
                    let image = place + shift.component_mul(&extent);
                    if (0..3).all(|k| image[k] >= self.low[k] && image[k] <= self.high[k]) {
                        let cell = self.cell(&image);
                        self.cells.entry(cell).or_default().push([image.x, image.y, image.z, radius]);
                    }
                }
            }
        }
    }

    /// Whether no image of a place [m] is near the region: the nearest along each axis is not.
    fn is_far(&self, place: &Vector3<f64>) -> bool {
        /// Reach over the region's half, for round-off.
        const REACH: f64 = 1.0 + 1e-9;
        let half = (self.high - self.low) * (0.5 * REACH);
        let away = self.domain.shortest(place - (self.low + self.high) * 0.5);
        (0..3).any(|axis| away[axis].abs() > half[axis])
    }

    fn cell(&self, place: &Vector3<f64>) -> [i64; 3] {
        [0, 1, 2].map(|axis| ((place[axis] - self.low[axis]) / self.edge).floor() as i64)
    }

    /// Whether a grain of a radius [m] touches no other at a place [m], and leaves a gap [m] to all.
    pub(super) fn is_free(&self, place: &Vector3<f64>, radius: f64, gap: f64) -> bool {
        let [x, y, z] = self.cell(place);
        (0..27).all(|code| {
            let cell = [x + code / 9 - 1, y + code / 3 % 3 - 1, z + code % 3 - 1];
            self.cells.get(&cell).is_none_or(|others| {
                others.iter().all(|&[x, y, z, other]| {
                    let apart = (radius + other) * (1.0 + GAP) + gap;
                    (Vector3::new(x, y, z) - place).norm_squared() >= apart * apart
                })
            })
        })
    }
}
