use super::*;
use crate::levels::walls::creases;
use crate::levels::walls::edges::edges;
use crate::levels::walls::solid::surroundings;
use amberfield_core::{Boundary, Domain};
use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, TAU};

type Triangle = [Vector3<f64>; 3];

/// A box far around, open on all sides.
fn open() -> Domain {
    Domain::new(Vector3::repeat(-3.0), Vector3::repeat(3.0), [[Boundary::Open; 2]; 3]).unwrap()
}

fn facets(triangles: &[Triangle]) -> Facets {
    Facets::new(triangles, open()).unwrap()
}

/// A unit sphere of 20·4^level triangles: an icosahedron whose triangles are cut in four again and again.
fn sphere(level: usize) -> Vec<Triangle> {
    let t = 0.5 * (1.0 + 5_f64.sqrt());
    let corners = [
        [-1.0, t, 0.0],
        [1.0, t, 0.0],
        [-1.0, -t, 0.0],
        [1.0, -t, 0.0],
        [0.0, -1.0, t],
        [0.0, 1.0, t],
        [0.0, -1.0, -t],
        [0.0, 1.0, -t],
        [t, 0.0, -1.0],
        [t, 0.0, 1.0],
        [-t, 0.0, -1.0],
        [-t, 0.0, 1.0],
    ]
    .map(|corner| Vector3::from(corner).normalize());
    let mut triangles = Vec::new();
    // Corners of the icosahedron next to each other are 1.05 apart, others more than 1.7.
    let near = |a: usize, b: usize| (corners[a] - corners[b]).norm() < 1.2;
    for a in 0..12 {
        for b in a + 1..12 {
            for c in (b + 1..12).filter(|&c| near(a, b) && near(b, c) && near(a, c)) {
                let out = (corners[b] - corners[a]).cross(&(corners[c] - corners[a])).dot(&corners[a]) > 0.0;
                let [b, c] = if out { [b, c] } else { [c, b] };
                triangles.push([a, b, c].map(|corner| corners[corner]));
            }
        }
    }
    for _ in 0..level {
        let cut = |[a, b, c]: Triangle| {
            let [ab, bc, ca] = [a + b, b + c, c + a].map(|sum| sum.normalize());
            [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        };
        triangles = triangles.into_iter().flat_map(cut).collect();
    }
    triangles
}

/// A parallelogram of n × n × 2 triangles.
fn plate(corner: Vector3<f64>, u: Vector3<f64>, v: Vector3<f64>, n: usize) -> Vec<Triangle> {
    let at = |i: usize, j: usize| corner + u * (i as f64 / n as f64) + v * (j as f64 / n as f64);
    let mut triangles = Vec::new();
    for i in 0..n {
        for j in 0..n {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    triangles
}

/// A unit cube at the origin of 12 n² triangles.
fn cube(n: usize) -> Vec<Triangle> {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let faces = [0, 1, 2].map(|axis| (axes[axis], axes[(axis + 1) % 3], axes[(axis + 2) % 3]));
    faces
        .iter()
        .flat_map(|&(across, u, v)| [plate(Vector3::zeros(), v, u, n), plate(across, u, v, n)].concat())
        .collect()
}

/// A number from 0 to 1 for each index, the same in every run.
fn scattered(index: usize) -> f64 {
    (index as f64 * 0.618_033_988_749_894_9).fract()
}

/// Triangles in another order, some of them turned around.
fn shuffled(mut triangles: Vec<Triangle>) -> Vec<Triangle> {
    let mut key: Vec<usize> = (0..triangles.len()).collect();
    key.sort_by(|a, b| scattered(a * a + 7).total_cmp(&scattered(b * b + 7)));
    for (index, triangle) in triangles.iter_mut().enumerate() {
        triangle.rotate_left(index % 3);
        if scattered(3 * index + 1) < 0.5 {
            triangle.swap(0, 1);
        }
    }
    key.into_iter().map(|index| triangles[index]).collect()
}

fn images_of(walls: &FacetWalls, at: Vector3<f64>) -> Vec<(Vector3<f64>, f64)> {
    walls.plain_images(&at, 1.0, |_| true, &mut FacetImages::default()).collect()
}

/// Points beside facets of a sphere: their centres and more, 0.036 inwards (−1) or outwards (+1).
fn touching(side: f64) -> Vec<Vector3<f64>> {
    let point = |(index, [a, b, c]): (usize, &Triangle)| {
        let (u, v) = (scattered(index), scattered(5 * index + 2));
        let [u, v] = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
        let normal = (b - a).cross(&(c - a)).normalize();
        a + (b - a) * u + (c - a) * v + normal * (0.036 * side)
    };
    sphere(3).iter().enumerate().map(point).collect()
}

#[test]
fn images_in_a_sphere_of_facets_are_kelvins_whichever_way_its_facets_turn() {
    /// Errors of an image's place over the sphere's radius, and of its charge over the grain's, at worst and
    /// as a root of mean squares: facets know heights to 3 % of 0.004 and curvatures to a few per cent.
    const WORST: f64 = 2e-3;
    const MEAN: f64 = 1e-3;
    let reversed = sphere(3).iter().map(|&[a, b, c]| [a, c, b]).collect();
    for triangles in [sphere(3), reversed, shuffled(sphere(3))] {
        assert_eq!(triangles.len(), 1280);
        let walls = FacetWalls::new(&facets(&triangles));
        for side in [-1.0, 1.0] {
            let (mut worst, mut squares): (f64, f64) = (0.0, 0.0);
            let points = touching(side);
            for point in &points {
                let s = point.norm();
                let images = images_of(&walls, *point);
                assert_eq!(images.len(), 1, "{point}");
                let (at, charge) = images[0];
                let error = (at - point / (s * s)).norm().max((charge + 1.0 / s).abs());
                worst = worst.max(error);
                squares += error * error / points.len() as f64;
            }
            assert!(worst < WORST && squares.sqrt() < MEAN, "{side}: {worst} {}", squares.sqrt());
        }
    }
}

#[test]
fn images_in_a_sphere_fade_with_the_distance() {
    let walls = FacetWalls::new(&facets(&sphere(3)));
    let charge_at = |s: f64| images_of(&walls, Vector3::new(0.3, 0.5, 0.4).normalize() * s);
    assert!(charge_at(1.0 - walls.deepest()).is_empty() && charge_at(0.0).is_empty());
    let mut last = 1.0;
    for depth in [0.1, 0.15, 0.18, 0.2, 0.22] {
        let share = -charge_at(1.0 - depth)[0].1 * (1.0 - depth);
        assert!(share < last + 1e-2 && share > 0.0, "{depth}: {share} after {last}");
        last = share;
    }
    assert!(last < 0.5, "{last}");
}

#[test]
fn facets_of_a_sphere_lie_below_it_by_their_heights() {
    for triangles in [sphere(3), shuffled(sphere(3))] {
        let walls = FacetWalls::new(&facets(&triangles));
        let mut errors: Vec<f64> = Vec::new();
        for ([a, b, c], height) in triangles.iter().zip(walls.heights()) {
            let (normal, centre) = ((b - a).cross(&(c - a)).normalize(), (a + b + c) / 3.0);
            let along = normal.dot(&centre);
            let exact = along.signum() * (1.0 - centre.norm_squared() + along * along).sqrt() - along;
            errors.push((height / exact - 1.0).abs());
        }
        errors.sort_by(f64::total_cmp);
        assert!(errors[errors.len() * 9 / 10] < 0.05, "{errors:?}");
    }
}

/// Asserts that images are these, in any order.
fn assert_images(walls: &FacetWalls, at: [f64; 3], expected: &[([f64; 3], f64)]) {
    let images = images_of(walls, Vector3::from(at));
    assert_eq!(images.len(), expected.len(), "{images:?}");
    for (place, charge) in expected {
        let is_it = |(at, factor): &&(Vector3<f64>, f64)| {
            (at - Vector3::from(*place)).norm() < 1e-12 && (factor - charge).abs() < 1e-12
        };
        assert!(images.iter().any(|image| is_it(&image)), "no {place:?} in {images:?}");
    }
}

#[test]
fn images_in_a_box_of_facets_are_those_of_its_planes() {
    for triangles in [cube(8), shuffled(cube(8))] {
        let walls = FacetWalls::new(&facets(&triangles));
        assert!(walls.heights().iter().all(|height| *height == 0.0));
        assert_images(&walls, [0.52, 0.48, 0.05], &[([0.52, 0.48, -0.05], -1.0)]);
        let at_edge = [([-0.06, 0.5, 0.05], -1.0), ([0.06, 0.5, -0.05], -1.0), ([-0.06, 0.5, -0.05], 1.0)];
        assert_images(&walls, [0.06, 0.5, 0.05], &at_edge);
        let corner = [0.06, 0.04, 0.05];
        let all: Vec<_> = (1..8)
            .map(|mirrored| {
                let is_mirrored = |axis: usize| mirrored >> axis & 1 == 1;
                let place =
                    [0, 1, 2].map(|axis| if is_mirrored(axis) { -corner[axis] } else { corner[axis] });
                (place, if i32::count_ones(mirrored) % 2 == 1 { -1.0 } else { 1.0 })
            })
            .collect();
        assert_images(&walls, corner, &all);
        // Outside, above a face and beside its rim.
        assert_images(&walls, [0.52, 0.48, -0.05], &[([0.52, 0.48, 0.05], -1.0)]);
        // Halfway: e = δ.
        assert_images(&walls, [0.05, 0.48, -0.05], &[([0.05, 0.48, 0.05], -0.5)]);
        assert_images(&walls, [-0.01, 0.48, -0.05], &[]);
        assert_images(&walls, [0.5, 0.5, 0.5], &[]);
    }
}

#[test]
fn sides_that_are_not_allowed_mirror_nothing() {
    let sheet = plate(Vector3::zeros(), Vector3::x(), Vector3::y(), 8);
    let walls = FacetWalls::new(&facets(&sheet));
    let mut found = FacetImages::default();
    let mut count = |z: f64, is_allowed: &dyn Fn(FacetSide) -> bool| {
        walls.plain_images(&Vector3::new(0.52, 0.48, z), 2.0, is_allowed, &mut found).count()
    };
    let only_front = |side: FacetSide| side.is_front;
    assert_eq!([count(0.05, &only_front), count(-0.05, &only_front)], [1, 0]);
    let under = sheet.iter().position(|[a, b, c]| {
        let centre = (a + b + c) / 3.0;
        (centre - Vector3::new(0.54, 0.46, 0.0)).norm() < 0.03
    });
    assert_eq!([count(0.05, &|_| true), count(-0.05, &|_| true)], [1, 1]);
    let not_there = |side: FacetSide| Some(side.facet) != under;
    assert_eq!([count(0.05, &not_there), count(-0.05, &not_there)], [0, 0]);
}

#[test]
fn sheet_has_a_rim_and_two_plates_are_as_thick_and_as_far_apart_as_they_are() {
    let sheet = plate(Vector3::zeros(), Vector3::x(), Vector3::y(), 4);
    let alone = facets(&shuffled(sheet.clone()));
    assert!(surroundings(&alone).iter().all(|face| face.solid.is_infinite() && face.gap.is_infinite()));
    let all = edges(&alone);
    let rims: Vec<_> = all.iter().filter(|edge| edge.bend() > creases::LEAST_BEND).collect();
    assert_eq!(rims.len(), 16);
    for rim in rims {
        assert!((rim.angle - TAU).abs() < 1e-9);
        assert_eq!(rim.faces[0] / 2, rim.faces[1] / 2);
    }
    // Each inner edge is one of the front and one of the back.
    assert_eq!(all.iter().filter(|edge| edge.bend().abs() < 1e-9).count(), 2 * 40);

    let t = 0.2;
    let above = plate(Vector3::z() * t, Vector3::x(), Vector3::y(), 4);
    let both = facets(&shuffled([sheet, above].concat()));
    for (face, around) in both.faces().iter().zip(surroundings(&both)) {
        // Normals point out of the space of the grains.
        let to_the_other = if face.centre.z < 0.5 * t { face.normal.z } else { -face.normal.z };
        let [near, far] =
            if to_the_other > 0.0 { [around.solid, around.gap] } else { [around.gap, around.solid] };
        assert!((near - t).abs() < 1e-12 && far.is_infinite(), "{face:?} {around:?}");
    }
    let walls = FacetWalls::new(&both);
    // The depth is half the distance, outside as between the plates.
    assert!((walls.deepest() - 0.5 * t).abs() < 1e-12);
    assert_images(&walls, [0.5, 0.48, -0.04], &[([0.5, 0.48, 0.04], -1.0)]);
    assert_images(&walls, [0.5, 0.48, 0.04], &[([0.5, 0.48, -0.04], -1.0)]);
}

#[test]
fn facets_of_a_cube_meet_at_right_angles_from_inside_and_around_its_edges_from_outside() {
    let mut count = HashMap::new();
    for edge in edges(&facets(&shuffled(cube(2)))) {
        let quarters = edge.angle / FRAC_PI_2;
        assert!((quarters - quarters.round()).abs() < 1e-9, "{edge:?}");
        #[expect(clippy::cast_possible_truncation, reason = "a whole number from 1 to 4")]
        let quarters = quarters.round() as u32;
        *count.entry(quarters).or_insert(0) += 1;
    }
    assert_eq!(count, HashMap::from([(1, 24), (3, 24), (2, 2 * (72 - 24))]));
}

#[test]
fn order_of_facets_does_not_matter() {
    // A cube with a sphere inside, whose images mix near the cube's faces.
    let ball = sphere(2).into_iter().map(|corners| corners.map(|x| Vector3::repeat(0.5) + 0.4 * x));
    let all: Vec<_> = cube(8).into_iter().chain(ball).collect();
    let (walls, others) = (FacetWalls::new(&facets(&all)), FacetWalls::new(&facets(&shuffled(all))));
    for index in 0..2000 {
        let at = [index, 3 * index + 1, 7 * index + 5].map(|number| scattered(number * number));
        let (first, second) = (images_of(&walls, at.into()), images_of(&others, at.into()));
        assert_eq!(first.len(), second.len());
        for (one, other) in first.iter().zip(&second) {
            assert!((one.0 - other.0).norm() < 1e-9 && (one.1 - other.1).abs() < 1e-9, "{one:?} {other:?}");
        }
    }
}

#[test]
fn facet_without_an_area_is_refused() {
    let bad = [[Vector3::zeros(), Vector3::x(), Vector3::x() * 2.0]];
    let said = Facets::new(&bad, open()).unwrap_err().to_string();
    assert!(said.contains("facet 0") && said.contains("leave it out"), "{said}");
}
