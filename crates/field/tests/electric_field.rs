//! Properties that every method shares: faces with values, the external field, refusals, steady evaluations.

use amberfield_core::constants::VACUUM_PERMITTIVITY;
use amberfield_core::{Boundary, Domain, FieldSettings, Method, Tuning, Vector3};
use amberfield_field::{ElectricField, FieldError, FieldValues, Wanted};
use amberfield_oracle::ErrorNorms;

const EXTENT: f64 = 1e-3;
/// p3m is asked for this tolerance where it is compared with the direct sum.
const TOLERANCE: f64 = 1e-4;

fn settings(method: Method) -> FieldSettings {
    FieldSettings {
        method,
        tolerance: TOLERANCE,
        cutoff_radius_m: matches!(method, Method::Cutoff | Method::Kolehmainen).then_some(0.4 * EXTENT),
        tuning: Tuning::Model,
        ..FieldSettings::default()
    }
}

fn cloud() -> (Vec<Vector3<f64>>, Vec<f64>) {
    let position = |i: i32| {
        let at = |k: f64| EXTENT * (0.1 + 0.8 * (f64::from(i) * k).fract());
        Vector3::new(at(0.618_034), at(0.414_214), at(0.302_776))
    };
    ((0..150).map(position).collect(), (0..150).map(|i| 1e-14 * f64::from(i % 5 - 2)).collect())
}

fn domain(faces: [[Boundary; 2]; 3]) -> Domain {
    Domain::new(Vector3::zeros(), Vector3::repeat(EXTENT), faces).expect("a box")
}

fn evaluate(
    domain: &Domain,
    settings: &FieldSettings,
    positions: &[Vector3<f64>],
    charges: &[f64],
) -> Result<FieldValues, FieldError> {
    let mut values = FieldValues::default();
    let wanted = Wanted { potential: true, components: false };
    ElectricField::new(domain, settings, positions, charges)?.evaluate(
        positions,
        charges,
        wanted,
        &mut values,
    )?;
    Ok(values)
}

#[test]
fn electrodes_act_alike_on_direct_and_p3m() {
    let insulating = Boundary::Insulating { normal_field_v_m: 0.0 };
    let plates =
        [[Boundary::Periodic; 2], [insulating; 2], [Boundary::Potential(-3.0), Boundary::Potential(5.0)]];
    let one_face = [
        [Boundary::Potential(10.0), Boundary::Grounded],
        [Boundary::Grounded; 2],
        [insulating, Boundary::Grounded],
    ];
    let (positions, charges) = cloud();
    for faces in [plates, one_face] {
        let domain = domain(faces);
        let exact = evaluate(&domain, &settings(Method::Direct), &positions, &charges).unwrap();
        let p3m = evaluate(&domain, &settings(Method::P3m), &positions, &charges).unwrap();
        let scale = amberfield_oracle::rms(&exact.e);
        assert!(ErrorNorms::new(&p3m.e, &exact.e, scale).relative_rms < TOLERANCE);
        let uncharged = evaluate(&domain, &settings(Method::P3m), &positions, &[0.0; 150]).unwrap();
        assert!(amberfield_oracle::rms(&uncharged.e) > 0.0, "{faces:?}");
    }
}

#[test]
fn plates_without_charge_have_the_closed_field_in_every_method() {
    let plates = domain([
        [Boundary::Periodic; 2],
        [Boundary::Periodic; 2],
        [Boundary::Grounded, Boundary::Potential(5.0)],
    ]);
    let positions = [Vector3::new(2e-4, 3e-4, 4e-4), Vector3::new(7e-4, 6e-4, 9e-4)];
    for method in Method::ALL {
        let values = evaluate(&plates, &settings(method), &positions, &[0.0; 2]).unwrap();
        for e in &values.e {
            assert!(
                (e - Vector3::new(0.0, 0.0, -5.0 / EXTENT)).norm() < 1e-9 * 5.0 / EXTENT,
                "{method}: {e:?}"
            );
        }
    }
}

#[test]
fn places_without_charge_see_the_field_and_change_nothing() {
    let (mut positions, mut charges) = cloud();
    charges.iter_mut().for_each(|charge| *charge += 1e-15);
    let count = positions.len();
    // Twice the same place, next to a charge; and one that is far from all.
    positions.extend([positions[7] + Vector3::repeat(1e-3 * EXTENT); 2]);
    positions.push(Vector3::repeat(0.05 * EXTENT));
    charges.extend([0.0; 3]);
    for faces in [[Boundary::Grounded; 2], [Boundary::Open; 2]] {
        let domain = domain([faces; 3]);
        let exact = evaluate(&domain, &settings(Method::Direct), &positions, &charges).unwrap();
        for method in [Method::Direct, Method::P3m] {
            // Parameters are chosen for the charges.
            let (of_charges, settings) = (&positions[..count], settings(method));
            let mut field = ElectricField::new(&domain, &settings, of_charges, &charges[..count]).unwrap();
            let mut e_of = |count: usize| {
                let mut values = FieldValues::default();
                field
                    .evaluate(&positions[..count], &charges[..count], Wanted::default(), &mut values)
                    .unwrap();
                values.e
            };
            let (with, without) = (e_of(count + 3), e_of(count));
            let error = |e: &[Vector3<f64>], exact: &[Vector3<f64>]| {
                ErrorNorms::new(e, exact, amberfield_oracle::rms(exact)).relative_rms
            };
            assert!(error(&with[..count], &without) < 1e-6, "{method} {faces:?}");
            assert!(error(&with[count..], &exact.e[count..]) < TOLERANCE, "{method} {faces:?}");
            assert_eq!(with[count], with[count + 1], "{method} {faces:?}");
        }
    }
}

