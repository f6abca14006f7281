//! Conductors of any shape against exact fields.

use amberfield_core::{
    Boundary, Conductor, ConductorState, Domain, FieldSettings, Method, Permittivity, TriangleMesh, Tuning,
    Vector3,
};
use amberfield_field::{Choice, ElectricField, FieldValues, Wanted};
use amberfield_oracle::reference::{self, Charges};
use amberfield_oracle::{rms, surfaces};
use nalgebra::Rotation3;
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn coulomb() -> f64 {
    Permittivity::VACUUM.coulomb()
}

fn open_box(half: f64) -> Domain {
    Domain::new(Vector3::repeat(-half), Vector3::repeat(half), [[Boundary::Open; 2]; 3]).expect("a box")
}

fn settings(surface: TriangleMesh, state: ConductorState) -> FieldSettings {
    FieldSettings {
        tuning: Tuning::Model,
        conductors: vec![Conductor { name: "body.stl".into(), surface, state }],
        ..FieldSettings::default()
    }
}

/// Field of charges, and the error that is stated.
fn field(domain: &Domain, settings: &FieldSettings, charges: &Charges) -> (Vec<Vector3<f64>>, f64, Vec<f64>) {
    let Charges { position, charge, .. } = charges;
    let mut field = ElectricField::new(domain, settings, position, charge).expect("a field");
    let mut values = FieldValues::default();
    field.evaluate(position, charge, Wanted::default(), &mut values).expect("finite values");
    let stated = field.error_measured().expect("a measured error").relative_rms;
    (values.e, stated, field.potentials_of_conductors())
}

/// Charges of the conductors [C] over the unit of the problem.
fn charges_of_conductors(domain: &Domain, settings: &FieldSettings, charges: &Charges) -> Vec<f64> {
    let Charges { position, charge, .. } = charges;
    let mut field = ElectricField::with_choice(domain, settings, &Choice::Direct).expect("a field");
    let at_rest = vec![Vector3::zeros(); position.len()];
    let values = field.values_of_conductors(position, charge, &at_rest).expect("finite values");
    values.iter().map(|values| values.charge_c).collect()
}

#[test]
fn conductors_have_the_charge_that_the_reference_has() {
    let problem = surfaces::sphere_inside();
    let of_sphere = settings(problem.surface.clone(), ConductorState::Potential(7.0));
    let found = charges_of_conductors(&open_box(2.0), &of_sphere, &problem.charges)[0];
    let expected = surfaces::total("sphere_inside", "charge of the wall");
    // A cavity has minus the charge within it, and outside of it what its potential asks for: V/k R, R = 1.
    let expected = expected + 7.0 / coulomb();
    let of_charges: f64 = problem.charges.charge.iter().map(|charge| charge.abs()).sum();
    assert!((found - expected).abs() < 2e-3 * of_charges, "{found} {expected} of {of_charges}");

    let problem = surfaces::disc_potential();
    let volts = coulomb() * surfaces::total("disc_potential", "potential of the disc (given)");
    let of_disc = settings(problem.surface.clone(), ConductorState::Potential(volts));
    let found = charges_of_conductors(&open_box(2.0), &of_disc, &problem.charges)[0];
    let expected = surfaces::total("disc_potential", "charge of the disc");
    let of_charges: f64 = problem.charges.charge.iter().map(|charge| charge.abs()).sum();
    assert!((found - expected).abs() < 1e-2 * of_charges, "{found} {expected} of {of_charges}");
}

/// Two spheres of radius 1 and 0.5 about (0, 0, 0) and (0, 0, 2.5): with charges as in free space they
/// induce each other, and potentials tell the charges by Maxwell's images.
fn two_spheres() -> [TriangleMesh; 2] {
    let unit = surfaces::sphere_inside().surface;
    let small = |vertex: &Vector3<f64>| 0.5 * vertex + Vector3::z() * 2.5;
    let other = TriangleMesh { vertices: unit.vertices.iter().map(small).collect(), ..unit.clone() };
    [unit, other]
}

/// Charges of two spheres at potentials V and W over Coulomb's constant, by images of images
/// (Maxwell, A Treatise on Electricity and Magnetism, §173).
fn charges_of_two_spheres(potentials: [f64; 2]) -> [f64; 2] {
    let (radii, centres) = ([1.0, 0.5], [0.0, 2.5]);
    let mut total = [0.0; 2];
    for (first, potential) in potentials.into_iter().enumerate() {
        let (mut at, mut within, mut charge) = (centres[first], first, potential * radii[first]);
        for _ in 0..60 {
            total[within] += charge;
            within = 1 - within;
            let apart: f64 = at - centres[within];
            charge *= -radii[within] / apart.abs();
            at = centres[within] + radii[within] * radii[within] / apart;
        }
    }
    total
}

