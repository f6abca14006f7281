//! Mesh walls against plane walls, corners, periodic faces.

use crate::common::{RADIUS, floor, grain, material, mesh_floor, run, setup, wall};
use amberfield_core::{Boundary, Domain, MaterialId, TriangleMesh, Vector3, Wall, WallShape};
use amberfield_dem::{Simulation, WallCover};

#[test]
fn ball_on_a_triangulated_floor_moves_as_on_the_plane() {
    let motion = |wall| {
        // Along a direction that meets faces, edges and, at the origin, a vertex.
        let mut scene = setup(
            vec![grain(1, [-4.3e-3, -2.15e-3, RADIUS * 1.01], [0.4, 0.2, -0.05])],
            material(0.3, 0.4, 0.02),
            2e-6,
        );
        scene.walls = vec![wall];
        scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
        let mut simulation = Simulation::new(scene).unwrap();
        run(&mut simulation, 10_000);
        simulation.particles().grain(0)
    };
    let (plane, mesh) = (motion(floor()), motion(mesh_floor(10e-3, 20)));
    assert!(plane.position.x > 2e-3, "did not cross: {:?}", plane.position);
    // Round-off of closest points, amplified over 10 000 steps.
    assert!((plane.position - mesh.position).norm() < 1e-12, "{plane:?} {mesh:?}");
    assert!((plane.velocity - mesh.velocity).norm() < 1e-9);
    assert!((plane.angular_velocity - mesh.angular_velocity).norm() < 1e-6);
}

#[test]
fn ball_resting_on_a_shared_vertex_feels_one_floor() {
    let rest = |wall| {
        let mut scene = setup(vec![grain(1, [0.0, 0.0, RADIUS], [0.0; 3])], material(0.5, 0.4, 0.0), 2e-6);
        scene.walls = vec![wall];
        scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
        let mut simulation = Simulation::new(scene).unwrap();
        run(&mut simulation, 20_000);
        simulation.particles().position[0]
    };
    let (plane, mesh) = (rest(floor()), rest(mesh_floor(10e-3, 20)));
    assert!((plane - mesh).norm() < 1e-15, "{plane:?} {mesh:?}");
}

#[test]
fn ball_in_a_concave_groove_rests_on_both_faces() {
    // A right-angled groove along y, its faces at 45°.
    let vertices = vec![
        Vector3::new(0.0, -1e-2, 0.0),
        Vector3::new(0.0, 1e-2, 0.0),
        Vector3::new(1e-2, -1e-2, 1e-2),
        Vector3::new(1e-2, 1e-2, 1e-2),
        Vector3::new(-1e-2, -1e-2, 1e-2),
        Vector3::new(-1e-2, 1e-2, 1e-2),
    ];
    let triangles = vec![[0, 2, 1], [2, 3, 1], [0, 1, 4], [1, 5, 4]];
    let mut scene =
        setup(vec![grain(1, [1e-5, 0.0, RADIUS * 2.0_f64.sqrt()], [0.0; 3])], material(0.4, 0.0, 0.0), 2e-6);
    scene.walls = vec![wall(WallShape::Mesh(TriangleMesh { vertices, triangles }))];
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
    let mut simulation = Simulation::new(scene).unwrap();
    run(&mut simulation, 50_000);
    assert_eq!(simulation.contacts(), 2);
    let p = simulation.particles();
    assert!(p.position[0].x.abs() < 1e-7 && p.velocity[0].norm() < 1e-4, "{:?}", p.grain(0));
}

#[test]
fn collision_across_periodic_faces_is_the_one_inside() {
    let rebound = |shift: f64| {
        let x = RADIUS * 1.3;
        let mut scene = setup(
            vec![
                grain(1, [-x + shift, shift, shift], [0.3, 0.1, 0.0]),
                grain(2, [x + shift, shift + 0.5 * RADIUS, shift], [-0.3, 0.0, 0.1]),
            ],
            material(0.8, 0.3, 0.01),
            2e-6,
        );
        let half = 5.0 * RADIUS;
        scene.domain =
            Domain::new(Vector3::repeat(-half), Vector3::repeat(half), [[Boundary::Periodic; 2]; 3]).unwrap();
        for position in &mut scene.particles.position {
            *position = scene.domain.wrap(*position);
        }
        let mut simulation = Simulation::new(scene).unwrap();
        run(&mut simulation, 4000);
        simulation.particles()
    };
    let (inside, across) = (rebound(0.0), rebound(5.0 * RADIUS));
    assert!(inside.velocity[0].x < 0.0, "no collision: {:?}", inside.velocity);
    for k in 0..2 {
        // Round-off of the wrapped coordinates over the collision.
        assert!((inside.velocity[k] - across.velocity[k]).norm() < 1e-9);
        assert!((inside.angular_velocity[k] - across.angular_velocity[k]).norm() < 1e-6);
    }
}

