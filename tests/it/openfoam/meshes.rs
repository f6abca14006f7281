//! Fields on meshes of many shapes, with curved walls and cells that are not cubes.

#![expect(clippy::print_stdout, reason = "how good it is, for whoever asks with --nocapture")]

use super::{AGREEMENT, difference};
use amberfield_core::{
    Boundary, Domain, FarQuestion, FieldSettings, Permittivity, SourceCloud, Tuning, Vector3,
};
use amberfield_coupling::{Announced, RemoteSolver, SolverSettings};
use amberfield_field::far::{Condition, FarField, FarMesh, FarRequest, FarValues};
use amberfield_field::{ElectricField, FieldValues, Wanted};
use amberfield_oracle::{GroundedCylinder, grounded_cavity, observed_order, reference};
use amberfield_tests::Workbench;
use amberfield_tests::foam_case::{
    Random, ball, brick, cube, cylinder, foam_program, perturb, tetrahedra, write_case, write_potential,
};
use std::time::Duration;

const GROUNDED: &str = "\".*\" { type fixedValue; value uniform 0; }";
const CHARGE: f64 = 1e-12;
/// Edge of the cube [mm].
const EDGE: f64 = 12.0;

/// Case with a recipe of a mesh, which the solver makes.
pub(super) fn case(mesh: &str, gradient: &str) -> Workbench {
    let bench = Workbench::new("");
    write_case(&bench, mesh, GROUNDED, gradient);
    bench
}

pub(super) fn solver(bench: &Workbench) -> RemoteSolver {
    let settings = SolverSettings {
        timeout: Duration::from_secs(60),
        far_tolerance: 1e-7,
        ..SolverSettings::started(bench.path("foam"), bench.path("solver"))
    };
    Announced::new(settings).and_then(Announced::connect).expect("the solver answers")
}

fn settings(tolerance: f64) -> FieldSettings {
    FieldSettings { tolerance, tuning: Tuning::Model, ..FieldSettings::default() }
}

/// Charged grains that do not touch, the first fifth of them at the walls.
struct ChargedGrains {
    /// Positions [m].
    positions: Vec<Vector3<f64>>,
    /// Charges [C].
    charges: Vec<f64>,
}

/// Makes charged grains of a radius [m]; `place` draws a point inside or, where its flag is set, one at a
/// wall.
fn cloud(
    count: usize,
    radius: f64,
    bipolar: bool,
    place: impl Fn(&mut Random, bool) -> Vector3<f64>,
) -> ChargedGrains {
    let mut random = Random(7);
    let mut positions: Vec<Vector3<f64>> = Vec::new();
    while positions.len() < count {
        let next = place(&mut random, positions.len() < count / 5);
        if positions.iter().all(|other| (other - next).norm() > 2.0 * radius) {
            positions.push(next);
        }
    }
    let charge = |index: usize| if bipolar && index % 2 == 1 { -CHARGE } else { CHARGE };
    ChargedGrains { positions, charges: (0..count).map(charge).collect() }
}

fn evaluate(field: &mut ElectricField, positions: &[Vector3<f64>], charges: &[f64]) -> Vec<Vector3<f64>> {
    let mut values = FieldValues::default();
    field.evaluate(positions, charges, Wanted::default(), &mut values).expect("good charges");
    values.e
}

/// Errors of a field, over the RMS field.
struct Errors {
    /// RMS error over all grains.
    rms: f64,
    /// Largest error of the first fifth, which touch walls.
    worst: f64,
}

/// Errors of a field against the exact one.
fn errors(found: &[Vector3<f64>], exact: &[Vector3<f64>]) -> Errors {
    let rms = |e: &[Vector3<f64>]| (e.iter().map(Vector3::norm_squared).sum::<f64>() / e.len() as f64).sqrt();
    let apart: Vec<_> = found.iter().zip(exact).map(|(a, b)| a - b).collect();
    let worst = apart[..apart.len() / 5].iter().map(Vector3::norm).fold(0.0, f64::max);
    Errors { rms: rms(&apart) / rms(exact), worst: worst / rms(exact) }
}

fn unit_vector(random: &mut Random) -> Vector3<f64> {
    loop {
        let v = Vector3::from_fn(|_, _| 2.0 * random.number() - 1.0);
        if (0.01..1.0).contains(&v.norm_squared()) {
            return v.normalize();
        }
    }
}

