//! The parts of E add up to E, whatever the method and the box: near + middle + far + correction + faces +
//! external.

use amberfield_core::{Boundary, Domain, FieldSettings, Method, Tuning, Vector3};
use amberfield_field::{BoundaryField, Components, ElectricField, FieldValues, Wanted};

const EXTENT: f64 = 1e-3;
const INSULATING: Boundary = Boundary::Insulating { normal_field_v_m: 0.0 };
/// A few roundings of the largest part.
const ROUND_OFF: f64 = 1e-14;

fn settings(method: Method) -> FieldSettings {
    FieldSettings {
        method,
        tolerance: 1e-2,
        cutoff_radius_m: matches!(method, Method::Cutoff | Method::Kolehmainen).then_some(0.4 * EXTENT),
        tuning: Tuning::Model,
        external_field_v_m: Vector3::new(1e4, -2e4, 3e3),
        ..FieldSettings::default()
    }
}

fn domain(faces: [[Boundary; 2]; 3]) -> Domain {
    Domain::new(Vector3::zeros(), Vector3::repeat(EXTENT), faces).expect("a box")
}

/// Grains of both signs, neutral together.
fn cloud(count: i32) -> (Vec<Vector3<f64>>, Vec<f64>) {
    let position = |i: i32| {
        let at = |k: f64| EXTENT * (0.1 + 0.8 * (f64::from(i) * k).fract());
        Vector3::new(at(0.618_034), at(0.414_214), at(0.302_776))
    };
    ((0..count).map(position).collect(), (0..count).map(|i| 1e-14 * f64::from(i % 5 - 2)).collect())
}

fn evaluate(domain: &Domain, settings: &FieldSettings, count: i32) -> FieldValues {
    let (positions, charges) = cloud(count);
    let mut values = FieldValues::default();
    let wanted = Wanted { potential: true, components: true };
    ElectricField::new(domain, settings, &positions, &charges)
        .expect("a good scene")
        .evaluate(&positions, &charges, wanted, &mut values)
        .expect("a good scene");
    values
}

/// Boxes with electrodes, normal fields, open space and periodic axes, and how many grains are in them:
/// enough for a grid in open space, where few are summed pair by pair.
fn boxes() -> Vec<(Domain, i32)> {
    let plates = [Boundary::Potential(-3.0), Boundary::Potential(5.0)];
    let electrode = [Boundary::Potential(10.0), Boundary::Grounded];
    let normal_field = Boundary::Insulating { normal_field_v_m: 2e3 };
    [
        ([[Boundary::Periodic; 2]; 3], 150),
        ([[Boundary::Periodic; 2], [INSULATING; 2], plates], 150),
        ([electrode, [Boundary::Grounded; 2], [INSULATING, Boundary::Grounded]], 150),
        ([[Boundary::Periodic; 2], [Boundary::Periodic; 2], [Boundary::Grounded, normal_field]], 150),
        ([[Boundary::Periodic; 2], [Boundary::Periodic; 2], [Boundary::Potential(7.0), Boundary::Open]], 150),
        ([[Boundary::Open; 2]; 3], 150),
        ([[Boundary::Open; 2]; 3], 20_000),
    ]
    .map(|(faces, count)| (domain(faces), count))
    .to_vec()
}

fn parts(components: &Components) -> [&Vec<Vector3<f64>>; 6] {
    let Components { near, middle, far, correction, faces, external } = components;
    [near, middle, far, correction, faces, external]
}

#[test]
fn the_six_parts_add_up_to_the_field() {
    for (domain, count) in boxes() {
        for method in Method::ALL.into_iter().filter(|method| count < 1000 || *method == Method::P3m) {
            let values = evaluate(&domain, &settings(method), count);
            let parts = parts(&values.components);
            for (particle, e) in values.e.iter().enumerate() {
                let sum: Vector3<f64> = parts.iter().map(|part| part[particle]).sum();
                let largest: f64 = parts.iter().map(|part| part[particle].norm()).fold(0.0, f64::max);
                assert!((sum - e).norm() <= ROUND_OFF * largest, "{method} {domain:?}: {sum} for {e}");
            }
        }
    }
}

#[test]
fn faces_and_external_field_are_parts_of_their_own() {
    for (domain, count) in boxes() {
        let positions = cloud(count).0;
        for method in [Method::P3m, Method::Direct, Method::Cutoff] {
            if count > 1000 && method != Method::P3m {
                continue;
            }
            let settings = settings(method);
            let values = evaluate(&domain, &settings, count);
            let faces = BoundaryField::new(&domain).expect("a good scene");
            for (particle, position) in positions.iter().enumerate() {
                let expected = faces.as_ref().map_or_else(Vector3::zeros, |faces| faces.evaluate(position).e);
                let found = values.components.faces[particle];
                let most = settings.tolerance * expected.norm();
                assert!((found - expected).norm() <= most, "{method} {domain:?}: {found} for {expected}");
                assert_eq!(values.components.external[particle], settings.external_field_v_m);
            }
        }
    }
}

#[test]
fn a_part_that_is_not_there_is_zero() {
    let (positions, charges) = cloud(150);
    for method in Method::ALL {
        let settings = FieldSettings { external_field_v_m: Vector3::zeros(), ..settings(method) };
        let periodic = domain([[Boundary::Periodic; 2]; 3]);
        let mut values = FieldValues::default();
        let wanted = Wanted { potential: false, components: true };
        let mut field = ElectricField::new(&periodic, &settings, &positions, &charges).expect("a good scene");
        field.evaluate(&positions, &charges, wanted, &mut values).expect("a good scene");

        let Components { middle, far, correction, faces, external, .. } = &values.components;
        let is_zero =
            |part: &[Vector3<f64>]| part.len() == 150 && part.iter().all(|e| *e == Vector3::zeros());
        assert!(is_zero(middle) && is_zero(faces) && is_zero(external), "{method}");
        assert_eq!(is_zero(far), method == Method::Cutoff, "{method}");
        assert_eq!(is_zero(correction), method != Method::Kolehmainen, "{method}");
        assert!(values.potential.is_empty(), "{method}");
    }
}
