use super::*;
use crate::levels::far::{Condition, FarMesh, FarMeshParts};
use amberfield_core::{Boundary, Domain};

#[test]
fn corner_of_a_box_has_seven_images_with_the_walls_signs() {
    let insulating = Boundary::Insulating { normal_field_v_m: 0.0 };
    let faces = [[Boundary::Grounded; 2], [insulating; 2], [Boundary::Grounded; 2]];
    let domain = Domain::new(Vector3::zeros(), Vector3::repeat(1.0), faces).unwrap();
    let mesh = FarMesh::new(FarMeshParts::of_box(&domain, [8; 3]).unwrap()).unwrap();
    let (walls, mut images) = (Walls::new(&mesh, &Outline::new(&mesh), 1.0, 1.0), Images::default());
    walls.reflect(&Vector3::new(0.1, 0.12, 0.15), &mut images);
    assert!(images.ghosts.is_empty());
    assert_eq!(images.plain.len(), 7);
    for image in &images.plain {
        let conductors = (0..3).filter(|&axis| axis != 1 && image.at[axis] < 0.0).count();
        let sign = if conductors == 1 { -1.0 } else { 1.0 };
        assert!((image.factor - sign).abs() < 1e-12, "{image:?}");
    }
    walls.reflect(&Vector3::repeat(0.5), &mut images);
    assert!(images.plain.iter().all(|image| image.factor.abs() < 1e-6), "{:?}", images.plain);
}

/// Mesh of a grounded cube of 20 cells an edge with a grounded sheet where `is_sheet` holds.
fn cube_with_sheet(is_sheet: impl Fn(&Vector3<f64>) -> bool) -> FarMesh {
    let faces = [[Boundary::Grounded; 2]; 3];
    let domain = Domain::new(Vector3::zeros(), Vector3::repeat(10.0), faces).unwrap();
    let parts = FarMeshParts::of_box(&domain, [20; 3]).unwrap();
    FarMesh::new(parts.with_sheet(is_sheet, Condition::Potential(0.0))).unwrap()
}

#[test]
fn wall_that_a_divider_cuts_in_two_mirrors_a_charge_once_and_the_divider_mirrors_both() {
    let mesh = cube_with_sheet(|x| (x.x - 5.0).abs() < 1e-6);
    let (walls, mut images) = (Walls::new(&mesh, &Outline::new(&mesh), 1.0, 1.0), Images::default());
    assert!(walls.creases.is_empty(), "a divider has no free rim");
    walls.reflect(&Vector3::new(4.899, 0.188, 5.188), &mut images);
    assert_eq!(images.plain.len(), 1);
    let mut ghosts: Vec<_> =
        images.ghosts.iter().map(|ghost| (ghost.at.x, ghost.at.y, ghost.charge)).collect();
    ghosts.sort_by(|a, b| a.partial_cmp(b).unwrap());
    let exact = [(4.899, -0.188, 1.0), (4.899, 0.188, -1.0), (5.101, -0.188, 1.0), (5.101, 0.188, -1.0)];
    for (found, exact) in ghosts.iter().zip(exact) {
        let apart = (found.0 - exact.0).abs() + (found.1 - exact.1).abs() + (found.2 - exact.2).abs();
        assert!(apart < 1e-9, "{ghosts:?}");
    }
    assert_eq!(ghosts.len(), exact.len());
}

#[test]
fn half_a_divider_has_one_rim_and_faces_that_meet_there_back_to_back() {
    let mesh = cube_with_sheet(|x| (x.x - 5.0).abs() < 1e-6 && x.z < 5.0);
    let all = edges(&mesh);
    let rims: Vec<_> = all.iter().filter(|edge| edge.bend() > creases::LEAST_BEND).collect();
    assert_eq!(rims.len(), 20);
    for rim in rims {
        assert!((rim.angle - std::f64::consts::TAU).abs() < 1e-9);
        assert!(rim.ends.iter().all(|end| (end.z - 5.0).abs() + (end.x - 5.0).abs() < 1e-9));
    }
    // Where the sheet stands on the floor, each side is a corner of a right angle.
    let on_floor = |edge: &&Edge| edge.ends.iter().all(|end| end.z.abs() + (end.x - 5.0).abs() < 1e-9);
    assert_eq!(all.iter().filter(on_floor).count(), 40);
    assert!(all.iter().filter(on_floor).all(|edge| (edge.bend() + std::f64::consts::FRAC_PI_2).abs() < 1e-9));
}