#[test]
fn in_a_ball_the_field_is_that_of_kelvins_images() {
    const RADIUS: f64 = 6e-3;
    const GRAIN: f64 = 2e-4;
    let bench = case(&ball(6.0, 10, 6), "leastSquares");
    let place = |random: &mut Random, at_wall: bool| {
        let depth = if at_wall { 1.0 } else { random.number().cbrt() };
        unit_vector(random) * (RADIUS - GRAIN) * depth
    };
    let exact = |positions: &[Vector3<f64>], charges: &[f64]| {
        grounded_cavity(Permittivity::VACUUM.coulomb(), RADIUS, positions, charges)
    };
    for bipolar in [true, false] {
        let ChargedGrains { positions, charges } = cloud(2000, GRAIN, bipolar, place);
        let mut field = ElectricField::over_mesh(
            std::boxed::Box::new(solver(&bench)),
            &settings(5e-3),
            &positions,
            &charges,
        )
        .unwrap();
        let Errors { rms, worst } =
            errors(&evaluate(&mut field, &positions, &charges), &exact(&positions, &charges));
        println!("ball, of both signs: {bipolar}: RMS {rms:.2e}, worst at the wall {worst:.2e}");
        assert!(rms < 1.5e-2 && worst < 3e-2, "{rms:e} {worst:e}");
        // A single grain that touches the wall feels its own image.
        for position in &positions[..5] {
            let (one, own) = ([*position], exact(&[*position], &[CHARGE])[0]);
            let error = (evaluate(&mut field, &one, &[CHARGE])[0] - own).norm() / own.norm();
            assert!(error < 3e-2, "{error:e}");
        }
    }
}

#[test]
fn in_a_cylinder_the_field_is_that_of_the_fourier_bessel_series() {
    const GRAIN: f64 = 3e-4;
    let exact =
        GroundedCylinder { coulomb_constant: Permittivity::VACUUM.coulomb(), radius: 6e-3, length: 12e-3 };
    let bench = case(&cylinder(6.0, 12.0, [10, 14], 6), "leastSquares");
    let place = |random: &mut Random, at_wall: bool| {
        let angle = std::f64::consts::TAU * random.number();
        let radius = (exact.radius - GRAIN) * if at_wall { 1.0 } else { random.number().sqrt() };
        let z = GRAIN + random.number() * (exact.length - 2.0 * GRAIN);
        Vector3::new(radius * angle.cos(), radius * angle.sin(), z)
    };
    for bipolar in [true, false] {
        let ChargedGrains { positions, charges } = cloud(60, GRAIN, bipolar, place);
        let mut field = ElectricField::over_mesh(
            std::boxed::Box::new(solver(&bench)),
            &settings(5e-3),
            &positions,
            &charges,
        )
        .unwrap();
        let Errors { rms, worst } =
            errors(&evaluate(&mut field, &positions, &charges), &exact.field(&positions, &charges));
        println!("cylinder, of both signs: {bipolar}: RMS {rms:.2e}, worst at the wall {worst:.2e}");
        assert!(rms < 1.5e-2 && worst < 3e-2, "{rms:e} {worst:e}");
    }
}

/// Case of the exact boxes of the reference set, on 16³ cells.
#[test]
fn reference_boxes_come_out_on_cubes() {
    let (wall, lid, cyclic) = (
        ("wall", "type fixedValue; value uniform 0;"),
        ("wall", "type zeroGradient;"),
        ("cyclic", "type cyclic;"),
    );
    for (name, [x, y, z]) in [
        ("b_periodic_bip_2000", [cyclic; 3]),
        ("c_grounded_box_bip_2000", [wall; 3]),
        ("c_grounded_box_gau_net_2000", [wall; 3]),
        ("d_grounded_z_periodic_xy_net_2000", [cyclic, cyclic, wall]),
        ("d_grounded_z_insulating_xy_net_2000", [lid, lid, wall]),
        ("d_insulating_box_neutral_2000", [lid; 3]),
    ] {
        let set = reference::by_name(name).expect("the set is there");
        let edges: [f64; 3] = (set.domain.extent() * 1e3).into();
        let brick = brick(edges, [16; 3], &[x, x, y, y, z, z]);
        let bench = Workbench::new("");
        write_case(&bench, &brick.mesh, &brick.conditions, "Gauss linear");
        let solver = std::boxed::Box::new(solver(&bench));
        let mut field =
            ElectricField::over_mesh(solver, &settings(1e-2), &set.position, &set.charge).unwrap();
        let found = evaluate(&mut field, &set.position, &set.charge);
        let Errors { rms, .. } = errors(&found, &set.field_si(Permittivity::VACUUM.coulomb()));
        println!("{name}: RMS {rms:.2e}");
        assert!(rms < AGREEMENT, "{name}: {rms:e}");
    }
}

