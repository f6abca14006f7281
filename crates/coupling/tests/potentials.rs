//! Potentials of patches that change with time: the field is that of their values, whoever tells them.

use amberfield_core::{
    Axis, Boundary, Course, CourseRow, Domain, FaceCourse, FieldSettings, Method, Side, Tuning, Vector3,
};
use amberfield_coupling::{Announced, BoxSolver, FieldSide, MeshArrays, Question, Reply, SolverSettings};
use amberfield_field::far::{FarField, Look};
use amberfield_field::{ElectricField, FieldValues, Wanted};
use std::time::Duration;

const COUNTS: [usize; 3] = [6, 6, 5];
const WANTED: Wanted = Wanted { potential: true, components: false };

/// Box whose lid has a potential, and a side another one; `None`: they change with time.
fn domain(values: Option<[f64; 2]>) -> Domain {
    let [lid, side] = values.unwrap_or_default().map(Boundary::Potential);
    let faces = [[Boundary::Grounded, side], [Boundary::Grounded; 2], [Boundary::Grounded, lid]];
    let domain = Domain::new(Vector3::zeros(), Vector3::new(0.006, 0.006, 0.005), faces).expect("a good box");
    if values.is_some() { domain } else { domain.with_courses(courses()) }
}

fn courses() -> Vec<FaceCourse> {
    let sine = Course::Sine { amplitude: 400.0, frequency_hz: 50.0, phase: 0.3, offset: 100.0 };
    let rows = [(0.0, 20.0), (0.01, 500.0), (0.03, -300.0)];
    let rows = rows.map(|(time_s, value)| CourseRow { time_s, value }).to_vec();
    let table = Course::Table { name: "v.csv".into(), rows };
    vec![
        FaceCourse { axis: Axis::Z, side: Side::Max, course: sine },
        FaceCourse { axis: Axis::X, side: Side::Max, course: table },
    ]
}

fn values_at(time_s: f64) -> [f64; 2] {
    let courses = courses();
    [0, 1].map(|k| courses[k].course.at(time_s))
}

fn charges() -> (Vec<Vector3<f64>>, Vec<f64>) {
    let at = |i: u32, k: f64, size: f64| size * (0.05 + 0.9 * (f64::from(i) * k).fract());
    let place = |i| Vector3::new(at(i, 0.618_034, 6e-3), at(i, 0.414_214, 6e-3), at(i, 0.302_776, 5e-3));
    let charge = |i: u32| if i.is_multiple_of(2) { 1e-13 } else { -1e-13 };
    ((1..41).map(place).collect(), (1..41).map(charge).collect())
}

fn settings(method: Method) -> FieldSettings {
    let cutoff_radius_m = (method == Method::Kolehmainen).then_some(2e-3);
    FieldSettings { method, cutoff_radius_m, tuning: Tuning::Model, ..FieldSettings::default() }
}

fn field_over(solver: BoxSolver, method: Method) -> ElectricField {
    let (positions, charges) = charges();
    ElectricField::over_mesh(Box::new(solver), &settings(method), &positions, &charges).expect("a good scene")
}

fn evaluated(field: &mut ElectricField) -> FieldValues {
    let (positions, charges) = charges();
    let mut values = FieldValues::default();
    field.evaluate(&positions, &charges, WANTED, &mut values).expect("a good scene");
    values
}

fn largest(e: &[Vector3<f64>]) -> f64 {
    e.iter().map(|e| e.norm()).fold(0.0, f64::max)
}

