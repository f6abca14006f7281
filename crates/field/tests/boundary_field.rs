//! The field of electrodes and of normal fields on faces, against closed forms, series and Laplace's
//! equation.

use amberfield_core::{Boundary, Domain, Vector3};
use amberfield_field::{BoundaryField, FieldAt};
use std::f64::consts::PI;

/// Round-off of closed forms.
const ROUND_OFF: f64 = 1e-13;
/// Relative error that the quadrature promises.
const QUADRATURE: f64 = 1e-10;

const GROUNDED: [Boundary; 2] = [Boundary::Grounded; 2];
const PERIODIC: [Boundary; 2] = [Boundary::Periodic; 2];
const OPEN: [Boundary; 2] = [Boundary::Open; 2];
const INSULATING: [Boundary; 2] = [insulating(0.0); 2];

const fn insulating(normal_field_v_m: f64) -> Boundary {
    Boundary::Insulating { normal_field_v_m }
}

const fn volts(potential: f64) -> Boundary {
    Boundary::Potential(potential)
}

fn build(extent: [f64; 3], faces: [[Boundary; 2]; 3]) -> BoundaryField {
    let domain = Domain::new(Vector3::zeros(), Vector3::from(extent), faces).expect("a valid box");
    BoundaryField::new(&domain).expect("solvable").expect("some value is not zero")
}

fn assert_close(value: f64, expected: f64, tolerance: f64, what: &str) {
    assert!(
        (value - expected).abs() <= tolerance * expected.abs().max(1.0),
        "{what}: {value} not {expected}"
    );
}

#[test]
fn zero_values_build_nothing() {
    for faces in [[GROUNDED; 3], [PERIODIC, INSULATING, GROUNDED], [OPEN; 3], [[volts(0.0); 2]; 3]] {
        let domain = Domain::new(Vector3::zeros(), Vector3::repeat(1.0), faces).unwrap();
        assert_eq!(BoundaryField::new(&domain), Ok(None));
    }
}

#[test]
fn parallel_plates_are_linear() {
    for sides in [PERIODIC, INSULATING, OPEN] {
        let plates = build([1.0, 1.0, 0.02], [sides, sides, [volts(-300.0), volts(700.0)]]);
        assert!(plates.is_uniform());
        let FieldAt { e, potential } = plates.evaluate(&Vector3::new(0.3, 0.9, 0.005));
        assert_close(e.z, -50_000.0, ROUND_OFF, "E");
        assert_close(potential, -50.0, ROUND_OFF, "V");
    }
}

#[test]
fn one_plate_and_an_insulator_or_nothing() {
    let at = Vector3::new(0.3, 0.9, 0.005);
    let FieldAt { e, potential } =
        build([1.0, 1.0, 0.02], [PERIODIC, PERIODIC, [volts(5.0), insulating(100.0)]]).evaluate(&at);
    assert_eq!(e, Vector3::new(0.0, 0.0, 100.0));
    assert_close(potential, 5.0 - 0.5, ROUND_OFF, "plate below, field out of the top");
    let FieldAt { e, potential } =
        build([1.0, 1.0, 0.02], [PERIODIC, PERIODIC, [insulating(100.0), volts(5.0)]]).evaluate(&at);
    assert_eq!(e, Vector3::new(0.0, 0.0, -100.0));
    assert_close(potential, 5.0 - 100.0 * 0.015, ROUND_OFF, "plate above, field out of the bottom");
    let half = build([1.0, 1.0, 0.02], [PERIODIC, PERIODIC, [volts(5.0), Boundary::Open]]);
    assert_eq!(half.evaluate(&at), FieldAt::of_potential(5.0));
    let free = build([1.0, 1.0, 0.02], [OPEN, OPEN, [Boundary::Open, insulating(7.0)]]);
    assert_eq!(free.evaluate(&at).e, Vector3::new(0.0, 0.0, 7.0));
}

#[test]
fn insulating_box_balances_its_flux_by_a_background() {
    let field = build([2.0, 1.0, 1.0], [[insulating(3.0), insulating(5.0)], PERIODIC, INSULATING]);
    assert!(!field.is_uniform());
    let e = |x: f64| field.evaluate(&Vector3::new(x, 0.2, 0.7)).e.x;
    assert_close(e(0.0), -3.0, ROUND_OFF, "lower face");
    assert_close(e(2.0), 5.0, ROUND_OFF, "upper face");
    assert_close(e(0.5), -1.0, ROUND_OFF, "linear between");
    // Simpson's rule is exact for the quadratic potential.
    let at = |x: f64| field.evaluate(&Vector3::new(x, 0.2, 0.7)).potential;
    assert_close((at(0.0) + 4.0 * at(1.0) + at(2.0)) / 6.0, 0.0, ROUND_OFF, "mean potential");
}

