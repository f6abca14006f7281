//! Charge of walls by facet: squares of a plane, or parts of a mesh's triangles, about as large as the
//! largest grain.
//!
//! A facet exists once something has charged it. Facets of insulating walls keep their charge, which acts as
//! a point charge a little before the facet, towards the grains: a facet is as wide as a grain, and is seen
//! from a radius away at least. Facets of grounded walls book what flowed off there.

use super::inside;
use crate::contacts::walls::Surface;
use amberfield_core::{Domain, Vector3, WallCharging};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Distance of a facet's point charge from the facet, over its width.
const BEFORE: f64 = 0.25;
/// Facets whose charges act this close to each other, over their width, are one.
const SAME: f64 = 0.1;

/// A facet that has been charged.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Facet {
    /// Wall, by its number.
    pub wall: u32,
    /// Corners in order [m]; the last is the third of a triangle.
    pub corners: [Vector3<f64>; 4],
    /// Area [m²].
    pub area_m2: f64,
    /// Charge that it holds, or that flowed off there [C].
    pub charge: f64,
    /// Place where its charge acts [m]; `None` where it has flowed off.
    pub(super) place: Option<Vector3<f64>>,
}

/// Place on a wall at which charge moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    /// Wall, by its number.
    pub(super) wall: u32,
    pub(super) charging: WallCharging,
    pub(super) surface: Surface,
    /// Place on the surface [m].
    pub(super) place: Vector3<f64>,
    /// Direction from the wall to the grain.
    pub(super) inward: Vector3<f64>,
}

/// All facets.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Facets {
    width: f64,
    facets: Vec<Facet>,
    numbers: BTreeMap<(u32, [i64; 2]), u32>,
}

impl Facets {
    /// Facets about as wide as the largest grain, of this radius [m].
    pub(super) fn new(largest_radius: f64) -> Self {
        Self { width: 2.0 * largest_radius, ..Self::default() }
    }

    pub(super) fn all(&self) -> &[Facet] {
        &self.facets
    }

    pub(super) fn get(&self, number: u32) -> &Facet {
        &self.facets[number as usize]
    }

    pub(super) fn get_mut(&mut self, number: u32) -> &mut Facet {
        &mut self.facets[number as usize]
    }

    /// Number of the facet at a place on a wall; it begins to exist where it did not.
    pub(super) fn at(&mut self, domain: &Domain, spot: Spot) -> u32 {
        let Spot { wall, charging, surface, place, inward } = spot;
        let (key, corners) = self.parted(surface, place);
        if let Some(&known) = self.numbers.get(&(wall, key)) {
            return known;
        }
        let [a, b, c, d] = corners;
        let area = 0.5 * ((b - a).cross(&(c - a)).norm() + (c - a).cross(&(d - a)).norm());
        let centre = if c == d { (a + b + c) / 3.0 } else { 0.25 * (a + b + c + d) };
        let acts = inside(domain, centre + inward * (BEFORE * area.sqrt()));
        // A cell of a plane that reaches across a periodic face is met again as its image on the other side,
        // under another key.
        let same = |facet: &Facet| facet.place.is_some_and(|place| (place - acts).norm() < SAME * self.width);
        if let Some(known) = self.facets.iter().position(|facet| facet.wall == wall && same(facet)) {
            self.numbers.insert((wall, key), known as u32);
            return known as u32;
        }
        let place = (charging == WallCharging::Insulating).then_some(acts);
        let number = self.facets.len() as u32;
        self.facets.push(Facet { wall, corners, area_m2: area, charge: 0.0, place });
        self.numbers.insert((wall, key), number);
        number
    }

    /// The facet of a wall at a place on it [m], if it has been charged.
    pub(super) fn known(&self, wall: u32, surface: Surface, place: Vector3<f64>) -> Option<&Facet> {
        let (key, _) = self.parted(surface, place);
        self.numbers.get(&(wall, key)).map(|&number| self.get(number))
    }

    fn parted(&self, surface: Surface, place: Vector3<f64>) -> ([i64; 2], [Vector3<f64>; 4]) {
        match surface {
            Surface::Plane { point, normal } => self.cell(point, normal, place),
            Surface::Triangle { number, corners } => self.part(number, corners, place),
        }
    }