#[test]
fn the_external_field_is_added_once_by_every_method() {
    let (positions, charges) = cloud();
    let periodic = domain([[Boundary::Periodic; 2]; 3]);
    let external = Vector3::new(1e3, -2e3, 5e2);
    for method in Method::ALL {
        let without = evaluate(&periodic, &settings(method), &positions, &charges).unwrap();
        let with = FieldSettings { external_field_v_m: external, ..settings(method) };
        let with = evaluate(&periodic, &with, &positions, &charges).unwrap();
        for (i, position) in positions.iter().enumerate() {
            assert!((with.e[i] - without.e[i] - external).norm() < 1e-10 * with.e[i].norm(), "{method}");
            let change = -external.dot(&(position - periodic.centre()));
            assert!(
                (with.potential[i] - without.potential[i] - change).abs()
                    < 1e-10 * with.potential[i].abs().max(1.0)
            );
        }
    }
}

#[test]
fn a_net_charge_needs_a_face_that_takes_it() {
    let (positions, mut charges) = cloud();
    charges[0] += 1e-14;
    let net: f64 = charges.iter().sum();
    let periodic = domain([[Boundary::Periodic; 2]; 3]);
    for method in [Method::Direct, Method::Kolehmainen, Method::P3m] {
        let refused = evaluate(&periodic, &settings(method), &positions, &charges);
        assert!(matches!(refused, Err(FieldError::NetCharge { .. })), "{method}");
        let with_background = FieldSettings { neutralising_background: true, ..settings(method) };
        assert!(evaluate(&periodic, &with_background, &positions, &charges).is_ok(), "{method}");
    }
    // A normal field that takes exactly the net charge needs no background.
    let flux = net / (VACUUM_PERMITTIVITY * EXTENT * EXTENT);
    let insulating = |normal_field_v_m| Boundary::Insulating { normal_field_v_m };
    let taken =
        domain([[Boundary::Periodic; 2], [Boundary::Periodic; 2], [insulating(0.0), insulating(flux)]]);
    let exact = evaluate(&taken, &settings(Method::Direct), &positions, &charges).unwrap();
    let p3m = evaluate(&taken, &settings(Method::P3m), &positions, &charges).unwrap();
    assert!(ErrorNorms::new(&p3m.e, &exact.e, amberfield_oracle::rms(&exact.e)).relative_rms < TOLERANCE);
}

#[test]
fn bad_requests_are_refused_with_advice() {
    let (positions, charges) = cloud();
    let open = domain([[Boundary::Open; 2]; 3]);
    let message = |settings: &FieldSettings, positions: &[Vector3<f64>]| {
        evaluate(&open, settings, positions, &charges).unwrap_err().to_string()
    };
    let no_radius = FieldSettings { cutoff_radius_m: None, ..settings(Method::Cutoff) };
    assert!(message(&no_radius, &positions).contains("field_cutoff_radius"));
    let mut bad = positions.clone();
    bad[7].y = f64::NAN;
    assert!(message(&settings(Method::P3m), &bad).contains("index 7"));
    bad[7].y = 2.0 * EXTENT;
    let fixed = FieldSettings { grid_cells: Some([16; 3]), ..settings(Method::P3m) };
    assert!(message(&fixed, &bad).contains("outside the domain"));
    let hopeless =
        FieldSettings { grid_cells: Some([2; 3]), cutoff_radius_m: Some(1e-4), ..settings(Method::P3m) };
    assert!(message(&hopeless, &positions).contains("change field_cutoff_radius or grid.cells"));
}

#[test]
fn a_cut_off_below_the_distance_of_the_grains_meets_the_tolerance() {
    let domain = domain([[Boundary::Grounded; 2]; 3]);
    let (positions, charges) = cloud();
    let mut asked = settings(Method::P3m);
    let distance = (domain.volume() / positions.len() as f64).cbrt();
    asked.cutoff_radius_m = Some(0.4 * distance);
    let field = ElectricField::new(&domain, &asked, &positions, &charges).unwrap();
    let measured = field.error_measured().unwrap().relative_rms;
    assert!(measured <= asked.tolerance, "{measured}");
}
