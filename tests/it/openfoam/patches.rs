//! Patches of OpenFOAM's meshes: what the DEM side learns of them.

use amberfield_core::Vector3;
use amberfield_coupling::{Announced, RemoteSolver, SolverSettings};
use amberfield_field::far::FarField as _;
use amberfield_tests::Workbench;
use amberfield_tests::foam_case::{brick, write_case};
use std::time::Duration;

/// Largest difference of areas and centres from those that OpenFOAM says, over the size of a face.
const ROUND_OFF: f64 = 1e-9;

/// Solver of the case in the folder `foam`, with a number of processes.
fn solver(bench: &Workbench, ranks: u32) -> RemoteSolver {
    let settings = SolverSettings {
        case: bench.path("foam"),
        application: None,
        flow: false,
        start: true,
        ranks,
        timeout: Duration::from_secs(60),
        far_tolerance: 1e-7,
        log: Some(bench.path("log")),
    };
    Announced::new(settings).and_then(Announced::connect).expect("the solver answers")
}

#[test]
fn boundary_faces_come_with_their_corners_and_patches_from_any_number_of_ranks() {
    let [cyclic, wall, open] = [
        ("cyclic", "type cyclic;"),
        ("wall", "type fixedValue; value uniform 0;"),
        ("patch", "type zeroGradient;"),
    ];
    let brick = brick([12.0, 9.0, 10.0], [6, 4, 5], &[cyclic, cyclic, wall, open, wall, wall]);
    let bench = Workbench::new("");
    write_case(&bench, &brick.mesh, &brick.conditions, "Gauss linear");
    for ranks in [1, 3] {
        let solver = solver(&bench, ranks);
        let mesh = solver.mesh();
        let names: Vec<&str> = mesh.patches().iter().map(|patch| patch.name.as_str()).collect();
        let kinds: Vec<&str> = mesh.patches().iter().map(|patch| patch.kind.as_str()).collect();
        assert_eq!(names, ["x0", "x1", "y0", "y1", "z0", "z1"]);
        assert_eq!(kinds, ["cyclic", "cyclic", "wall", "patch", "wall", "wall"]);
        assert_eq!(mesh.boundary().len(), 2 * (6 * 5 + 6 * 4));
        for (index, face) in mesh.boundary().iter().enumerate() {
            let corners = mesh.corners_of(index);
            assert_eq!(corners.len(), 4);
            let area = (corners[2] - corners[0]).cross(&(corners[3] - corners[1])) / 2.0;
            assert!((area - face.normal * face.area).norm() < ROUND_OFF * face.area, "{area:?} {face:?}");
            let centre = corners.iter().sum::<Vector3<f64>>() / 4.0;
            assert!((centre - face.centre).norm() < ROUND_OFF * face.area.sqrt(), "{centre:?} {face:?}");
            let axis = face.normal.iamax();
            let side = usize::from(face.normal[axis] > 0.0);
            assert_eq!(face.patch as usize, 2 * axis + side, "{face:?}");
        }
    }
}
