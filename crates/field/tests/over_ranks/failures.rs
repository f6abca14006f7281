//! Refusals: what one rank refuses, all refuse with the same words; none waits for a rank that has gone.

use super::AXES;
use super::shared::{Scene, choose_and_run, on_ranks, parameters, spread_out};
use amberfield_core::{Domain, Method, Vector3};
use amberfield_field::{ElectricField, FieldError, FieldValues, Wanted};

fn scene() -> Scene {
    let domain = Domain::new(Vector3::zeros(), Vector3::repeat(1e-3), [AXES[1], AXES[0], AXES[0]]).unwrap();
    Scene::neutral(domain, 30, 5)
}

/// Words of each of three ranks.
fn words(scene: &Scene) -> Vec<String> {
    let outcomes = choose_and_run(scene, &spread_out(scene, 3), |_, _, _, _| ());
    outcomes.into_iter().map(|outcome| outcome.unwrap_err().to_string()).collect()
}

#[test]
fn what_one_rank_refuses_all_refuse() {
    let mut outside = scene();
    outside.positions[7].x = 2e-3;
    let mut odd = scene();
    odd.charges[3] = f64::NAN;
    let mut net = scene();
    net.domain = Domain::new(Vector3::zeros(), Vector3::repeat(1e-3), [AXES[0]; 3]).unwrap();
    net.charges[0] = 0.0;
    let mut direct = scene();
    direct.settings.method = Method::Direct;
    for (scene, expected) in [
        (outside, "on or beyond a face"),
        (odd, "not finite"),
        (net, "net charge"),
        (direct, "cannot be shared by ranks"),
    ] {
        let words = words(&scene);
        assert!(words.iter().all(|text| text.contains(expected) && *text == words[0]), "{words:?}");
    }
}

#[test]
fn what_goes_wrong_between_evaluations_is_told_on_all_ranks_and_then_forgotten() {
    let scene = scene();
    let parts = spread_out(&scene, 3);
    let outcomes = on_ranks(3, |ranks| {
        let rank = ranks.rank();
        let mut field = ElectricField::over_ranks_with_choice(
            ranks,
            &scene.domain,
            &scene.settings,
            &parameters(5, 3e-4),
        )?;
        let mut positions: Vec<_> = parts[rank].iter().map(|&i| scene.positions[i]).collect();
        let charges = vec![1e-13; positions.len()];
        let mut values = FieldValues::default();
        let good = positions[0];
        if rank == 1 {
            // Two charges in one place: found after the sum, on this rank alone.
            positions[0] = positions[1];
        }
        let failed = field.evaluate(&positions, &charges, Wanted::default(), &mut values).unwrap_err();
        assert!(failed.to_string().contains("same position"), "{failed}");
        assert!(matches!(failed, FieldError::OfRank { rank: 1, .. }), "{failed}");
        positions[0] = good;
        field.evaluate(&positions, &charges, Wanted::default(), &mut values)
    });
    assert!(outcomes.iter().all(Result::is_ok), "{outcomes:?}");
}

#[test]
fn a_rank_that_ends_ends_the_others() {
    let scene = scene();
    let outcomes = on_ranks(3, |ranks| {
        if ranks.rank() == 2 {
            return Ok(());
        }
        let mut field = ElectricField::over_ranks_with_choice(
            ranks,
            &scene.domain,
            &scene.settings,
            &parameters(5, 3e-4),
        )?;
        field.evaluate(&scene.positions, &scene.charges, Wanted::default(), &mut FieldValues::default())
    });
    assert!(
        outcomes[..2].iter().all(|outcome| outcome.as_ref().unwrap_err().to_string().contains("has ended"))
    );
}
