//! Regions of feeds and outlets as thin outlines.

use super::PictureScene;
use super::camera::{Camera, corners};
use super::depth_image::DepthImage;
use crate::colour::Colour;
use amberfield_core::{Domain, FeedRegion, OutletRegion, Vector3, Volume};
use std::f64::consts::TAU;

/// Colour of feeds.
pub(super) const FEED: Colour = [26, 132, 84];
/// Colour of outlets.
pub(super) const OUTLET: Colour = [142, 68, 158];
/// Width of an outline [px].
pub(super) const WIDTH: f64 = 2.0;
/// Lines of a circle, and how many of its corners are joined to those of the other end.
const CIRCLE: usize = 48;
const JOINED: usize = 4;

/// Draws the outlines; what is nearer hides them.
pub(super) fn draw(image: &mut DepthImage, camera: &Camera, scene: &PictureScene<'_>) {
    let mut lines = |edges: Vec<[Vector3<f64>; 2]>, colour: Colour| {
        for [from, to] in edges {
            image.segment(camera.project(&from), camera.project(&to), WIDTH, colour, 1.0);
        }
    };
    for feed in scene.feeds {
        match &feed.region {
            FeedRegion::Volume(volume) => lines(of_volume(volume), FEED),
            FeedRegion::Face(mesh) => lines(mesh.rim(), FEED),
        }
    }
    for outlet in scene.outlets {
        lines(of_outlet(&outlet.region, scene.domain), OUTLET);
    }
}

/// Edges of an outlet's region.
fn of_outlet(region: &OutletRegion, domain: &Domain) -> Vec<[Vector3<f64>; 2]> {
    match region {
        OutletRegion::Volume(volume) => of_volume(volume),
        OutletRegion::Face(axis, side) => {
            let mut ends = [domain.min(), domain.max()];
            let at = ends[*side as usize][axis.index()];
            ends.iter_mut().for_each(|end| end[axis.index()] = at);
            of_box(&ends[0], &ends[1])
        }
    }
}

fn of_volume(volume: &Volume) -> Vec<[Vector3<f64>; 2]> {
    match volume {
        Volume::Box { min, max } => of_box(min, max),
        Volume::Cylinder { base, axis, radius, length } => of_cylinder(base, axis, *radius, *length),
    }
}

/// The twelve edges of a box.
fn of_box(min: &Vector3<f64>, max: &Vector3<f64>) -> Vec<[Vector3<f64>; 2]> {
    let all = corners(min, max);
    let along =
        |axis: usize| (0..8).filter(move |number| number >> axis & 1 == 0).map(move |n| [n, n | 1 << axis]);
    (0..3).flat_map(along).map(|ends| ends.map(|number| all[number])).collect()
}

/// Both circles of a cylinder, and lines along it.
fn of_cylinder(base: &Vector3<f64>, axis: &Vector3<f64>, radius: f64, length: f64) -> Vec<[Vector3<f64>; 2]> {
    let first = axis.cross(&Vector3::ith(axis.iamin(), 1.0)).normalize();
    let second = axis.cross(&first);
    let at = |number: usize, height: f64| {
        let (sine, cosine) = (TAU * number as f64 / CIRCLE as f64).sin_cos();
        base + axis * height + (first * cosine + second * sine) * radius
    };
    let circles = [0.0, length].into_iter();
    let circles = circles.flat_map(|height| (0..CIRCLE).map(move |n| [at(n, height), at(n + 1, height)]));
    let joined = (0..JOINED).map(|n| n * CIRCLE / JOINED).map(|n| [at(n, 0.0), at(n, length)]);
    circles.chain(joined).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::{Axis, Boundary, Side};

    /// Sum of the lengths of edges.
    fn length(edges: &[[Vector3<f64>; 2]]) -> f64 {
        edges.iter().map(|[from, to]| (to - from).norm()).sum()
    }

    #[test]
    fn outlines_have_the_length_of_the_edges() {
        let size = Vector3::new(1.0, 2.0, 4.0);
        let edges = of_volume(&Volume::Box { min: Vector3::zeros(), max: size });
        assert_eq!((edges.len(), length(&edges)), (12, 28.0));
        let base = Vector3::new(1.0, 0.0, 0.0);
        let tube = Volume::Cylinder { base, axis: Vector3::y(), radius: 0.5, length: 3.0 };
        let edges = of_volume(&tube);
        assert!((length(&edges) / (TAU + 12.0) - 1.0).abs() < 1e-3);
        let [low, high] = tube.bounds();
        let is_on = |x: &Vector3<f64>| (0..3).all(|a| x[a] > low[a] - 1e-12 && x[a] < high[a] + 1e-12);
        assert!(edges.iter().flatten().all(is_on));
        let domain = Domain::new(Vector3::zeros(), size, [[Boundary::Open; 2]; 3]).unwrap();
        let face = of_outlet(&OutletRegion::Face(Axis::Z, Side::Max), &domain);
        assert!(face.iter().flatten().all(|x| x.z == 4.0));
        // Each of its four edges twice: those of the lower and the upper end.
        assert_eq!(length(&face), 12.0);
    }
}