/// Mesh of the cube with one kind of cells.
pub(super) fn mesh_of(kind: &str, cells: usize) -> Workbench {
    let grading = if kind == "graded" { 2.0 } else { 1.0 };
    let gradient = if kind == "hexahedra" { "Gauss linear" } else { "leastSquares" };
    let bench = case(&cube(EDGE, cells, grading), gradient);
    match kind {
        "perturbed" => {
            foam_program(&bench, "blockMesh", &[]);
            perturb(&bench, EDGE, cells, 0.2);
        }
        "tetrahedra" => tetrahedra(&bench, EDGE, cells, false),
        "polyhedra" => tetrahedra(&bench, EDGE, cells, true),
        _ => {}
    }
    bench
}

fn errs_little(kind: &str, cells: usize) {
    const GRAIN: f64 = 2.5e-4;
    let bench = mesh_of(kind, cells);
    let edge = 1e-3 * EDGE;
    let place = |random: &mut Random, at_wall: bool| {
        let mut point = Vector3::from_fn(|_, _| GRAIN + random.number() * (edge - 2.0 * GRAIN));
        if at_wall {
            let side = random.number() * 6.0;
            point[side as usize % 3] = if side < 3.0 { GRAIN } else { edge - GRAIN };
        }
        point
    };
    let domain = Domain::new(Vector3::zeros(), Vector3::repeat(edge), [[Boundary::Grounded; 2]; 3]).unwrap();
    for bipolar in [true, false] {
        let ChargedGrains { positions, charges } = cloud(3000, GRAIN, bipolar, place);
        let solver = solver(&bench);
        let size = (edge.powi(3) / solver.mesh().cell_count() as f64).cbrt();
        let mut field =
            ElectricField::over_mesh(std::boxed::Box::new(solver), &settings(5e-3), &positions, &charges)
                .unwrap();
        let mut exact = ElectricField::new(&domain, &settings(1e-5), &positions, &charges).unwrap();
        let [found, truth] = [&mut field, &mut exact].map(|field| evaluate(field, &positions, &charges));
        let Errors { rms, worst } = errors(&found, &truth);
        println!("{kind}, of both signs: {bipolar}: RMS {rms:.2e}, worst at the wall {worst:.2e}");
        assert!(rms < 2e-2, "{kind}: {rms:e}");
        // A single charge exerts no force on itself.
        let unit = Permittivity::VACUUM.coulomb() * CHARGE / (size * size);
        for position in positions.iter().skip(600).step_by(300) {
            let [found, truth] =
                [&mut field, &mut exact].map(|field| evaluate(field, &[*position], &[CHARGE])[0]);
            let error = (found - truth).norm() / unit;
            assert!(error < 1e-2, "{kind}: self-force {error:e} at {position:?}");
        }
    }
}

#[test]
fn hexahedra_err_little() {
    errs_little("hexahedra", 12);
}

#[test]
fn graded_hexahedra_err_little() {
    errs_little("graded", 12);
}

#[test]
fn perturbed_hexahedra_err_little() {
    errs_little("perturbed", 12);
}

#[test]
fn tetrahedra_err_little() {
    errs_little("tetrahedra", 7);
}

#[test]
fn polyhedra_err_little() {
    errs_little("polyhedra", 8);
}

/// a, b, c of a potential V = exp(ax) sin(by) cos(cz) with a² = b² + c² [1/m].
const WAVE: [f64; 3] = [250.0, 150.0, 200.0];

fn potential(p: &Vector3<f64>) -> f64 {
    (WAVE[0] * p.x).exp() * (WAVE[1] * p.y).sin() * (WAVE[2] * p.z).cos()
}

/// E of that potential.
fn field_of_potential(p: &Vector3<f64>) -> Vector3<f64> {
    let growth = (WAVE[0] * p.x).exp();
    let [(sine_y, cosine_y), (sine_z, cosine_z)] = [(WAVE[1] * p.y).sin_cos(), (WAVE[2] * p.z).sin_cos()];
    let slope = [WAVE[0] * sine_y * cosine_z, WAVE[1] * cosine_y * cosine_z, -WAVE[2] * sine_y * sine_z];
    -growth * Vector3::from(slope)
}