#[test]
fn two_spheres_have_maxwells_charges_and_a_charge_that_passes_makes_ramos_current() {
    let volts = [3.0 * coulomb(), -2.0 * coulomb()];
    let bodies = two_spheres();
    let settings_at = |states: &[ConductorState]| {
        let conductors = bodies.iter().zip(states).map(|(surface, &state)| Conductor {
            name: "sphere.stl".into(),
            surface: surface.clone(),
            state,
        });
        FieldSettings { method: Method::Direct, conductors: conductors.collect(), ..FieldSettings::default() }
    };
    let position = [Vector3::new(0.3, -1.2, 0.9), Vector3::new(-0.4, 0.2, 3.4)];
    let velocity = [Vector3::new(2.0, 3.0, -1.0), Vector3::new(-1.0, 0.5, 1.5)];
    let charge = [1.5, -0.7];
    let values = |settings: &FieldSettings, position: &[Vector3<f64>], charge: &[f64]| {
        let mut field =
            ElectricField::with_choice(&open_box(6.0), settings, &Choice::Direct).expect("a field");
        let mut out = FieldValues::default();
        field.evaluate(position, charge, Wanted::default(), &mut out).expect("finite values");
        field.values_of_conductors(position, charge, &velocity).expect("finite values")
    };
    // No charges: images of images.
    let at_volts = settings_at(&volts.map(ConductorState::Potential));
    let found = values(&at_volts, &position, &[0.0; 2]);
    for (found, expected) in found.iter().zip(charges_of_two_spheres([3.0, -2.0])) {
        assert!((found.charge_c / expected - 1.0).abs() < 5e-3, "{found:?} {expected}");
        assert_eq!(found.current_a, 0.0);
    }
    // One sphere alone before charges: −q R/r, and its change with time.
    let alone = settings_at(&[ConductorState::Potential(0.0)]);
    let found = values(&alone, &position, &charge)[0];
    let (mut expected, mut current) = (0.0, 0.0);
    for ((x, v), q) in position.iter().zip(&velocity).zip(&charge) {
        expected -= q / x.norm();
        current += q * x.dot(v) / x.norm().powi(3);
    }
    assert!((found.charge_c / expected - 1.0).abs() < 5e-3, "{found:?} {expected}");
    assert!((found.current_a / current - 1.0).abs() < 1e-2, "{found:?} {current}");
    // Floating spheres have the charge that is given, at the potential that this charge makes.
    let given = charges_of_two_spheres([3.0, -2.0]);
    let found = values(&settings_at(&given.map(ConductorState::Charge)), &position, &[0.0; 2]);
    for ((found, given), volts) in found.iter().zip(given).zip(volts) {
        assert_eq!((found.charge_c, found.current_a), (given, 0.0));
        assert!((found.potential_v / volts - 1.0).abs() < 5e-3, "{found:?} {volts}");
    }
    // The current is the change of the charge, with both spheres there and at potentials.
    let step = 1e-4;
    let moved = |by: f64| -> Vec<_> { position.iter().zip(&velocity).map(|(x, v)| x + v * by).collect() };
    let [before, now, after] = [-step, 0.0, step].map(|by| values(&at_volts, &moved(by), &charge));
    for k in 0..2 {
        let change = (after[k].charge_c - before[k].charge_c) / (2.0 * step);
        assert!((now[k].current_a / change - 1.0).abs() < 2e-2, "{:?} {change}", now[k]);
    }
}

/// Asserts the error of E over its RMS, all charges together and the worst one, and the stated error.
fn check(name: &str, found: (Vec<Vector3<f64>>, f64), charges: &Charges, most: [f64; 2]) {
    let (e, stated) = found;
    let difference: Vec<Vector3<f64>> = e.iter().zip(&charges.e).map(|(a, b)| a / coulomb() - b).collect();
    let all = rms(&difference) / rms(&charges.e);
    let worst = difference.iter().map(|d| d.norm()).fold(0.0, f64::max) / rms(&charges.e);
    assert!(all < most[0] && worst < most[1], "{name}: {all:.2e}, worst {worst:.2e}");
    assert!(all < 2.0 * stated && stated < 2.0 * all, "{name}: {all:.2e}, stated {stated:.2e}");
}

#[test]
fn grounded_sphere_around_grains() {
    let problem = surfaces::sphere_inside();
    for method in [Method::P3m, Method::Direct] {
        let settings =
            FieldSettings { method, ..settings(problem.surface.clone(), ConductorState::Potential(0.0)) };
        let (e, stated, _) = field(&open_box(2.0), &settings, &problem.charges);
        check(method.name(), (e, stated), &problem.charges, [1e-2, 3e-2]);
    }
}

