//! Balls in motion on meshes: one contact for one surface, whatever the facets.

use crate::common::{RADIUS, floor, grain, material, mesh_floor, run, setup, wall};
use amberfield_core::{Boundary, Domain, Grain, TriangleMesh, Vector3, Wall, WallShape};
use amberfield_dem::{ElectricEnergy, Simulation};

/// Round-off of closest points, amplified over some thousand steps.
const SAME_PATH: f64 = 1e-11;
/// Energy that a second-order integrator keeps at 200 steps in a collision.
const ENERGY: f64 = 1e-3;
/// Energy that it keeps over the creases of a trough (8e-6 seen).
const ENERGY_ON_WALLS: f64 = 2e-5;

fn mesh(vertices: Vec<Vector3<f64>>, triangles: Vec<[u32; 3]>) -> Wall {
    wall(WallShape::Mesh(TriangleMesh { vertices, triangles }))
}

/// A grid of `n` × `m` squares, two triangles each; `at(i, j)` places its corners.
fn sheet(n: u32, m: u32, at: impl Fn(f64, f64) -> [f64; 3]) -> (Vec<Vector3<f64>>, Vec<[u32; 3]>) {
    let corner = |k: u32| {
        Vector3::from(at(f64::from(k % (n + 1)) / f64::from(n), f64::from(k / (n + 1)) / f64::from(m)))
    };
    let vertices = (0..(n + 1) * (m + 1)).map(corner).collect();
    let triangles = (0..n * m)
        .flat_map(|k| {
            let v = k / n * (n + 1) + k % n;
            [[v, v + 1, v + n + 2], [v, v + n + 2, v + n + 1]]
        })
        .collect();
    (vertices, triangles)
}

fn plane(point: [f64; 3], normal: [f64; 3]) -> Wall {
    wall(WallShape::Plane { point: point.into(), normal: normal.into() })
}

/// The grain after a run, and the most contacts that it had at once.
fn motion(ball: Grain, walls: Vec<Wall>, steps: u64) -> (Grain, usize) {
    let mut scene = setup(vec![ball], material(0.3, 0.4, 0.02), 2e-6);
    scene.walls = walls;
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
    let mut simulation = Simulation::new(scene).expect("a good scene");
    let mut most = 0;
    for _ in 0..steps {
        run(&mut simulation, 1);
        most = most.max(simulation.contacts());
    }
    (simulation.particles().grain(0), most)
}

#[track_caller]
fn assert_same(a: &Grain, b: &Grain) {
    assert!((a.position - b.position).norm() < SAME_PATH, "{a:?} {b:?}");
    assert!((a.velocity - b.velocity).norm() < 1e3 * SAME_PATH, "{a:?} {b:?}");
    assert!((a.angular_velocity - b.angular_velocity).norm() < 1e6 * SAME_PATH, "{a:?} {b:?}");
}

/// A ball that slides, then rolls, over the origin.
fn roller() -> Grain {
    grain(1, [-4.3e-3, -2.15e-3, RADIUS * 1.01], [0.4, 0.2, -0.05])
}

#[test]
fn facets_much_smaller_and_much_larger_than_the_ball_are_the_plane() {
    let (plane, _) = motion(roller(), vec![floor()], 8000);
    for (half, cells) in [(8e-3, 160), (0.5, 1), (0.5, 2)] {
        let (found, most) = motion(roller(), vec![mesh_floor(half, cells)], 8000);
        assert_eq!(most, 1, "{cells} cells");
        assert_same(&plane, &found);
    }
}