/// Question for the far field without charges.
fn without_charges<'a>(boundary: &'a [f64], wants_e: u64) -> FarRequest<'a> {
    let question = FarQuestion {
        cloud: SourceCloud::nearest_cell(),
        permittivity_f_m: 1.0,
        neutralising_background: 0,
        time_s: 0.0,
        tolerance: 0.0,
        wants_e,
    };
    FarRequest {
        question,
        positions: &[],
        charges: &[],
        image_positions: &[],
        image_charges: &[],
        density: &[],
        boundary,
        guess: &[],
    }
}

/// Gives the potential at the centres of a case's faces, as a user would.
fn give_potential(bench: &Workbench, mesh: &FarMesh) {
    let mut conditions = String::new();
    for (index, patch) in mesh.patches().iter().enumerate() {
        let faces = mesh.boundary().iter().filter(|face| face.patch as usize == index);
        let values: Vec<String> = faces.map(|face| format!("{:e}", potential(&face.centre))).collect();
        if !values.is_empty() {
            let list = format!("nonuniform List<scalar> {} ({})", values.len(), values.join(" "));
            conditions += &format!("{} {{ type fixedValue; value {list}; }} ", patch.name);
        }
    }
    write_potential(bench, &conditions);
}

/// Compares E at the cells' centres with the gradient that OpenFOAM finds there.
#[test]
fn no_probe_errs_much_more_than_openfoams_own_gradient() {
    for (kind, cells) in [("hexahedra", 12), ("perturbed", 12), ("tetrahedra", 7), ("polyhedra", 8)] {
        let bench = mesh_of(kind, cells);
        let mesh = solver(&bench).mesh().clone();
        give_potential(&bench, &mesh);
        let mut solver = solver(&bench);
        let given = |face: &amberfield_field::far::BoundaryFace| match face.condition {
            Condition::Potential(volts) | Condition::Slope(volts) => volts,
        };
        let boundary: Vec<f64> = solver.mesh().boundary().iter().map(given).collect();
        let mut values = FarValues::default();
        solver.solve(&without_charges(&boundary, 1), &mut values).expect("it answers");
        let probes = mesh.centres().to_vec();
        let none = vec![0.0; probes.len()];
        let mut field =
            ElectricField::over_mesh(std::boxed::Box::new(solver), &settings(1e-2), &probes, &none).unwrap();
        let found = evaluate(&mut field, &probes, &none);
        let worst = |found: &[Vector3<f64>]| {
            let errors = found.iter().zip(&probes).map(|(e, at)| (e - field_of_potential(at)).norm());
            errors.fold(0.0, f64::max)
        };
        let (ours, openfoams) = (worst(&found), worst(&values.e));
        println!("{kind}: worst error of E {ours:.2e} V/m, of OpenFOAM's gradient {openfoams:.2e} V/m");
        assert!(ours < 3.0 * openfoams, "{kind}: {ours:e} V/m for {openfoams:e}");
    }
}

/// Case of [`potential`], given at the walls and compared at the centres of cells.
#[test]
fn a_manufactured_potential_converges_with_the_cells() {
    for (kind, counts, least) in [
        ("hexahedra", [12, 24], 1.8),
        ("perturbed", [12, 24], 1.0),
        ("tetrahedra", [6, 12], 1.0),
        ("polyhedra", [6, 12], 1.0),
    ] {
        let error = counts.map(|cells| {
            let mut solver = solver(&mesh_of(kind, cells));
            let faces = 0..solver.mesh().boundary().len();
            let boundary: Vec<f64> =
                faces.map(|face| potential(&solver.mesh().place_of_condition(face))).collect();
            let exact: Vec<f64> = solver.mesh().centres().iter().map(potential).collect();
            let mut values = FarValues::default();
            solver.solve(&without_charges(&boundary, 1), &mut values).expect("it answers");
            difference(&values.potential, &exact)
        });
        let order = observed_order(&[2.0, 1.0], &error);
        println!("{kind}: errors {:.2e} {:.2e}, order {order:.2}", error[0], error[1]);
        assert!(order > least, "{kind}: order {order} of {error:?}");
    }
}
