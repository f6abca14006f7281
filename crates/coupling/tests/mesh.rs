//! Meshes of several ranks that are put together.

use amberfield_core::{Boundary, Domain, Vector3};
use amberfield_coupling::{MeshArrays, MeshPart, assemble};
use amberfield_field::far::{FarMesh, FarMeshParts};
use amberfield_wire::payloads::MeshOutline;

/// A box whose x axis is cyclic.
fn one_box() -> FarMesh {
    let faces = [
        [Boundary::Periodic; 2],
        [Boundary::Grounded; 2],
        [Boundary::Insulating { normal_field_v_m: 0.0 }; 2],
    ];
    let domain = Domain::new(Vector3::zeros(), Vector3::new(3.0, 2.0, 2.0), faces).expect("a sound domain");
    FarMeshParts::of_box(&domain, [3, 2, 2]).and_then(FarMesh::new).expect("a sound mesh")
}

#[test]
fn boundary_faces_of_all_ranks_keep_their_corners_and_patches() {
    let mesh = one_box();
    let arrays = MeshArrays::of(&mesh);
    let alone = arrays.part(&mesh);
    // Two ranks with a box each, in the same place: only how they are put together is looked at.
    let cells = mesh.cell_count() as u64;
    let outline = MeshOutline { all_cells: 2 * cells, ..alone.outline };
    let later = |&neighbour: &i64| if neighbour < 0 { neighbour } else { neighbour + cells as i64 };
    let neighbours: Vec<i64> = alone.face_neighbours.iter().map(later).collect();
    let first = MeshPart { outline, ..alone };
    let second = MeshPart {
        outline: MeshOutline { first_cell: cells, ..outline },
        face_neighbours: &neighbours,
        ..alone
    };
    let both = assemble(&[first, second]).expect("sound parts");
    assert_eq!(both.patches(), mesh.patches());
    let faces = mesh.boundary().len();
    assert_eq!(both.boundary().len(), 2 * faces);
    for face in 0..faces {
        for whole in [face, faces + face] {
            assert_eq!(both.corners_of(whole), mesh.corners_of(face));
            assert_eq!(both.boundary()[whole].patch, mesh.boundary()[face].patch);
        }
    }
    let other = MeshPart { patches: b"xMin wall\n", ..second };
    let error = assemble(&[first, other]).expect_err("ranks disagree").to_string();
    assert!(error.contains("its ranks have different patches"), "{error}");
}