/// Triangles of a surface that turn the other side.
fn turned(mut surface: TriangleMesh) -> TriangleMesh {
    surface.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    surface
}

fn surface_of(wall: Wall) -> TriangleMesh {
    match wall.shape {
        WallShape::Mesh(surface) => surface,
        WallShape::Plane { .. } => panic!("a plane has no triangles"),
    }
}

/// Changes that physics does not see: into how many walls a surface is cut, in which order they come, and
/// whether a wall is there twice.
#[test]
fn a_surface_cut_into_several_walls_is_the_surface() {
    let whole = surface_of(mesh_floor(10e-3, 20));
    let motion = |surfaces: Vec<TriangleMesh>| {
        let mut scene = setup(
            vec![grain(1, [-4.3e-3, -2.15e-3, RADIUS * 1.01], [0.4, 0.2, -0.05])],
            material(0.3, 0.4, 0.02),
            2e-6,
        );
        scene.walls = surfaces.into_iter().map(|surface| wall(WallShape::Mesh(surface))).collect();
        scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
        let mut simulation = Simulation::new(scene).unwrap();
        run(&mut simulation, 10_000);
        simulation.particles().grain(0)
    };
    let part = |wanted: &dyn Fn(usize) -> bool| {
        let numbered = whole.triangles.iter().enumerate();
        let triangles =
            numbered.filter(|(number, _)| wanted(*number)).map(|(_, triangle)| *triangle).collect();
        TriangleMesh { vertices: whole.vertices.clone(), triangles }
    };
    let alone = motion(vec![whole.clone()]);
    let third = |which: usize| part(&|number| number % 3 == which);
    for surfaces in [
        vec![third(0), third(1), third(2)],
        vec![third(2), third(0), third(1)],
        vec![part(&|number| number < 411), part(&|number| number >= 411)],
        vec![whole.clone(), whole.clone()],
        vec![turned(whole.clone()), whole.clone()],
    ] {
        let cut = motion(surfaces);
        // Round-off of closest points, amplified over 10 000 steps.
        assert!((alone.position - cut.position).norm() < 1e-12, "{alone:?} {cut:?}");
        assert!((alone.velocity - cut.velocity).norm() < 1e-9);
        assert!((alone.angular_velocity - cut.angular_velocity).norm() < 1e-6);
    }
}

/// A baffle of two walls in one place: each of two grains rebounds from the side that faces it.
#[test]
fn the_sides_of_a_baffle_may_be_of_different_materials() {
    const STIFF: f64 = 0.9;
    const SOFT: f64 = 0.3;
    let front = surface_of(mesh_floor(10e-3, 20));
    let mut scene = setup(
        vec![
            grain(1, [1.3e-3, 0.4e-3, 1.5 * RADIUS], [0.0, 0.0, -0.1]),
            grain(2, [1.0e-3, 5.0e-3, -1.5 * RADIUS], [0.0, 0.0, 0.1]),
        ],
        material(STIFF, 0.0, 0.0),
        2e-6,
    );
    scene.materials.push(material(SOFT, 0.0, 0.0));
    scene.walls = vec![wall(WallShape::Mesh(front.clone())), wall(WallShape::Mesh(turned(front)))];
    scene.walls[1].material = MaterialId(1);
    let mut simulation = Simulation::new(scene).unwrap();
    run(&mut simulation, 20_000);
    let rebound = simulation.particles().velocity.iter().map(|v| (v.z / 0.1).abs()).collect::<Vec<f64>>();
    // A pair's restitution is the geometric mean of those of its materials.
    for (rebound, expected) in rebound.iter().zip([STIFF, (STIFF * SOFT).sqrt()]) {
        assert!((rebound - expected).abs() < 0.02, "{rebound} {expected}");
    }
}

#[test]
fn walls_cover_what_is_at_them_and_what_planes_hide() {
    let cover = WallCover::new(&[mesh_floor(10e-3, 4), floor()]).unwrap();
    assert!(cover.covers(Vector3::new(1e-3, 2e-3, 1e-5), 1e-4));
    assert!(cover.covers(Vector3::new(1e-3, 2e-3, -1.0), 1e-4));
    assert!(!cover.covers(Vector3::new(1e-3, 2e-3, 1e-3), 1e-4));
    let alone = WallCover::new(&[mesh_floor(10e-3, 4)]).unwrap();
    assert!(!alone.covers(Vector3::new(1e-3, 2e-3, -1.0), 1e-4));
}