#[test]
fn duplicate_facets_and_slivers_change_nothing() {
    let (plane, _) = motion(roller(), vec![floor()], 8000);
    let (mut vertices, mut triangles) = sheet(20, 20, |x, y| [2e-2 * x - 1e-2, 2e-2 * y - 1e-2, 0.0]);
    // Every facet twice, once turned over.
    let turned: Vec<[u32; 3]> = triangles.iter().map(|t| [t[0], t[2], t[1]]).collect();
    triangles.extend(turned);
    // Slivers along the ball's path: widths down to round-off, and some whose third corner is out of the
    // plane by the rounding of a 32-bit file.
    for (k, (width, lift)) in
        [(1e-6, 0.0), (1e-9, 0.0), (1e-12, 1e-19), (1e-15, -1e-15), (3e-18, 2e-18), (0.0, -1e-10)]
            .into_iter()
            .enumerate()
    {
        let x = -4e-3 + 7e-4 * k as f64;
        let first = vertices.len() as u32;
        vertices.push(Vector3::new(x, -1e-2, 0.0));
        vertices.push(Vector3::new(x + 1e-3, 1e-2, 0.0));
        vertices.push(Vector3::new(x + 5e-4 + width, 0.0, lift));
        triangles.push([first, first + 1, first + 2]);
    }
    let (found, most) = motion(roller(), vec![mesh(vertices, triangles)], 8000);
    assert_eq!(most, 1);
    assert!((plane.position - found.position).norm() < 1e-9, "{plane:?} {found:?}");
}

#[test]
fn l_shaped_mesh_is_two_planes() {
    let wall_x = 3e-3;
    let ball = || grain(1, [-1e-3, 0.2e-3, RADIUS * 1.01], [0.5, 0.13, -0.05]);
    let (planes, both) = motion(ball(), vec![floor(), plane([wall_x, 0.0, 0.0], [-1.0, 0.0, 0.0])], 12_000);
    assert!(both == 2 && planes.velocity.x < 0.0, "no collision with the wall: {planes:?}");
    // One mesh of both, bent at the edge.
    let bent = |u: f64| if u < 0.5 { [wall_x - 0.02 + 0.04 * u, 0.0] } else { [wall_x, 0.04 * u - 0.02] };
    for cells in [2, 40] {
        let (vertices, triangles) = sheet(cells, cells, |u, v| [bent(u)[0], 0.04 * v - 0.02, bent(u)[1]]);
        let (found, most) = motion(ball(), vec![mesh(vertices, triangles)], 12_000);
        assert_eq!(most, 2);
        assert_same(&planes, &found);
    }
}

#[test]
fn thin_plates_act_from_both_sides_like_planes() {
    let thickness = 0.05 * RADIUS;
    let top = sheet(6, 6, |u, v| [0.03 * u - 0.015, 0.03 * v - 0.015, 0.0]);
    let mut closed = top.clone();
    let bottom = sheet(6, 6, |u, v| [0.03 * u - 0.015, 0.03 * v - 0.015, -thickness]);
    let offset = closed.0.len() as u32;
    closed.0.extend(bottom.0);
    closed.1.extend(bottom.1.iter().map(|t| t.map(|k| k + offset)));
    let below = || grain(1, [-4e-3, 0.0, -1.02 * RADIUS - thickness], [0.3, 0.0, 0.4]);
    let above = motion(roller(), vec![floor()], 6000).0;
    let under = motion(below(), vec![plane([0.0, 0.0, -thickness], [0.0, 0.0, -1.0])], 6000).0;
    let (found, most) = motion(roller(), vec![mesh(closed.0.clone(), closed.1.clone())], 6000);
    assert_eq!(most, 1);
    assert_same(&above, &found);
    let (found, most) = motion(below(), vec![mesh(closed.0, closed.1)], 6000);
    assert_eq!(most, 1);
    assert_same(&under, &found);
    // A single sheet has two sides too.
    let under = motion(below(), vec![plane([0.0; 3], [0.0, 0.0, -1.0])], 6000).0;
    assert_same(&under, &motion(below(), vec![mesh(top.0, top.1)], 6000).0);
}

