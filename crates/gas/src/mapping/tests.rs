use super::*;
use amberfield_core::{Boundary, Domain};
use amberfield_field::far::FarMeshParts;
use proptest::prelude::*;

fn mesh(boundary: Boundary) -> FarMesh {
    let faces = [[Boundary::Periodic; 2], [boundary; 2], [Boundary::Grounded; 2]];
    let domain = Domain::new(Vector3::zeros(), Vector3::new(4.0, 5.0, 6.0), faces).unwrap();
    FarMesh::new(FarMeshParts::of_box(&domain, [4, 5, 6]).unwrap()).unwrap()
}

fn mapping(mesh: &FarMesh, length: Option<f64>, diameter: f64) -> Mapping {
    Mapping::new(mesh, &CellShapes::of_planes(mesh).unwrap(), length, diameter).unwrap()
}

fn placed(mesh: &FarMesh, centre: Vector3<f64>) -> Placed {
    Placed { centre, diameter: 0.1, cell: mesh.locate(&centre, None).0 }
}

/// Places of one grain.
fn places(mapping: &Mapping, mesh: &FarMesh, grain: Placed) -> Places {
    let mut places = Places::default();
    mapping.place(mesh, &[grain], &mut places);
    places
}

/// Shares of a grain at a point, by cell.
fn by_cell(mapping: &Mapping, mesh: &FarMesh, point: Vector3<f64>) -> Vec<f64> {
    let places = places(mapping, mesh, placed(mesh, point));
    let shares = mapping.spread(&places, &[[1.0]]);
    shares.iter().zip(mesh.volumes()).map(|([share], volume)| share * volume).collect()
}

proptest! {
    #[test]
    fn shares_add_up_to_one_and_do_not_jump_across_faces(
        x in 0.0..4.0_f64, y in 0.0..5.0_f64, z in 0.0..6.0_f64,
        length in 0.1..9.0_f64, axis in 0..3_usize,
    ) {
        let mesh = mesh(Boundary::Periodic);
        let mapping = mapping(&mesh, Some(length), 0.1);
        let mut on_face = Vector3::new(x, y, z);
        on_face[axis] = on_face[axis].round();
        let domain = mesh.domain();
        let side = |sign: f64| {
            let mut point = on_face;
            point[axis] += sign * 1e-9;
            let mut point = domain.wrap(point);
            point.z = point.z.clamp(0.0, 6.0);
            by_cell(&mapping, &mesh, point)
        };
        let (below, above) = (side(-1.0), side(1.0));
        prop_assert!((below.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        for (below, above) in below.iter().zip(&above) {
            prop_assert!((below - above).abs() < 1e-7, "{below} {above}");
        }
    }

    /// The gas gives a grain what its shares say, by the same sums.
    #[test]
    fn what_is_gathered_is_weighted_by_the_shares(
        x in 0.0..4.0_f64, y in 0.0..5.0_f64, z in 0.0..6.0_f64, length in 0.1..9.0_f64,
    ) {
        let mesh = mesh(Boundary::Grounded);
        let mapping = mapping(&mesh, Some(length), 0.1);
        let point = Vector3::new(x, y, z);
        let places = places(&mapping, &mesh, placed(&mesh, point));
        let flow: Vec<[f64; 1]> = (0..mesh.cell_count()).map(|cell| [(1.7 * cell as f64).sin()]).collect();
        let shares = by_cell(&mapping, &mesh, point);
        let expected: f64 = shares.iter().zip(&flow).map(|(share, [u])| share * u).sum();
        let found = mapping.of_grains(&places, &mapping.smooth(&flow))[0][0];
        prop_assert!((found - expected).abs() < 1e-14, "{found} {expected}");
    }
}

#[test]
fn cells_smaller_than_grains_share_them_and_walls_lose_nothing() {
    let mesh = mesh(Boundary::Grounded);
    let mapping = mapping(&mesh, None, 3.0);
    assert!((mapping.length() - 9.9).abs() < 1e-12);
    let corner = by_cell(&mapping, &mesh, Vector3::new(0.0, 0.0, 0.0));
    assert!((corner.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    assert!(corner.iter().all(|&weight| weight < 0.1));
}

#[test]
fn nonsense_is_refused() {
    let mesh = mesh(Boundary::Grounded);
    let shapes = CellShapes::of_planes(&mesh).unwrap();
    assert!(Mapping::new(&mesh, &shapes, Some(f64::NAN), 0.1).is_err());
    assert!(Mapping::new(&mesh, &shapes, Some(-1.0), 0.1).is_err());
}

/// Case of a lone grain: it finds itself spread as [`Mapping::variances_of_one`] says, in cells of any size.
#[test]
fn a_lone_grain_is_spread_as_far_as_is_said() {
    const COUNT: usize = 24;
    let mut all = Vec::new();
    let edge = COUNT as f64;
    let domain = Domain::new(Vector3::zeros(), Vector3::repeat(edge), [[Boundary::Periodic; 2]; 3]).unwrap();
    let mesh = FarMesh::new(FarMeshParts::of_box(&domain, [COUNT; 3]).unwrap()).unwrap();
    for diameter in [0.1, 0.3, 1.0, 2.0, 3.5] {
        let mapping = mapping(&mesh, None, diameter);
        let (mut void, mut flow, mut said) = (0.0, 0.0, [0.0; 2]);
        let offsets = [[0.5, 0.5, 0.5], [0.1, 0.4, 0.2], [0.0, 0.0, 0.0], [0.3, 0.0, 0.45], [0.25; 3]];
        for offset in offsets {
            let centre = Vector3::from(offset) + Vector3::repeat(11.0);
            let cell = mesh.locate(&centre, None).0;
            let place = places(&mapping, &mesh, Placed { centre, diameter, cell });
            let density = mapping.spread(&place, &[[1.0]]);
            void += mapping.of_grains(&place, &mapping.near(&density))[0][0] / offsets.len() as f64;
            flow += mapping.of_grains(&place, &mapping.smooth(&density))[0][0] / offsets.len() as f64;
            said = mapping.variances_of_one(cell, diameter).map(|variance| (variance.trace() / 3.0).sqrt());
        }
        let spread = |density: f64| (density * (2.0 * std::f64::consts::PI).powf(1.5)).powf(-1.0 / 3.0);
        let off = [(void, said[0]), (flow, said[1])].map(|(found, said)| said / spread(found) - 1.0);
        all.push((diameter, off));
    }
    assert!(all.iter().flat_map(|(_, off)| off).all(|off| off.abs() < 0.03), "{all:?}");
}