#[test]
fn floating_sphere_in_a_uniform_field() {
    let problem = surfaces::sphere_floating();
    let total = |quantity| surfaces::total("sphere_floating", quantity);
    let external = ["uniform field x", "uniform field y", "uniform field z"].map(total);
    let state = ConductorState::Charge(total("total charge of the sphere (given)"));
    let settings = FieldSettings {
        external_field_v_m: coulomb() * Vector3::from(external),
        ..settings(problem.surface, state)
    };
    let (e, stated, potentials) = field(&open_box(2.0), &settings, &problem.charges);
    check("floating sphere", (e, stated), &problem.charges, [1e-2, 3e-2]);
    let potential = potentials[0] / coulomb() / total("potential of the sphere");
    assert!((potential - 1.0).abs() < 2e-3, "{potential}");
}

/// Grains on both sides of a sheet have no images in it: facets are too large for them, which is told.
#[test]
fn thin_disc_with_grains_on_both_sides_says_how_much_it_errs() {
    let problem = surfaces::disc_potential();
    let volts = coulomb() * surfaces::total("disc_potential", "potential of the disc (given)");
    let settings = settings(problem.surface, ConductorState::Potential(volts));
    let (e, stated, _) = field(&open_box(2.0), &settings, &problem.charges);
    check("thin disc", (e, stated), &problem.charges, [0.2, 1.1]);
}

/// A cube's faces as triangles, so many squares along each edge.
fn cube(squares: u32) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    for axis in 0..3 {
        for side in [0.0, 1.0] {
            let first = mesh.vertices.len() as u32;
            for i in 0..=squares {
                for j in 0..=squares {
                    let mut corner = Vector3::zeros();
                    corner[axis] = side;
                    corner[(axis + 1) % 3] = f64::from(i) / f64::from(squares);
                    corner[(axis + 2) % 3] = f64::from(j) / f64::from(squares);
                    mesh.vertices.push(corner);
                }
            }
            for i in 0..squares {
                for j in 0..squares {
                    let at = |i: u32, j: u32| first + i * (squares + 1) + j;
                    let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)];
                    mesh.triangles.extend([[a, b, d], [a, d, c]]);
                }
            }
        }
    }
    mesh
}

#[test]
fn faces_of_a_grounded_box_are_the_boxs_own() {
    for name in ["c_grounded_box_bip_2000", "c_grounded_box_gau_net_2000"] {
        let set = reference::by_name(name).unwrap();
        let charges = Charges {
            position: set.position.clone(),
            charge: set.charge.clone(),
            potential: set.potential.clone(),
            e: set.e.clone(),
        };
        let around = Domain::new(Vector3::repeat(-0.2), Vector3::repeat(1.2), [[Boundary::Open; 2]; 3])
            .expect("a box");
        let settings = settings(cube(11), ConductorState::Potential(0.0));
        let (e, stated, _) = field(&around, &settings, &charges);
        check(name, (e, stated), &charges, [1e-2, 3e-2]);
    }
}

#[test]
fn order_orientation_and_frame_do_not_matter() {
    let problem = surfaces::sphere_inside();
    let count = 150;
    let Charges { position, charge, .. } = &problem.charges;
    let charges = Charges {
        position: position[..count].to_vec(),
        charge: charge[..count].to_vec(),
        potential: Vec::new(),
        e: Vec::new(),
    };
    let e = |surface: TriangleMesh, charges: &Charges| {
        let settings = FieldSettings {
            method: Method::Direct,
            tolerance: 1e-4,
            ..settings(surface, ConductorState::Potential(0.0))
        };
        let mut field =
            ElectricField::with_choice(&open_box(3.0), &settings, &Choice::Direct).expect("a field");
        let mut values = FieldValues::default();
        field
            .evaluate(&charges.position, &charges.charge, Wanted::default(), &mut values)
            .expect("finite values");
        values.e
    };
    let plain = e(problem.surface.clone(), &charges);
    let scale = rms(&plain);
    let mut random = ChaCha8Rng::seed_from_u64(5);

    let mut mixed = problem.surface.clone();
    mixed.triangles.shuffle(&mut random);
    for triangle in &mut mixed.triangles {
        triangle.rotate_left(random.random_range(0..3));
        if random.random_range(0..2) == 0 {
            triangle.swap(0, 1);
        }
    }
    let other = e(mixed, &charges);
    let worst = plain.iter().zip(&other).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    assert!(worst < 1e-4 * scale, "{:.2e}", worst / scale);

    let turn = Rotation3::from_euler_angles(0.3, -0.7, 1.9);
    let shift = Vector3::new(0.2, -0.1, 0.3);
    let mut surface = problem.surface;
    surface.vertices.iter_mut().for_each(|x| *x = turn * *x + shift);
    let turned =
        Charges { position: charges.position.iter().map(|x| turn * x + shift).collect(), ..charges.clone() };
    let other = e(surface, &turned);
    let worst = plain.iter().zip(&other).map(|(a, b)| (turn * a - b).norm()).fold(0.0, f64::max);
    assert!(worst < 1e-4 * scale, "{:.2e}", worst / scale);
}