/// Total energy over its start along a frictionless, elastic path, and the most contacts at once.
fn energy_along(ball: Grain, walls: Vec<Wall>, steps: u64) -> (f64, usize, Grain) {
    let mut scene = setup(vec![ball], material(1.0, 0.0, 0.0), 2e-6);
    scene.walls = walls;
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
    let mut simulation = Simulation::new(scene).expect("a good scene");
    let total = |s: &mut Simulation| {
        let e = s.energies(ElectricEnergy::LeftOut).expect("a good scene");
        e.kinetic + e.contact + e.gravity
    };
    let start = total(&mut simulation);
    let kinetic = simulation.energies(ElectricEnergy::LeftOut).expect("a good scene").kinetic;
    let (mut worst, mut most) = (0.0_f64, 0);
    for _ in 0..steps {
        run(&mut simulation, 1);
        most = most.max(simulation.contacts());
        worst = worst.max((total(&mut simulation) - start).abs() / kinetic);
    }
    (worst, most, simulation.particles().grain(0))
}

#[test]
fn trough_and_hill_of_facets_keep_energy() {
    let radius = 8.0 * RADIUS;
    // A trough along y whose lowest line is at z = 0, with facets of 0.75° to 20°, whose creases have two
    // contacts.
    for cells in [9, 18, 30, 60, 90, 119, 240] {
        let (vertices, triangles) = sheet(cells, 12, |u, v| {
            let angle = std::f64::consts::PI * (u - 0.5);
            [radius * angle.sin(), 0.06 * v - 0.03, radius * (1.0 - angle.cos())]
        });
        let ball = grain(1, [0.3e-3, -2e-3, RADIUS * 1.3], [0.35, 0.1, -0.02]);
        let (worst, most, end) = energy_along(ball, vec![mesh(vertices, triangles)], 20_000);
        assert!(most <= 2, "{cells} facets: {most} contacts");
        assert!(worst < ENERGY_ON_WALLS, "{cells} facets: {worst:e}");
        assert!(end.position.xz().norm() < 2.0 * radius && end.position.z > 0.5 * RADIUS, "{end:?}");
    }
    // Over the top of a hill.
    for cells in [30, 9] {
        let (vertices, triangles) = sheet(cells, 12, |u, v| {
            let angle = std::f64::consts::PI * (u - 0.5);
            [radius * angle.sin(), 0.06 * v - 0.03, -radius * (1.0 - angle.cos())]
        });
        let ball = grain(1, [-3e-3, 0.0, 1.3 * RADIUS], [0.4, 0.05, 0.0]);
        let (worst, most, end) = energy_along(ball, vec![mesh(vertices, triangles)], 12_000);
        assert!(most == 1 && worst < ENERGY && end.position.x > 3e-3, "{cells}: {most} {worst:e} {end:?}");
    }
}

#[test]
fn floor_that_ends_at_periodic_faces_is_endless() {
    let half = 3e-3;
    let travel = |walls: Vec<Wall>, periodic: bool| {
        let mut scene = setup(
            vec![grain(1, [-1e-3, -0.4e-3, RADIUS * 1.01], [0.4, 0.2, -0.05])],
            material(0.3, 0.4, 0.02),
            2e-6,
        );
        scene.walls = walls;
        scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
        if periodic {
            let mut faces = [[Boundary::Periodic; 2]; 3];
            faces[2] = [Boundary::Open; 2];
            let (min, max) = (Vector3::new(-half, -half, -half), Vector3::repeat(half));
            scene.domain = Domain::new(min, max, faces).expect("a good scene");
        }
        let mut simulation = Simulation::new(scene).expect("a good scene");
        let mut most = 0;
        for _ in 0..15_000 {
            run(&mut simulation, 1);
            most = most.max(simulation.contacts());
        }
        assert_eq!(most, 1);
        simulation.particles().grain(0)
    };
    let endless = travel(vec![floor()], false);
    assert!(endless.position.x > half + RADIUS, "{endless:?}");
    let mut found = travel(vec![mesh_floor(half, 3)], true);
    found.position += Vector3::new(2.0, 2.0, 0.0) * half;
    assert_same(&endless, &found);
}
