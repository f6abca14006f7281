use super::*;
use amberfield_core::{Boundary, Domain};
use amberfield_field::far::FarMeshParts;

/// Weights of a place by node.
fn weights(nodes: &Nodes, mesh: &FarMesh, point: &Vector3<f64>, from: u32) -> Vec<f64> {
    let (cell, inside) = nodes.at(mesh, point, from);
    let mut all = vec![0.0; nodes.count()];
    let mut give = |node: u32, weight: f64| all[node as usize] += weight;
    nodes.give(cell, std::iter::once((inside, 1.0)), &mut OfNodes::default(), &mut give);
    all
}

/// Case of cuboids: closed forms say what their tetrahedra say, in cells, beside them and beyond walls.
#[test]
fn parallelepipeds_have_the_weights_of_their_tetrahedra() {
    let faces = [[Boundary::Periodic; 2], [Boundary::Grounded; 2], [Boundary::Grounded; 2]];
    let edges = Vector3::new(0.3, 2.0, 5.0);
    let domain = Domain::new(Vector3::zeros(), edges, faces).unwrap();
    let mesh = FarMesh::new(FarMeshParts::of_box(&domain, [3, 4, 5]).unwrap()).unwrap();
    let nodes = Nodes::new(&mesh, &CellShapes::of_planes(&mesh).unwrap());
    let mut cut = nodes.clone();
    cut.blocks.fill(None);
    for i in 0..2000 {
        let along = |step: f64| 1.1 * (step * f64::from(i)).fract() - 0.05;
        let point = Vector3::new(along(0.37), along(0.53), along(0.71)).component_mul(&edges);
        let inside = point.map(|x| x.max(0.0)).inf(&(edges * 0.999));
        let near = mesh.locate(&inside, None).0;
        let from = (near + i % 2) % mesh.cell_count() as u32;
        let apart = weights(&nodes, &mesh, &point, from).into_iter().zip(weights(&cut, &mesh, &point, from));
        for (block, tetrahedron) in apart {
            assert!((block - tetrahedron).abs() < 1e-13, "{point} {block} {tetrahedron}");
        }
    }
}

/// Case of a place at 0.5, 0.25 and −0.1 of the half edges of a sheared cell.
#[test]
fn a_parallelepiped_shares_a_place_among_its_corners() {
    let edges = [Vector3::new(2.0, 0.0, 0.0), Vector3::new(1.0, 3.0, 0.0), Vector3::new(0.0, 1.0, 0.5)];
    let to_face: Vec<_> = edges.iter().flat_map(|edge| [*edge, -edge]).collect();
    let corner = |k: usize| {
        (0..3).map(|axis| edges[axis] * if k >> axis & 1 == 1 { 1.0 } else { -1.0 }).sum::<Vector3<f64>>()
    };
    let corners: Vec<_> = (0..8).rev().map(corner).collect();
    let (block, numbers) = Block::new(&to_face, &corners).unwrap();
    assert_eq!(numbers, [7, 6, 5, 4, 3, 2, 1, 0]);
    let at = block.coordinates(&(edges[0] * 0.5 + edges[1] * 0.25 - edges[2] * 0.1));
    let mut weights = [0.0; 8];
    Block::add(&at, 2.0, &mut weights);
    // Of the centre 0.5/8 each, of the face's 0.25/4 each, of the edge's ends 0.175 and 0.075.
    let expected = [0.0625, 0.125, 0.0625, 0.3, 0.0625, 0.125, 0.0625, 0.2].map(|weight: f64| 2.0 * weight);
    for (weight, expected) in weights.iter().zip(expected) {
        assert!((weight - expected).abs() < 1e-15, "{weights:?}");
    }
    let mut moved = corners;
    moved[3] += edges[0] * 0.01;
    assert!(Block::new(&to_face, &moved).is_none());
}

/// Case of places around points in cuboids that meet at corners: their nodes are found at once.
#[test]
fn a_crossing_gives_places_to_the_nodes_of_the_cells_that_they_are_in() {
    let faces = [[Boundary::Periodic; 2], [Boundary::Grounded; 2], [Boundary::Grounded; 2]];
    let edges = Vector3::new(3.0, 2.0, 5.0);
    let domain = Domain::new(Vector3::zeros(), edges, faces).unwrap();
    let mesh = FarMesh::new(FarMeshParts::of_box(&domain, [3, 4, 5]).unwrap()).unwrap();
    let nodes = Nodes::new(&mesh, &CellShapes::of_planes(&mesh).unwrap());
    let reach = 0.2;
    for i in 0..500 {
        let along = |step: f64| (step * f64::from(i)).fract();
        let mut point = Vector3::new(along(0.37), along(0.53), along(0.71)).component_mul(&edges);
        (1..3).for_each(|axis| point[axis] = point[axis].clamp(reach, edges[axis] - reach));
        let cell = mesh.locate(&point, None).0;
        let beside = [[1.0, -1.0, 1.0], [0.0, 0.5, 0.2], [-1.0; 3]].map(|place| Vector3::from(place) * reach);
        let mut all = vec![0.0; nodes.count()];
        let crossing = nodes.crossing(cell, &point, reach).expect("cuboids are there");
        crossing.give(beside.iter().map(|place| (*place, 1.0)), |node, weight| all[node as usize] += weight);
        for place in beside {
            let one = weights(&nodes, &mesh, &(point + place), cell);
            all.iter_mut().zip(one).for_each(|(all, weight)| *all -= weight);
        }
        assert!(all.iter().all(|off| off.abs() < 1e-13), "{point} {all:?}");
    }
    // Where a place is farther than the cells reach, there is none.
    assert!(nodes.crossing(0, &mesh.centres()[0], 0.6).is_none());
}
