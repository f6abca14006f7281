//! Changes of walls and scenes that physics does not see, after which grains move as before: a line each.

#[expect(dead_code, reason = "the tests of the motion use all of it")]
#[path = "../../../crates/dem/tests/common/mod.rs"]
pub(super) mod common;

use amberfield_core::{Grain, Material, Matrix3, TriangleMesh, Vector3, Wall, WallShape};
use amberfield_dem::{Setup, Simulation};
use common::{RADIUS, grain, material, run, setup, wall};

/// Difference of places over the radius that other roundings make in some thousand steps.
const ROUND_OFF: f64 = 1e-6;

/// Plane z = 0.
pub(super) fn plane() -> Wall {
    wall(WallShape::Plane { point: Vector3::zeros(), normal: Vector3::z() })
}

/// Rectangle of the plane z = 0 in cells of two triangles.
pub(super) fn sheet(x: [f64; 2], y: [f64; 2], cells: [u32; 2]) -> Wall {
    let at = |range: [f64; 2], k: u32, n: u32| range[0] + (range[1] - range[0]) * f64::from(k) / f64::from(n);
    let mut mesh = TriangleMesh::default();
    for i in 0..=cells[0] {
        for j in 0..=cells[1] {
            mesh.vertices.push(Vector3::new(at(x, i, cells[0]), at(y, j, cells[1]), 0.0));
        }
    }
    let number = |i: u32, j: u32| i * (cells[1] + 1) + j;
    for i in 0..cells[0] {
        for j in 0..cells[1] {
            let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    wall(WallShape::Mesh(mesh))
}

/// A change of the walls of a floor.
pub(super) struct Line {
    pub(super) name: &'static str,
    pub(super) walls: fn() -> Vec<Wall>,
}

pub(super) const HALF: [f64; 2] = [-0.03, 0.03];

/// Floors that are all the same.
pub(super) const FLOORS: [Line; 9] = [
    Line { name: "two planes in one place", walls: || vec![plane(), plane()] },
    Line { name: "one sheet", walls: || vec![sheet(HALF, HALF, [1, 1])] },
    Line { name: "fine triangles", walls: || vec![sheet(HALF, HALF, [97, 101])] },
    Line { name: "slivers", walls: || vec![sheet(HALF, HALF, [500, 1])] },
    Line { name: "a sheet in the place of a plane", walls: || vec![plane(), sheet(HALF, HALF, [3, 3])] },
    Line { name: "a sheet twice", walls: || vec![sheet(HALF, HALF, [3, 3]), sheet(HALF, HALF, [4, 5])] },
    Line {
        name: "two walls that meet below the path",
        walls: || vec![sheet([-0.03, 0.0], HALF, [2, 2]), sheet([0.0, 0.03], HALF, [2, 2])],
    },
    Line {
        name: "two walls with T-joints",
        walls: || vec![sheet([-0.03, 0.0], HALF, [2, 3]), sheet([0.0, 0.03], HALF, [5, 8])],
    },
    Line {
        name: "a wall far away",
        walls: || vec![plane(), wall(WallShape::Plane { point: Vector3::z(), normal: -Vector3::z() })],
    },
];

/// Grain that bounces, slides and rolls over the origin, on walls.
fn over(walls: Vec<Wall>, stuff: Material) -> Grain {
    let mut scene = setup(vec![grain(1, [-4e-3, -2e-3, RADIUS * 1.01], [0.4, 0.2, -0.05])], stuff, 2e-6);
    scene.walls = walls;
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
    let mut simulation = Simulation::new(scene).expect("a good scene");
    run(&mut simulation, 10_000);
    simulation.particles().grain(0)
}

#[test]
fn how_a_floor_is_made_does_not_matter() {
    for stuff in [material(0.3, 0.4, 0.02), material(0.9, 0.0, 0.0)] {
        let known = over(vec![plane()], stuff.clone());
        for Line { name, walls } in &FLOORS {
            let found = over(walls(), stuff.clone());
            let apart = (found.position - known.position).norm() / RADIUS;
            let turned = (found.angular_velocity - known.angular_velocity).norm() * RADIUS;
            assert!(apart < ROUND_OFF && turned < ROUND_OFF, "{name}: {apart:e}, {turned:e} m/s");
        }
    }
}

/// Grain at rest in a groove along y with sides of a slope [°], as planes or as sheets.
fn in_groove(degrees: f64, planes: bool) -> Grain {
    let slope = degrees.to_radians();
    let side = |sign: f64| {
        let normal = Vector3::new(-sign * slope.sin(), 0.0, slope.cos());
        if planes {
            return wall(WallShape::Plane { point: Vector3::zeros(), normal });
        }
        let at = |x: f64, y: f64| Vector3::new(sign * x * slope.cos(), y, x * slope.sin());
        let vertices = vec![at(0.0, -0.01), at(0.0, 0.01), at(0.01, -0.01), at(0.01, 0.01)];
        wall(WallShape::Mesh(TriangleMesh { vertices, triangles: vec![[0, 2, 3], [0, 3, 1]] }))
    };
    let start = RADIUS * (1.0 - 1e-5) / slope.cos();
    let mut scene = setup(vec![grain(1, [0.0, 0.0, start], [0.0; 3])], material(0.1, 0.0, 0.0), 2e-6);
    scene.walls = vec![side(1.0), side(-1.0)];
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
    let mut simulation = Simulation::new(scene).expect("a good scene");
    run(&mut simulation, 20_000);
    simulation.particles().grain(0)
}

#[test]
fn grooves_of_planes_and_of_sheets_bear_a_grain_by_both_sides() {
    let young = 1e7 / (2.0 * (1.0 - 0.25 * 0.25));
    let weight = common::mass(RADIUS) * 9.81;
    for degrees in [45.0_f64, 20.0, 8.0, 4.0] {
        let (height, slope) = (degrees.to_radians().cos(), degrees.to_radians());
        // Each side bears half of the weight, along its normal.
        let load = 0.5 * weight / slope.cos();
        let overlap = (load / (4.0 / 3.0 * young * RADIUS.sqrt())).powf(2.0 / 3.0);
        for planes in [true, false] {
            let found = in_groove(degrees, planes);
            let known = (RADIUS - overlap) / height;
            let error = (found.position.z - known).abs() / overlap;
            assert!(error < 1e-3 && found.velocity.norm() < 1e-9, "{degrees}°, planes {planes}: {error:e}");
        }
    }
}

/// Some grains that fall into a corner of sheets and planes, seen in a frame.
fn fallen(turn: Matrix3<f64>, shift: Vector3<f64>, order: &[usize]) -> Vec<Vector3<f64>> {
    let place = |x: Vector3<f64>| turn * x + shift;
    let mut grains: Vec<Grain> = (0..6)
        .map(|k| {
            let x = [1.1e-3 + 2.1e-3 * f64::from(k % 2), 1.3e-3, 1.2e-3 + 2.2e-3 * f64::from(k / 2)];
            grain(k as u64, x, [0.103, -0.217, -0.309])
        })
        .collect();
    for grain in &mut grains {
        (grain.position, grain.velocity) = (place(grain.position), turn * grain.velocity);
    }
    let grains = order.iter().map(|&k| grains[k]).collect();
    let mut scene: Setup = setup(grains, material(0.5, 0.3, 0.05), 5e-6);
    scene.domain = amberfield_core::Domain::new(
        shift - Vector3::repeat(1.0),
        shift + Vector3::repeat(1.0),
        [[amberfield_core::Boundary::Open; 2]; 3],
    )
    .expect("a good box");
    let WallShape::Mesh(mut floor) = sheet(HALF, HALF, [4, 7]).shape else { unreachable!("a mesh") };
    floor.vertices.iter_mut().for_each(|x| *x = place(*x));
    let side = |normal: Vector3<f64>| {
        wall(WallShape::Plane { point: place(Vector3::zeros()), normal: turn * normal })
    };
    scene.walls = vec![wall(WallShape::Mesh(floor)), side(Vector3::x()), side(Vector3::y())];
    scene.time.gravity_m_s2 = turn * Vector3::new(0.0, 0.0, -9.81);
    let mut simulation = Simulation::new(scene).expect("a good scene");
    run(&mut simulation, 1000);
    let particles = simulation.particles();
    let place_of = |id: u64| particles.id.iter().position(|known| *known == id).expect("nobody leaves");
    (0..6).map(|id| turn.transpose() * (particles.position[place_of(id)] - shift)).collect()
}

#[test]
fn frame_and_order_do_not_matter() {
    let same: Vec<usize> = (0..6).collect();
    let known = fallen(Matrix3::identity(), Vector3::zeros(), &same);
    let cross = Vector3::new(0.3, -0.5, 0.8).normalize().cross_matrix();
    let turn = Matrix3::identity() + 0.9_f64.sin() * cross + (1.0 - 0.9_f64.cos()) * cross * cross;
    let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0));
    // Places 1000 m away are round to 1e-13 m.
    let lines = [
        ("turned", turn, Vector3::zeros(), 1e-6),
        ("mirrored", mirror, Vector3::zeros(), 1e-6),
        ("elsewhere", Matrix3::identity(), Vector3::new(3.0, -2.0, 5.0), 1e-6),
        ("1000 m away", Matrix3::identity(), Vector3::new(1000.0, 0.0, -1000.0), 1e-3),
    ];
    for (name, turn, shift, bound) in lines {
        let found = fallen(turn, shift, &same);
        let apart = found.iter().zip(&known).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max) / RADIUS;

        assert!(apart < bound, "{name}: {apart:e}");
    }
    let found = fallen(Matrix3::identity(), Vector3::zeros(), &[4, 1, 5, 0, 2, 3]);
    let apart = found.iter().zip(&known).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max) / RADIUS;
    assert!(apart < 1e-6, "order: {apart:e}");
}
