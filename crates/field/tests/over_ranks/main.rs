//! A field shared by ranks is the field of one process. Ranks are threads here; under MPI the same code runs.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

mod failures;
mod random_scenes;
mod shared;
mod tolerance;

use amberfield_core::{Boundary, Domain, Vector3};
use shared::{Scene, field_of_one, field_over, parameters, round_off, spread_out};

/// Faces of an axis: joined, closed of both kinds, and open on one or both sides.
const AXES: [[Boundary; 2]; 6] = [
    [Boundary::Periodic; 2],
    [Boundary::Grounded; 2],
    [Boundary::Potential(2.0), INSULATING],
    [INSULATING, Boundary::Open],
    [Boundary::Open, Boundary::Grounded],
    [Boundary::Open; 2],
];
const INSULATING: Boundary = Boundary::Insulating { normal_field_v_m: 0.0 };
/// Ranks that share a scene, in turn.
const RANKS: [usize; 5] = [2, 3, 1, 7, 4];

#[test]
fn every_mix_of_faces_and_order_of_the_window() {
    let mixes = (0..216).map(|mix| [AXES[mix % 6], AXES[mix / 6 % 6], AXES[mix / 36]]);
    for (number, faces) in mixes.enumerate() {
        let domain = Domain::new(Vector3::zeros(), Vector3::new(1e-3, 1.3e-3, 0.8e-3), faces).unwrap();
        let scene = Scene::neutral(domain, 40, number as u64);
        let (order, ranks) = (4 + number % 5, RANKS[number % RANKS.len()]);
        let choice = parameters(order, 0.3e-3);
        let one = field_of_one(&scene, &choice);
        let parts = spread_out(&scene, ranks);
        let shared = field_over(&scene, &parts, &choice);
        let (difference, scale) = one.difference(&shared);
        let allowed = round_off(&scene, &choice, &one) + 100.0 * f64::EPSILON * scale;
        assert!(
            difference <= allowed,
            "{faces:?}, order {order}, {ranks} ranks: {:e} of the scale, {:e} allowed",
            difference / scale,
            allowed / scale
        );
    }
}

#[test]
fn memory_of_a_rank_falls_with_the_number_of_ranks() {
    let domain = Domain::new(Vector3::zeros(), Vector3::repeat(1e-3), [[Boundary::Periodic; 2]; 3]).unwrap();
    let scene = Scene::neutral(domain, 20_000, 3);
    let choice = parameters(5, 0.06e-3);
    let memory = [1, 2, 4, 8].map(|ranks| {
        let fields =
            shared::run(&scene, &spread_out(&scene, ranks), &choice, |field, _| field.memory_bytes());
        fields.into_iter().max().unwrap()
    });
    for (fewer, more) in memory.iter().zip(&memory[1..]) {
        // Halves would be 0.5: grains of others and halos come on top.
        assert!((*more as f64) < 0.8 * *fewer as f64, "{memory:?}");
    }
}
