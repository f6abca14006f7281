//! A rank on another machine: with letters that a proxy takes and gives, the DEM side sees no difference.

use amberfield_core::{Boundary, Domain, FarQuestion, SourceCloud, Vector3};
use amberfield_coupling::{
    Announced, BoxSolver, FieldSide, MeshArrays, Proxy, Reply, RunRoot, SolverSettings,
};
use amberfield_field::far::{FarField, FarRequest, FarValues};
use std::time::Duration;

/// Cells of the box.
const CELLS: [usize; 3] = [6, 5, 4];

fn solver() -> BoxSolver {
    let faces = [[Boundary::Periodic; 2], [Boundary::Grounded; 2], [Boundary::Grounded; 2]];
    let domain = Domain::new(Vector3::zeros(), Vector3::new(0.006, 0.005, 0.004), faces);
    BoxSolver::new(&domain.expect("a good box"), CELLS).expect("a good mesh")
}

/// A solver that answers with the density in place of a potential, and with what it is to start from as E.
fn answer(side: &mut FieldSide, cells: usize, faces: usize) {
    let mut density = vec![0.0; cells];
    side.density(&mut density).expect("good charges");
    let boundary = side.boundary(faces).expect("one number a face")[faces - 1];
    let guess = side.guess().expect("one number a cell").map_or(0.0, |guess| guess[cells - 1]);
    let e = vec![[boundary, guess, 0.0]; cells];
    let reply = Reply { potential: &density, e: &e, iterations: 3, residual: 1e-9, seconds: 0.5 };
    side.reply(&reply).expect("the DEM side lives");
}

/// A rank that sees the run's memory.
fn near(run: &str) {
    let solver = solver();
    let mesh = solver.mesh();
    let mut side = FieldSide::open(run, 0, 1).expect("the run is there");
    side.send_mesh(&MeshArrays::of(mesh).part(mesh), 0).expect("a good mesh");
    while side.wait().expect("the DEM side lives").is_some() {
        answer(&mut side, mesh.cell_count(), mesh.boundary().len());
    }
    assert!(side.letter().is_none());
}

/// A rank that does not, and its proxy.
fn distant(run: &str) {
    assert!(RunRoot::is_here(run) && !RunRoot::is_here(&format!("{run}0")));
    let solver = solver();
    let mesh = solver.mesh();
    let mut proxy = Proxy::open(run, 0, 1).expect("the run is there");
    let mut side = FieldSide::open_distant(run, 0, 1).expect("a good name");
    assert!(side.wait().is_err(), "no letter has come");
    side.send_mesh(&MeshArrays::of(mesh).part(mesh), 0).expect("a good mesh");
    let letter = side.letter().expect("a mesh");
    assert!(proxy.send(&letter.bytes()[..500]).is_err(), "half a letter");
    proxy.send(letter.bytes()).expect("the DEM side lives");
    while let Some(letter) = proxy.wait().expect("the DEM side lives") {
        side.deliver(letter.bytes()).expect("a message");
        assert!(side.wait().expect("a message").is_some());
        answer(&mut side, mesh.cell_count(), mesh.boundary().len());
        proxy.send(side.letter().expect("an answer").bytes()).expect("the DEM side lives");
    }
}

/// Answers to a question for clouds, and to one for charges in cells.
fn answers(field: fn(&str)) -> Vec<FarValues> {
    let timeout = Duration::from_secs(20);
    let settings = SolverSettings { timeout, wait: Some(timeout), ..SolverSettings::awaited("none") };
    let announced = Announced::new(settings).expect("shared memory");
    let run = announced.run().to_owned();
    let field = std::thread::spawn(move || field(&run));
    let mut remote = announced.connect().expect("the field side comes");
    let positions: Vec<_> =
        (0..50).map(|i| Vector3::new(0.006, 0.005, 0.004) * (f64::from(i) + 0.5) / 50.0).collect();
    let charges: Vec<f64> = (0..50).map(|i| 1e-12 * f64::from(1 + i % 3)).collect();
    let count = CELLS.iter().product();
    let (density, guess): (Vec<f64>, Vec<f64>) =
        (0..count).map(|cell| (1e-6 * cell as f64, cell as f64)).unzip();
    let boundary: Vec<f64> = (0..remote.mesh().boundary().len()).map(|face| face as f64).collect();
    let mut all = Vec::new();
    for cloud in [SourceCloud { radius_m: 1e-3, shape: 8.0 }, SourceCloud::nearest_cell()] {
        let request = FarRequest {
            question: FarQuestion {
                cloud,
                permittivity_f_m: 2.0,
                neutralising_background: 0,
                time_s: 0.25,
                tolerance: 0.0,
                wants_e: 1,
            },
            positions: &positions,
            charges: &charges,
            image_positions: &positions[..5],
            image_charges: &charges[..5],
            density: if cloud.is_nearest_cell() { &[] } else { &density },
            boundary: &boundary,
            guess: &guess,
        };
        let mut values = FarValues::default();
        remote.solve(&request, &mut values).expect("it answers");
        all.push(values);
    }
    drop(remote);
    field.join().expect("the field side leaves in peace");
    all
}

#[test]
fn a_rank_on_another_machine_answers_as_one_on_this() {
    for (near, distant) in answers(near).iter().zip(answers(distant)) {
        assert_eq!(near.potential, distant.potential);
        assert_eq!((&near.e, &near.cells), (&distant.e, &distant.cells));
        assert_eq!((near.iterations, near.outside), (distant.iterations, distant.outside));
    }
}
