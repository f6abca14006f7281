//! Random boxes, charges and ways to share them out.

use super::shared::{Scene, field_of_one, field_over, parameters, round_off, spread_out};
use super::{AXES, INSULATING};
use amberfield_core::{Boundary, Domain, Vector3};
use proptest::prelude::*;

/// Ways in which grains are given to ranks.
#[derive(Clone, Copy, Debug)]
enum Sharing {
    /// Side by side.
    InSlabs,
    /// The next grain to the next rank: every rank's box is the whole one.
    InTurn,
    /// All to the last rank.
    AllToOne,
}

fn parts(scene: &Scene, ranks: usize, sharing: Sharing) -> Vec<Vec<usize>> {
    let all = 0..scene.positions.len();
    match sharing {
        Sharing::InSlabs => spread_out(scene, ranks),
        Sharing::InTurn => (0..ranks).map(|rank| all.clone().skip(rank).step_by(ranks).collect()).collect(),
        Sharing::AllToOne => {
            let mut parts = vec![Vec::new(); ranks];
            parts[ranks - 1] = all.collect();
            parts
        }
    }
}

fn axis() -> impl Strategy<Value = [Boundary; 2]> {
    let more =
        [[INSULATING; 2], [INSULATING, Boundary::Potential(-1.0)], [Boundary::Grounded, Boundary::Open]];
    prop::sample::select([&AXES[..], &more[..]].concat())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, ..ProptestConfig::default() })]

    #[test]
    fn the_field_is_that_of_one_process(
        faces in [axis(), axis(), axis()],
        extent in prop::array::uniform3(0.5e-3..2e-3_f64),
        low in prop::array::uniform3(-5e-3..5e-3_f64),
        count in prop_oneof![Just(0_usize), Just(1), 2..60_usize],
        corner in prop_oneof![Just(1.0), 0.02..0.2_f64],
        shift in prop::array::uniform3(-1.5..1.5_f64),
        order in 4..=8_usize,
        cutoff in 0.15e-3..0.6e-3_f64,
        ranks in 1..=8_usize,
        sharing in prop::sample::select(vec![Sharing::InSlabs, Sharing::InTurn, Sharing::AllToOne]),
        seed in 0..u64::MAX,
    ) {
        let (low, extent) = (Vector3::from(low), Vector3::from(extent));
        let domain = Domain::new(low, low + extent, faces).unwrap();
        let mut scene = Scene::neutral(domain, count, seed);
        scene.settings.neutralising_background = true;
        // In a corner of the box; where it is periodic, moved to anywhere, as another program may have them.
        for position in &mut scene.positions {
            *position = low + corner * (*position - low);
            for (axis, shift) in shift.iter().enumerate() {
                if faces[axis][0] == Boundary::Periodic {
                    position[axis] += shift * extent[axis];
                }
            }
        }
        let choice = parameters(order, cutoff);
        let one = field_of_one(&scene, &choice);
        let shared = field_over(&scene, &parts(&scene, ranks, sharing), &choice);
        let (difference, scale) = one.difference(&shared);
        let allowed = round_off(&scene, &choice, &one) + 100.0 * f64::EPSILON * scale;
        prop_assert!(difference <= allowed, "{:e} of {scale:e}, {:e} allowed", difference, allowed);
    }
}