#[test]
fn equal_potentials_have_no_field() {
    let field = build([1.0, 2.0, 3.0], [[volts(42.0); 2], [volts(42.0); 2], [volts(42.0), insulating(0.0)]]);
    assert_eq!(field.evaluate(&Vector3::new(0.1, 0.2, 0.3)), FieldAt::of_potential(42.0));
}

/// φ = Σ_odd 4V/(nπ) sin(nπy) sinh(nπx)/sinh(nπ) in a square duct with its face x = 1 at V.
fn duct_series(x: f64, y: f64) -> (f64, f64, f64) {
    let (mut potential, mut ex, mut ey) = (0.0, 0.0, 0.0);
    for n in (1..400).step_by(2) {
        let k = f64::from(n) * PI;
        let decay = (-k * (1.0 - x)).exp() / (1.0 - (-2.0 * k).exp());
        let (sinh, cosh) = (decay * (1.0 - (-2.0 * k * x).exp()), decay * (1.0 + (-2.0 * k * x).exp()));
        potential += 4.0 / k * (k * y).sin() * sinh;
        ex -= 4.0 * (k * y).sin() * cosh;
        ey -= 4.0 * (k * y).cos() * sinh;
    }
    (potential, ex, ey)
}

#[test]
fn square_duct_agrees_with_its_series() {
    for length in [PERIODIC, INSULATING, OPEN] {
        let duct = build([1.0, 1.0, 0.3], [[Boundary::Grounded, volts(1.0)], GROUNDED, length]);
        for (x, y) in [(0.5, 0.5), (0.1, 0.3), (0.9, 0.02), (0.001, 0.999), (0.4, 1e-6), (0.93, 0.95)] {
            let FieldAt { e, potential } = duct.evaluate(&Vector3::new(x, y, 0.1));
            let (expected, ex, ey) = duct_series(x, y);
            assert_close(potential, expected, QUADRATURE, "V");
            assert_close(e.x, ex, QUADRATURE, "Ex");
            assert_close(e.y, ey, QUADRATURE, "Ey");
            assert!(e.z.abs() < QUADRATURE);
        }
    }
}

#[test]
fn duct_between_insulator_and_plate_is_half_of_a_wider_duct() {
    // x from an insulating mirror plane: the duct of width 2 with both sides at V is symmetric about it.
    let half = build([1.0, 1.0, 1.0], [[insulating(0.0), volts(2.0)], GROUNDED, PERIODIC]);
    let whole = build([2.0, 1.0, 1.0], [[volts(2.0); 2], GROUNDED, PERIODIC]);
    let turned = build([1.0, 1.0, 1.0], [[volts(2.0), insulating(0.0)], GROUNDED, PERIODIC]);
    for (x, y) in [(0.01, 0.4), (0.5, 0.2), (0.97, 0.999)] {
        let half = half.evaluate(&Vector3::new(x, y, 0.0));
        let whole = whole.evaluate(&Vector3::new(1.0 + x, y, 0.0));
        let turned = turned.evaluate(&Vector3::new(1.0 - x, y, 0.0));
        let scale = whole.e.norm();
        assert_close(half.potential, whole.potential, QUADRATURE, "V");
        assert_close(turned.potential, whole.potential, QUADRATURE, "V turned");
        assert!((half.e - whole.e).norm() < QUADRATURE * scale);
        let mirrored = half.e.component_mul(&Vector3::new(-1.0, 1.0, 1.0));
        assert!((mirrored - turned.e).norm() < QUADRATURE * scale);
    }
}

#[test]
fn centre_of_a_cube_has_a_sixth_of_one_face() {
    for face in 0..6 {
        let mut faces = [GROUNDED; 3];
        faces[face / 2][face % 2] = volts(600.0);
        let centre = build([1e-4; 3], faces).evaluate(&Vector3::repeat(0.5e-4));
        assert_close(centre.potential, 100.0, QUADRATURE, "centre");
    }
}

/// Quarter space between perpendicular plates at V and 0: φ = V(2/π) atan(y/x).
#[test]
fn open_corner_of_two_plates_is_an_angle() {
    let corner =
        build([1.0, 1.0, 1.0], [[volts(3.0), Boundary::Open], [Boundary::Grounded, Boundary::Open], OPEN]);
    for (x, y) in [(0.5_f64, 0.5_f64), (0.01, 0.3), (0.9, 0.001)] {
        let FieldAt { e, potential } = corner.evaluate(&Vector3::new(x, y, 0.2));
        let square = x * x + y * y;
        assert_close(potential, 3.0 * 2.0 / PI * y.atan2(x), QUADRATURE, "V");
        assert_close(e.x, 6.0 / PI * y / square, QUADRATURE, "Ex");
        assert_close(e.y, -6.0 / PI * x / square, QUADRATURE, "Ey");
    }
}

