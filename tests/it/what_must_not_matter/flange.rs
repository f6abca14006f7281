//! OpenFOAM's own example of a flange, meshed by snappyHexMesh, with a grounded shell and grains inside.

use amberfield_core::{FieldSettings, Permittivity, Tuning, Vector3};
use amberfield_coupling::{Announced, RemoteSolver, SolverSettings};
use amberfield_field::far::{FarField as _, FarMesh};
use amberfield_field::{ElectricField, FieldValues, Wanted};
use amberfield_tests::Workbench;
use amberfield_tests::foam_case::{Random, foam_program, write_case};
use std::process::Command;
use std::time::Duration;

/// Folder of OpenFOAM's examples in Debian's package.
const EXAMPLES: &str = "/usr/share/doc/openfoam-examples/examples";
const GRAINS: usize = 200;
/// Radius of a grain [m].
const RADIUS: f64 = 2.5e-4;
const CHARGE: f64 = 1e-12;
/// Differences on other ranks that are allowed, over the RMS field: RMS and at one grain.
const RMS: f64 = 1e-3;
const WORST: f64 = 1e-2;
/// Grains that are looked at alone.
const ALONE: usize = 8;
/// Field of a grain that is alone, over q/(4πεd²) with its distance d from the nearest wall: a quarter at a
/// plane, less between walls and in corners. The other quarter is for cells of d to 2d (0.28 seen).
const OWN: f64 = 0.5;

/// Copies an example's file or folder into the case.
fn copy(from: &str, bench: &Workbench, to: &str) {
    let from = format!("{EXAMPLES}/{from}");
    let copied = Command::new("cp").args(["-r", &from]).arg(bench.path(to)).status().unwrap();
    assert!(copied.success(), "{from} is not there; install openfoam-examples");
}

/// Case of the flange with its mesh; its dictionary for decomposePar is the example's.
fn flange() -> Workbench {
    let bench = Workbench::new("");
    copy("mesh/snappyHexMesh/flange", &bench, "foam");
    copy("resources/geometry/flange.stl.gz", &bench, "foam/constant/triSurface/flange.stl.gz");
    let mesh = bench.read("foam/system/blockMeshDict");
    write_case(&bench, &mesh, "\".*\" { type fixedValue; value uniform 0; }", "leastSquares");
    for (program, options) in
        [("blockMesh", &[][..]), ("surfaceFeatureExtract", &[]), ("snappyHexMesh", &["-overwrite"])]
    {
        foam_program(&bench, program, options);
    }
    bench
}

fn solver(bench: &Workbench, ranks: u32) -> RemoteSolver {
    let settings = SolverSettings {
        ranks,
        timeout: Duration::from_secs(120),
        far_tolerance: 1e-7,
        ..SolverSettings::started(bench.path("foam"), bench.path(&format!("solver-{ranks}")))
    };
    Announced::new(settings).and_then(Announced::connect).expect("the solver answers")
}

/// Distance of a place from the nearest wall [m].
fn from_walls(mesh: &FarMesh, place: &Vector3<f64>) -> f64 {
    let faces = mesh.boundary().iter().enumerate();
    let distances = faces.map(|(index, face)| {
        let corners = mesh.corners_of(index);
        let next = corners.iter().cycle().skip(1);
        let triangles = corners.iter().zip(next).map(|(a, b)| from_triangle(place, [a, b, &face.centre]));
        triangles.fold(f64::INFINITY, f64::min)
    });
    distances.fold(f64::INFINITY, f64::min)
}

