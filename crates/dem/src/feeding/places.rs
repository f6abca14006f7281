//! Places in the region of a feed: at random and on a lattice, the same ones in every run.

use crate::contacts::loose::GAP;
use amberfield_core::{Feed, FeedRegion, TriangleMesh, Vector3, Volume};
use std::f64::consts::PI;

/// Random numbers that are the same on every machine: `SplitMix64` (Steele, Lea & Flood, OOPSLA 2014).
#[derive(Clone, Copy, Debug)]
pub(super) struct Random(u64);

impl Random {
    /// Numbers that other parts make others.
    pub(super) fn new(parts: [u64; 3]) -> Self {
        let mut random = Self(0);
        for part in parts {
            random.0 ^= part;
            random.0 = random.next();
        }
        random
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Number from 0 up to 1.
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Number between two; the middle where they are no interval.
    fn between(&mut self, low: f64, high: f64) -> f64 {
        if high > low { low + (high - low) * self.unit() } else { 0.5 * (low + high) }
    }
}

/// Number `k` of places that fill the unit cube evenly (Roberts's sequence).
pub(super) fn scattered(k: u64) -> Vector3<f64> {
    let step = Vector3::new(0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_2);
    step.map(|step| (0.5 + (k + 1) as f64 * step).fract())
}

/// Places of a region.
#[derive(Clone, Debug)]
pub(super) enum Places {
    Volume(Volume),
    Face(Face),
}

/// Face through which grains come.
#[derive(Clone, Debug)]
pub(super) struct Face {
    triangles: Vec<[Vector3<f64>; 3]>,
    /// Areas of the triangles up to and with each one [m²].
    areas: Vec<f64>,
    /// Edges at which the face ends.
    rim: Vec<[Vector3<f64>; 2]>,
    /// Unit vector along the grains' velocity.
    direction: Vector3<f64>,
}

impl Places {
    pub(super) fn of(feed: &Feed) -> Self {
        match &feed.region {
            FeedRegion::Face(mesh) => Self::Face(Face::new(mesh, &feed.velocity)),
            FeedRegion::Volume(volume) => Self::Volume(volume.clone()),
        }
    }

    /// Random place for the centre of a grain of a radius [m].
    pub(super) fn draw(&self, radius: f64, random: &mut Random) -> Option<Vector3<f64>> {
        let inset = radius * (1.0 + GAP);
        match self {
            Self::Volume(Volume::Box { min, max }) => {
                Some(Vector3::from_fn(|a, _| random.between(min[a] + inset, max[a] - inset)))
            }
            Self::Volume(Volume::Cylinder { base, axis, radius: outer, length }) => {
                let along = random.between(inset, length - inset);
                // The root makes the density uniform over the disc.
                let distance = (outer - inset).max(0.0) * random.unit().sqrt();
                let angle = random.between(0.0, 2.0 * PI);
                let [first, second] = perpendicular(axis);
                Some(base + axis * along + (first * angle.cos() + second * angle.sin()) * distance)
            }
            Self::Face(face) => face.draw(radius, random),
        }
    }

    /// Places of a lattice in which grains of a radius [m] do not touch; none for a face.
    pub(super) fn lattice(&self, radius: f64) -> impl Iterator<Item = Vector3<f64>> + '_ {
        let inset = radius * (1.0 + 2.0 * GAP);
        let bounds = match self {
            Self::Volume(volume) => Some(volume.bounds()),
            Self::Face(_) => None,
        };
        bounds.into_iter().flat_map(move |[low, high]| {
            let count = |axis: usize| {
                ((high[axis] - low[axis] - 2.0 * inset) / (2.0 * inset)).floor().clamp(-1.0, 1e6) as i64 + 1
            };
            let [nx, ny, nz] = [0, 1, 2].map(count);
            let place = move |x: i64, y: i64, z: i64| {
                low + Vector3::new(x as f64, y as f64, z as f64) * (2.0 * inset) + Vector3::repeat(inset)
            };
            (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| place(x, y, z))))
        })
    }

    /// Whether a grain of a radius [m] lies in the region as a whole, or came through the face as a whole.
    pub(super) fn hold(&self, place: &Vector3<f64>, radius: f64) -> bool {
        match self {
            Self::Volume(volume) => volume.holds(place, radius),
            // Drawn places are such.
            Self::Face(_) => true,
        }
    }
}

impl Face {
    fn new(mesh: &TriangleMesh, velocity: &Vector3<f64>) -> Self {
        let corner = |k: u32| mesh.vertices[k as usize];
        let mut sum = 0.0;
        let triangles: Vec<_> = mesh.triangles.iter().map(|corners| corners.map(corner)).collect();
        let area = |[a, b, c]: &[Vector3<f64>; 3]| {
            sum += 0.5 * (b - a).cross(&(c - a)).norm();
            sum
        };
        let areas = triangles.iter().map(area).collect();
        let direction = velocity.try_normalize(0.0).unwrap_or_else(Vector3::zeros);
        Self { triangles, areas, rim: mesh.rim(), direction }
    }

    /// Place behind a random point of the face, along the velocity, at which a grain has just come through.
    fn draw(&self, radius: f64, random: &mut Random) -> Option<Vector3<f64>> {
        let at = random.unit() * self.areas.last()?;
        let triangle = self.areas.partition_point(|area| *area <= at).min(self.triangles.len() - 1);
        let [a, b, c] = self.triangles[triangle];
        let (s, t) = (random.unit().sqrt(), random.unit());
        let foot = a * (1.0 - s) + b * (s * (1.0 - t)) + c * (s * t);
        let is_inside = self.rim.iter().all(|edge| distance(edge, &foot) >= radius);
        is_inside.then(|| foot + self.direction * (radius * (1.0 + GAP)))
    }
}

/// Distance of a point from an edge [m].
fn distance([from, to]: &[Vector3<f64>; 2], point: &Vector3<f64>) -> f64 {
    let edge = to - from;
    let share = ((point - from).dot(&edge) / edge.norm_squared()).clamp(0.0, 1.0);
    (from + edge * share - point).norm()
}

/// Unit vectors that are perpendicular to a unit vector and to each other.
fn perpendicular(axis: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let mut helper = Vector3::zeros();
    helper[axis.iamin()] = 1.0;
    let first = axis.cross(&helper).normalize();
    [first, axis.cross(&first)]
}