/// A mixed box: every kind of face that a closed box can have beside each other, with values.
fn mixed() -> BoundaryField {
    build(
        [1.0, 1.4, 0.8],
        [[volts(3.0), insulating(2.0)], [volts(-1.0), volts(5.0)], [insulating(-4.0), Boundary::Grounded]],
    )
}

fn points() -> Vec<Vector3<f64>> {
    vec![
        Vector3::new(0.5, 0.7, 0.4),
        Vector3::new(0.11, 0.2, 0.7),
        Vector3::new(0.95, 1.3, 0.07),
        Vector3::new(0.3, 0.05, 0.1),
    ]
}

#[test]
fn field_is_minus_the_gradient_and_has_no_sources() {
    const STEP: f64 = 1e-4;
    let field = mixed();
    for x in points() {
        let e = field.evaluate(&x).e;
        let mut divergence = 0.0;
        for axis in 0..3 {
            let mut step = Vector3::zeros();
            step[axis] = STEP;
            let (below, above) = (field.evaluate(&(x - step)), field.evaluate(&(x + step)));
            // Central differences: STEP² times third derivatives of some hundreds.
            assert_close(-(above.potential - below.potential) / (2.0 * STEP), e[axis], 1e-5, "gradient");
            divergence += (above.e[axis] - below.e[axis]) / (2.0 * STEP);
        }
        assert!(divergence.abs() < 1e-3 * e.norm(), "divergence {divergence} at {x:?}");
    }
}

#[test]
fn faces_keep_their_values() {
    const CLOSE: f64 = 1e-9;
    let field = mixed();
    for (x, potential) in [
        (Vector3::new(CLOSE, 0.6, 0.3), 3.0),
        (Vector3::new(0.4, CLOSE, 0.3), -1.0),
        (Vector3::new(0.4, 1.4 - CLOSE, 0.3), 5.0),
        (Vector3::new(0.4, 0.6, 0.8 - CLOSE), 0.0),
    ] {
        // The field is some tens of V/m: the potential moves by 1e-7 at most over the distance.
        assert_close(field.evaluate(&x).potential, potential, 1e-7, "potential at the face");
    }
    assert_close(field.evaluate(&Vector3::new(1.0 - CLOSE, 0.6, 0.3)).e.x, 2.0, 1e-6, "E·n, upper x");
    assert_close(field.evaluate(&Vector3::new(0.4, 0.6, CLOSE)).e.z, 4.0, 1e-6, "E·n, lower z");
}

#[test]
fn all_faces_superpose_and_tolerance_is_kept() {
    let domain = |faces| Domain::new(Vector3::zeros(), Vector3::new(1.0, 1.4, 0.8), faces).unwrap();
    let mut faces = [GROUNDED; 3];
    faces[1] = [insulating(0.0); 2];
    let mut one_by_one = vec![FieldAt::default(); points().len()];
    for face in [0, 1, 4, 5] {
        let mut faces = faces;
        faces[face / 2][face % 2] = volts(8.0);
        let field = BoundaryField::new(&domain(faces)).unwrap().unwrap();
        for (sum, x) in one_by_one.iter_mut().zip(points()) {
            *sum += field.evaluate(&x);
        }
    }
    for FieldAt { e, potential } in one_by_one {
        assert_close(potential, 8.0, QUADRATURE, "sum of potentials");
        assert!(e.norm() < 8.0 * QUADRATURE * 10.0, "sum of fields {e:?}");
    }
    faces[0][0] = volts(8.0);
    let fine = BoundaryField::new(&domain(faces)).unwrap().unwrap();
    for tolerance in [1e-3, 1e-6, 1e-9] {
        let coarse = BoundaryField::with_tolerance(&domain(faces), tolerance).unwrap().unwrap();
        for x in points() {
            let (exact, approximate) = (fine.evaluate(&x), coarse.evaluate(&x));
            assert!((exact.potential - approximate.potential).abs() < 8.0 * tolerance);
            assert!((exact.e - approximate.e).norm() < exact.e.norm().max(8.0) * tolerance);
        }
    }
}

#[test]
fn fluxes_without_an_end_are_refused_by_name() {
    let refused = |faces| {
        let domain = Domain::new(Vector3::zeros(), Vector3::repeat(1.0), faces).unwrap();
        BoundaryField::new(&domain).unwrap_err().to_string()
    };
    let one_sided = refused([[insulating(0.0), insulating(1.0)], PERIODIC, OPEN]);
    assert!(one_sided.contains("do not cancel"), "{one_sided}");
    let half = [Boundary::Grounded, Boundary::Open];
    let beside = refused([[insulating(0.0), insulating(1.0)], PERIODIC, half]);
    assert!(beside.contains("x_max"), "{beside}");
}