/// Distance of a place from a triangle [m].
fn from_triangle(place: &Vector3<f64>, corners: [&Vector3<f64>; 3]) -> f64 {
    let [a, b, c] = corners;
    let normal = (b - a).cross(&(c - a));
    let is_beside =
        |from: &Vector3<f64>, to: &Vector3<f64>| (to - from).cross(&(place - from)).dot(&normal) < 0.0;
    if ![(a, b), (b, c), (c, a)].into_iter().any(|(from, to)| is_beside(from, to)) {
        return ((place - a).dot(&normal) / normal.norm()).abs();
    }
    let from_edge = |from: &Vector3<f64>, to: &Vector3<f64>| {
        let along = to - from;
        let share = ((place - from).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        (place - from - share * along).norm()
    };
    from_edge(a, b).min(from_edge(b, c)).min(from_edge(c, a))
}

/// Places at random in the mesh, no two closer than a diameter, none closer to a wall than a radius [m].
fn places(mesh: &FarMesh) -> Vec<Vector3<f64>> {
    let (min, extent) = (mesh.domain().min(), mesh.domain().extent());
    let mut random = Random(19);
    let mut places: Vec<Vector3<f64>> = Vec::new();
    while places.len() < GRAINS {
        let next = min + Vector3::from_fn(|axis, _| random.number() * extent[axis]);
        let is_apart = places.iter().all(|other| (other - next).norm() > 2.0 * RADIUS);
        if is_apart && mesh.locate(&next, None).1 && from_walls(mesh, &next) > RADIUS {
            places.push(next);
        }
    }
    places
}

/// E at the grains of a cloud and at some of them when they are alone [V/m].
struct Fields {
    cloud: Vec<Vector3<f64>>,
    alone: Vec<Vector3<f64>>,
}

fn fields(field: &mut ElectricField, places: &[Vector3<f64>]) -> Fields {
    let mut values = FieldValues::default();
    let mut e = |places: &[Vector3<f64>], charges: &[f64]| {
        field.evaluate(places, charges, Wanted::default(), &mut values).unwrap();
        values.e.clone()
    };
    let cloud = e(places, &charges());
    let alone = places[..ALONE].iter().map(|place| e(&[*place], &[CHARGE])[0]).collect();
    Fields { cloud, alone }
}

/// Charges of both signs [C].
fn charges() -> Vec<f64> {
    (0..GRAINS).map(|grain| if grain % 2 == 0 { CHARGE } else { -CHARGE }).collect()
}

fn rms(vectors: &[Vector3<f64>]) -> f64 {
    (vectors.iter().map(Vector3::norm_squared).sum::<f64>() / vectors.len() as f64).sqrt()
}

/// Case whose own dictionary asks for four parts by ptscotch: none of the cuts can follow it.
#[test]
fn field_in_the_flange_does_not_see_ranks_and_is_nowhere_wild() {
    let bench = flange();
    let dictionary = bench.read("foam/system/decomposeParDict");
    let one = solver(&bench, 1);
    let places = places(one.mesh());
    let distances: Vec<f64> = places[..ALONE].iter().map(|place| from_walls(one.mesh(), place)).collect();
    let settings = FieldSettings { tuning: Tuning::Model, ..FieldSettings::default() };
    let mut field = ElectricField::over_mesh(Box::new(one), &settings, &places, &charges()).unwrap();
    let choice = field.choice().clone();
    let one = fields(&mut field, &places);
    for (e, distance) in one.alone.iter().zip(&distances) {
        let share = e.norm() * distance * distance / (Permittivity::VACUUM.coulomb() * CHARGE);
        println!("alone at {distance:.2e} m from a wall: {share:.3} of q/(4πεd²)");
        assert!(share < OWN, "{share} at {distance} m");
    }
    for ranks in 2..=4 {
        let other = Box::new(solver(&bench, ranks));
        let mut field = ElectricField::over_mesh_with_choice(other, &settings, &choice).unwrap();
        let other = fields(&mut field, &places);
        for (name, one, other) in [("cloud", &one.cloud, &other.cloud), ("alone", &one.alone, &other.alone)] {
            let apart: Vec<_> = one.iter().zip(other).map(|(a, b)| a - b).collect();
            let of_all = rms(&apart) / rms(one);
            let worst = apart.iter().map(Vector3::norm).fold(0.0, f64::max) / rms(one);
            println!("{ranks} ranks, {name}: RMS {of_all:.1e}, worst {worst:.1e}");
            assert!(of_all < RMS && worst < WORST, "{ranks} ranks, {name}: {of_all:e}, worst {worst:e}");
        }
    }
    assert_eq!(bench.read("foam/system/decomposeParDict"), dictionary, "the user's file stays as it is");
}
