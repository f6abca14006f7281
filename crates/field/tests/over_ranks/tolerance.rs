//! Parameters that ranks choose together: the tolerance is met, and the error is told as it is.

use super::shared::{Scene, choose_and_run, spread_out};
use super::{AXES, INSULATING};
use amberfield_core::{Boundary, Domain, FieldSettings, Method, Vector3};
use amberfield_field::{Choice, ElectricField, FieldValues, Wanted};

/// An error that is found by another order of adding.
const SAME: f64 = 1e-9;
/// Parameters whose first look at the field adds in another order, in single precision.
const SAME_CHOICE: f64 = 1e-6;

fn scene(faces: [[Boundary; 2]; 3], tolerance: f64) -> Scene {
    let domain = Domain::new(Vector3::zeros(), Vector3::new(1e-3, 1.2e-3, 0.9e-3), faces).unwrap();
    let mut scene = Scene::neutral(domain, 500, 11);
    scene.settings.tolerance = tolerance;
    scene.settings.external_field_v_m = Vector3::zeros();
    scene
}

fn exact(scene: &Scene) -> Vec<Vector3<f64>> {
    let settings = FieldSettings { method: Method::Direct, ..scene.settings.clone() };
    let mut field = ElectricField::new(&scene.domain, &settings, &scene.positions, &scene.charges).unwrap();
    let mut values = FieldValues::default();
    field.evaluate(&scene.positions, &scene.charges, Wanted::default(), &mut values).unwrap();
    values.e
}

fn rms(vectors: impl Iterator<Item = Vector3<f64>>) -> f64 {
    let squares: Vec<f64> = vectors.map(|vector| vector.norm_squared()).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn tolerance_is_met_and_the_error_told_for_any_number_of_ranks() {
    let grounded_gap = [AXES[0], [INSULATING; 2], AXES[1]];
    for (faces, tolerance) in
        [([AXES[0]; 3], 1e-2), (grounded_gap, 1e-4), ([AXES[1], AXES[5], AXES[0]], 1e-3)]
    {
        let scene = scene(faces, tolerance);
        let exact = exact(&scene);
        for ranks in [1, 2, 4] {
            let parts = spread_out(&scene, ranks);
            let outcomes = choose_and_run(&scene, &parts, |field, positions, charges, values| {
                let stated = field.error_measured().unwrap().relative_rms;
                let again = field.measure_error(positions, charges).unwrap().unwrap().relative_rms;
                assert!((again / stated - 1.0).abs() < SAME, "{again:e} {stated:e}");
                (values.e.clone(), stated)
            });
            let found: Vec<_> = outcomes.into_iter().map(Result::unwrap).collect();
            let stated = found[0].1;
            assert!(found.iter().all(|(_, other)| other.to_bits() == stated.to_bits()));
            let pairs = parts.iter().zip(&found).flat_map(|(part, (e, _))| part.iter().zip(e));
            let error = rms(pairs.map(|(&number, e)| e - exact[number])) / rms(exact.iter().copied());
            assert!(error <= tolerance, "{faces:?}, {ranks} ranks: {error:e} for {tolerance:e}");
            assert!(stated <= 2.0 * error && error <= 2.0 * stated, "{stated:e} is stated for {error:e}");
        }
    }
}

#[test]
fn ranks_choose_what_one_process_chooses() {
    for faces in [[AXES[0]; 3], [AXES[1], AXES[2], AXES[0]], [AXES[4], AXES[0], AXES[5]]] {
        let scene = scene(faces, 1e-3);
        let one =
            ElectricField::new(&scene.domain, &scene.settings, &scene.positions, &scene.charges).unwrap();
        let Choice::P3m(expected) = one.choice().clone() else { panic!("{:?}", one.choice()) };
        for ranks in [2, 3] {
            let parts = spread_out(&scene, ranks);
            for choice in choose_and_run(&scene, &parts, |field, _, _, _| field.choice().clone()) {
                let Ok(Choice::P3m(found)) = choice else { panic!("{choice:?}") };
                assert_eq!(found.order, expected.order);
                for (a, b) in [
                    (found.cutoff_m, expected.cutoff_m),
                    (found.spacing_m, expected.spacing_m),
                    (found.cloud_shape, expected.cloud_shape),
                    (found.window_shape, expected.window_shape),
                    (found.kernel_accuracy, expected.kernel_accuracy),
                ] {
                    assert!((a / b - 1.0).abs() < SAME_CHOICE, "{found:?} for {expected:?}");
                }
            }
        }
    }
}

#[test]
fn charges_that_come_later_find_a_field() {
    let mut scene = scene([AXES[0]; 3], 1e-2);
    let charges = std::mem::replace(&mut scene.charges, vec![0.0; 500]);
    let parts = spread_out(&scene, 3);
    let outcomes = choose_and_run(&scene, &parts, |field, positions, _, values| {
        assert!(field.error_measured().is_none());
        assert!(values.e.iter().all(|e| e.norm() == 0.0));
        positions.len()
    });
    assert_eq!(outcomes.into_iter().map(Result::unwrap).sum::<usize>(), charges.len());
}