#[test]
fn field_is_that_of_the_potentials_of_its_time() {
    for method in [Method::P3m, Method::Kolehmainen] {
        let over = |values| BoxSolver::new(&domain(Some(values)), COUNTS).expect("a good box");
        let changing = BoxSolver::changing(&domain(None), COUNTS).expect("a good box");
        let mut changing = field_over(changing, method);
        assert!(changing.changes());
        for time_s in [0.0, 0.0123, 0.05] {
            changing.set_time(time_s);
            let now = evaluated(&mut changing);
            let solver = Box::new(over(values_at(time_s)));
            let constant = ElectricField::over_mesh_with_choice(solver, &settings(method), changing.choice());
            let constant = evaluated(&mut constant.expect("a good scene"));
            let apart: Vec<_> = now.e.iter().zip(&constant.e).map(|(a, b)| a - b).collect();
            assert!(largest(&apart) < 1e-6 * largest(&constant.e), "{method} {time_s}");
            let volts = now.potential.iter().zip(&constant.potential).map(|(a, b)| (a - b).abs());
            assert!(volts.fold(0.0, f64::max) < 1e-4, "{method} {time_s}");
        }
        let plain = field_over(over([0.0; 2]), method);
        assert!(!plain.changes());
    }
}

#[test]
fn looks_ahead_end_where_a_line_does() {
    let solver = BoxSolver::changing(&domain(None), COUNTS).expect("a good box");
    let mut field = field_over(solver, Method::P3m);
    let mut followed = |time_s: f64, look: Look| {
        field.set_time(time_s);
        field.far_solver_mut().expect("a solver").look_ahead(look);
        evaluated(&mut field);
        field.far_solver().expect("a solver").followed().expect("it has looked")
    };
    // At the sine's crest, t = (1/4 - 0.3/2π)/f, the line misses 2 % of its range, 4 % of its amplitude,
    // after √0.04/(2πf) when the interval before was as long.
    let crest = (0.25 - 0.3 / std::f64::consts::TAU) / 50.0;
    let steps = followed(crest, Look { before: 64, step_s: 1e-5, most: 400 });
    assert!((60..66).contains(&steps), "{steps}");
    // A short look is not longer than it is.
    assert_eq!(followed(crest, Look { before: 3, step_s: 1e-5, most: 6 }), 6);
}

/// A field process that has those potentials, and answers with the density in place of a potential.
fn answer(run: &str) {
    let solver = BoxSolver::changing(&domain(None), COUNTS).expect("a good box");
    let mesh = solver.mesh();
    let mut side = FieldSide::open(run, 0, 1).expect("the run is there");
    side.send_mesh(&MeshArrays::of(mesh).part(mesh), 0).expect("a good mesh");
    while let Some(question) = side.wait().expect("the DEM side lives") {
        if question == Question::Potentials {
            let times = side.times().expect("times").to_vec();
            let potentials: Vec<f64> =
                courses().iter().flat_map(|face| times.iter().map(|t| face.course.at(*t))).collect();
            side.reply_potentials(&potentials).expect("it lives");
            continue;
        }
        let mut density = vec![0.0; mesh.cell_count()];
        side.density(&mut density).expect("good charges");
        side.reply(&Reply { potential: &density, e: &[], iterations: 3, residual: 0.0, seconds: 0.5 })
            .expect("it lives");
    }
}

#[test]
fn potentials_cross_the_wire() {
    let timeout = Duration::from_secs(10);
    let settings = SolverSettings { timeout, wait: Some(timeout), ..SolverSettings::awaited("none") };
    let announced = Announced::new(settings).expect("shared memory");
    let run = announced.run().to_owned();
    let field = std::thread::spawn(move || answer(&run));
    let mut remote = announced.connect().expect("the field side comes");
    // The lid is the last of six patches, the side is the second.
    assert_eq!(remote.mesh().changing(), [5, 1]);
    let mut values = Vec::new();
    for times in [vec![0.0], vec![0.01, 0.02, 0.5], (0..9000).map(|k| f64::from(k) * 1e-5).collect()] {
        remote.potentials(&times, &mut values).expect("it answers");
        let of_patch = |k: usize| times.iter().map(move |t| values_at(*t)[k]);
        assert_eq!(values, of_patch(0).chain(of_patch(1)).collect::<Vec<_>>());
    }
    drop(remote);
    field.join().expect("the field side leaves in peace");
}