    /// A square of a plane.
    fn cell(
        &self,
        point: Vector3<f64>,
        normal: Vector3<f64>,
        place: Vector3<f64>,
    ) -> ([i64; 2], [Vector3<f64>; 4]) {
        let least = normal.iamin();
        let u = normal.cross(&Vector3::ith(least, 1.0)).normalize();
        let v = normal.cross(&u);
        let key = [u, v].map(|axis| ((place - point).dot(&axis) / self.width).floor() as i64);
        let corner =
            |a: i64, b: i64| point + (u * (key[0] + a) as f64 + v * (key[1] + b) as f64) * self.width;
        (key, [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)])
    }

    /// A part of a triangle whose edges are cut into equal pieces.
    fn part(
        &self,
        number: u32,
        [a, b, c]: [Vector3<f64>; 3],
        place: Vector3<f64>,
    ) -> ([i64; 2], [Vector3<f64>; 4]) {
        let (ab, ac, at) = (b - a, c - a, place - a);
        let longest = [ab, ac, c - b].iter().map(Vector3::norm).fold(0.0, f64::max);
        let pieces = (longest / self.width).ceil().max(1.0);
        let (bb, bc, cc) = (ab.norm_squared(), ab.dot(&ac), ac.norm_squared());
        let (pb, pc) = (at.dot(&ab), at.dot(&ac));
        let det = bb * cc - bc * bc;
        let s = ((cc * pb - bc * pc) / det).clamp(0.0, 1.0) * pieces;
        let t = ((bb * pc - bc * pb) / det).clamp(0.0, 1.0) * pieces;
        let (mut i, mut j) = (s.floor().min(pieces - 1.0), t.floor().min(pieces - 1.0));
        if i + j > pieces - 1.0 {
            (i, j) = if s.fract() > t.fract() { (i, pieces - 1.0 - i) } else { (pieces - 1.0 - j, j) };
        }
        let upper = s - i + t - j > 1.0 && i + j < pieces - 1.0;
        let corner = |s: f64, t: f64| a + (ab * s + ac * t) / pieces;
        let third = if upper { corner(i + 1.0, j + 1.0) } else { corner(i, j) };
        let corners = [third, corner(i + 1.0, j), corner(i, j + 1.0), corner(i, j + 1.0)];
        let inside = 2.0 * (i * pieces + j) + f64::from(u8::from(upper));
        ([i64::from(number), inside as i64], corners)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::Boundary;

    #[test]
    fn parts_of_a_triangle_are_equal_and_hold_their_places() {
        let domain =
            Domain::new(Vector3::repeat(-9.0), Vector3::repeat(9.0), [[Boundary::Open; 2]; 3]).unwrap();
        let corners = [Vector3::zeros(), Vector3::new(4.0, 0.0, 0.0), Vector3::new(1.0, 3.0, 0.0)];
        let mut facets = Facets::new(0.5);
        let at = |surface: Surface, place: Vector3<f64>| Spot {
            wall: 0,
            charging: WallCharging::Insulating,
            surface,
            place,
            inward: Vector3::z(),
        };
        for s in 0..40 {
            for t in 0..40 - s {
                let share = |x: i32| (f64::from(x) + 0.31) / 41.0;
                let place = corners[1] * share(s) + corners[2] * share(t);
                let surface = Surface::Triangle { number: 7, corners };
                let number = facets.at(&domain, at(surface, place));
                let [a, b, c, _] = facets.all()[number as usize].corners;
                let area =
                    |p: Vector3<f64>, q: Vector3<f64>, r: Vector3<f64>| 0.5 * (q - p).cross(&(r - p)).norm();
                let parts = area(place, b, c) + area(a, place, c) + area(a, b, place);
                assert!((parts - area(a, b, c)).abs() < 1e-12, "{place}");
            }
        }
        // Edges up to √(9+9): five pieces of each.
        assert_eq!(facets.all().len(), 25);
        let whole: f64 = facets.all().iter().map(|facet| facet.area_m2).sum();
        assert!((whole - 6.0).abs() < 1e-12);
        assert!(facets.all().iter().all(|facet| facet.place.is_some_and(|place| place.z > 0.0)));
    }

    #[test]
    fn cell_across_a_period_is_one_with_its_image() {
        let faces = [[Boundary::Periodic; 2], [Boundary::Open; 2], [Boundary::Open; 2]];
        let domain = Domain::new(Vector3::repeat(-1.5), Vector3::repeat(1.5), faces).unwrap();
        let mut facets = Facets::new(0.5);
        let surface = Surface::Plane { point: Vector3::zeros(), normal: Vector3::z() };
        let mut at = |x: f64| {
            let place = Vector3::new(x, 0.7, 0.0);
            let charging = WallCharging::Insulating;
            facets.at(&domain, Spot { wall: 0, charging, surface, place, inward: Vector3::z() })
        };
        // Cells from −2 to −1 and from 1 to 2 are the same.
        assert_eq!(at(1.4), at(-1.4));
        assert_ne!(at(0.1), at(1.4));
    }

    #[test]
    fn cells_of_a_plane_tile_it() {
        let domain =
            Domain::new(Vector3::repeat(-9.0), Vector3::repeat(9.0), [[Boundary::Open; 2]; 3]).unwrap();
        let mut facets = Facets::new(0.5);
        let surface = Surface::Plane { point: Vector3::zeros(), normal: Vector3::z() };
        let mut at = |x: f64, y: f64| {
            let place = Vector3::new(x, y, 0.0);
            let charging = WallCharging::Grounded;
            facets.at(&domain, Spot { wall: 1, charging, surface, place, inward: Vector3::z() })
        };
        assert_eq!(at(0.2, 0.2), at(0.8, 0.9));
        assert_ne!(at(0.2, 0.2), at(-0.2, 0.2));
        assert!((facets.all()[0].area_m2 - 1.0).abs() < 1e-15 && facets.all()[0].place.is_none());
    }
}
