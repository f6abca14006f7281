//! Both sides of the wire in one process: what travels is what the twin solver makes of it, and nothing is
//! left behind.

use amberfield_core::{Boundary, Domain, FarQuestion, SourceCloud, Vector3};
use amberfield_coupling::{
    Announced, BoxSolver, FieldSide, MeshArrays, Question, Reply, SolverSettings, stale_runs,
};
use amberfield_field::far::{FarField, FarRequest, FarValues};
use std::time::Duration;

const RADIUS: f64 = 3e-3;

fn domain() -> Domain {
    let faces =
        [[Boundary::Periodic; 2], [Boundary::Grounded, Boundary::Potential(5.0)], [Boundary::Grounded; 2]];
    Domain::new(Vector3::zeros(), Vector3::new(0.006, 0.005, 0.004), faces).expect("a good scene")
}

fn settings(timeout_s: f64) -> SolverSettings {
    let timeout = Duration::from_secs_f64(timeout_s);
    SolverSettings { timeout, wait: Some(timeout), far_tolerance: 1e-8, ..SolverSettings::awaited("none") }
}

/// A solver that answers with the density that it was asked for in place of a potential.
fn echo(run: &str) {
    let solver = BoxSolver::new(&domain(), [6, 5, 4]).expect("a good mesh");
    let mesh = solver.mesh();
    let mut side = FieldSide::open(run, 0, 1).expect("the run is there");
    side.send_mesh(&MeshArrays::of(mesh).part(mesh), 0).expect("a good mesh");
    while let Some(question) = side.wait().expect("the DEM side lives") {
        let Question::Far(asked) = question else { panic!("{question:?}") };
        let mut density = vec![0.0; mesh.cell_count()];
        side.density(&mut density).expect("good charges");
        assert_eq!(
            side.boundary(mesh.boundary().len()).expect("one number a face").len(),
            mesh.boundary().len()
        );
        let e = vec![[1.0, 2.0, asked.permittivity_f_m]; mesh.cell_count()];
        side.reply(&Reply { potential: &density, e: &e, iterations: 3, residual: 1e-9, seconds: 0.5 })
            .expect("it lives");
    }
}

fn request<'a>(
    positions: &'a [Vector3<f64>],
    charges: &'a [f64],
    boundary: &'a [f64],
    cloud: SourceCloud,
) -> FarRequest<'a> {
    FarRequest {
        question: FarQuestion {
            cloud,
            permittivity_f_m: 2.0,
            neutralising_background: 0,
            time_s: 0.25,
            tolerance: 0.0,
            wants_e: 1,
        },
        positions,
        charges,
        image_positions: &[],
        image_charges: &[],
        density: &[],
        boundary,
        guess: &[],
    }
}

#[test]
fn mesh_and_fields_cross_the_wire_and_the_run_leaves_nothing() {
    let announced = Announced::new(settings(10.0)).expect("shared memory");
    let run = announced.run().to_owned();
    let name = run.clone();
    let field = std::thread::spawn(move || echo(&name));
    let mut remote = announced.connect().expect("the field side comes");
    let twin = BoxSolver::new(&domain(), [6, 5, 4]).expect("a good mesh");
    assert_eq!(remote.mesh().boundary(), twin.mesh().boundary());
    assert_eq!(
        (remote.mesh().domain(), remote.mesh().volumes()),
        (twin.mesh().domain(), twin.mesh().volumes())
    );
    assert!((0..120).all(|cell| remote.mesh().faces_of(cell) == twin.mesh().faces_of(cell)));

    let positions = [Vector3::new(0.0005, 0.0012, 0.0031), Vector3::new(0.0042, 0.0049, 0.0001)];
    let boundary = vec![0.5; twin.mesh().boundary().len()];
    let mut values = FarValues::default();
    // More and more charges: the publisher grows.
    for count in [2, 2000, 50_000] {
        let positions: Vec<_> = positions.iter().copied().cycle().take(count).collect();
        let charges: Vec<f64> = (0..count).map(|i| 1e-12 * (1 + i % 3) as f64).collect();
        let nearest = request(&positions, &charges, &boundary, SourceCloud::nearest_cell());
        remote.solve(&nearest, &mut values).expect("it answers");
        let total: f64 = values.potential.iter().zip(twin.mesh().volumes()).map(|(rho, v)| rho * v).sum();
        let sum: f64 = charges.iter().sum();
        assert!((total / sum - 1.0).abs() < 1e-12);
        assert_eq!((values.cells[0], values.cells[1]), (3 * 30 + 6, 4 * 6 + 4));
        assert_eq!((values.outside, values.iterations, values.residual), (0, 3, 1e-9));
        assert_eq!(values.e[7], Vector3::new(1.0, 2.0, 2.0));
    }
    let clouds = SourceCloud { radius_m: RADIUS, shape: 8.0 };
    remote.solve(&request(&positions, &[1e-12, 2e-12], &boundary, clouds), &mut values).expect("it answers");
    assert!(values.potential.iter().filter(|rho| **rho > 1e-6).count() > 20);

    drop(remote);
    field.join().expect("the field side leaves in peace");
    assert!(!std::path::Path::new("/dev/shm").join(&run).exists());
    let left = std::fs::read_dir("/dev/shm").expect("shared memory").flatten();
    assert!(left.into_iter().all(|entry| !entry.file_name().to_string_lossy().starts_with(&run)));
    assert!(!stale_runs(false).contains(&run));
}

#[test]
fn a_solver_that_never_comes_is_missed_in_time() {
    let error = Announced::new(settings(0.2)).expect("shared memory").connect().expect_err("nobody comes");
    assert!(error.to_string().contains("nobody started a field solver within"), "{error}");
}

#[test]
fn charges_that_are_no_numbers_end_the_field_side_and_it_says_why() {
    let announced = Announced::new(settings(10.0)).expect("shared memory");
    let name = announced.run().to_owned();
    let field = std::thread::spawn(move || {
        let solver = BoxSolver::new(&domain(), [6, 5, 4]).expect("a good mesh");
        let mut side = FieldSide::open(&name, 0, 1).expect("the run is there");
        side.send_mesh(&MeshArrays::of(solver.mesh()).part(solver.mesh()), 0).expect("a good mesh");
        side.wait().expect("the DEM side lives");
        let error = side.density(&mut [0.0; 120]).expect_err("no number");
        side.fail(&error.to_string());
        // The message must be taken before its publisher goes.
        std::thread::sleep(Duration::from_millis(200));
    });
    let mut remote = announced.connect().expect("the field side comes");
    let boundary = vec![0.0; remote.mesh().boundary().len()];
    let (positions, charges) = ([Vector3::repeat(0.001)], [f64::NAN]);
    let asked = request(&positions, &charges, &boundary, SourceCloud::nearest_cell());
    let error = remote.solve(&asked, &mut FarValues::default()).expect_err("no number");
    assert!(error.to_string().contains("field solver ended: grain at index 0"), "{error}");
    field.join().expect("it says why and leaves");
}
