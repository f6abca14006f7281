//! The published hybrid's mesh beside open faces: mirror charges, limits, values on faces.

use super::{GROUNDED, OPEN, PERIODIC, ROUND_OFF, domain, evaluate, insulating};
use amberfield_core::constants::VACUUM_PERMITTIVITY;
use amberfield_core::{Boundary, Domain, Permittivity, Vector3};
use amberfield_field::Kolehmainen;

fn points(domain: &Domain, count: u32) -> Vec<Vector3<f64>> {
    let step = Vector3::new(0.819_172_5, 0.671_043_6, 0.549_700_4);
    (1..=count)
        .map(|i| domain.min() + (step * f64::from(i)).map(f64::fract).component_mul(&domain.extent()))
        .collect()
}

/// Half-open axes: the mesh of twice the size with mirror charges; in open boxes and in slabs, whichever
/// way round.
#[test]
fn half_open_meshes_are_those_with_mirror_charges() {
    for sides in [[PERIODIC, GROUNDED], [GROUNDED, [Boundary::Grounded, insulating(0.0)]], [OPEN, OPEN]] {
        for (wall, sign) in [(Boundary::Grounded, -1.0), (insulating(0.0), 1.0)] {
            let low = domain([1.0, 0.9, 0.8], [sides[0], sides[1], [wall, Boundary::Open]]);
            let high = domain([1.0, 0.9, 0.8], [sides[0], sides[1], [Boundary::Open, wall]]);
            let (min, max) = (low.min() - Vector3::new(0.0, 0.0, 0.8), low.max());
            let whole = Domain::new(min, max, [sides[0], sides[1], OPEN]).unwrap();
            let positions = points(&low, 12);
            let mirror = |x: &Vector3<f64>, at: f64| Vector3::new(x.x, x.y, 2.0 * at - x.z);
            let turned: Vec<_> = positions.iter().map(|x| mirror(x, 3.4)).collect();
            let mut all = positions.clone();
            all.extend(positions.iter().map(|x| mirror(x, 3.0)));
            let charges: Vec<f64> = (0..12).map(|i| 1e-10 * (f64::from(i % 5) - 1.3)).collect();
            let both = [charges.clone(), charges.iter().map(|q| q * sign).collect()].concat();
            let run = |domain: &Domain, cells, positions: &[_], charges: &[f64]| {
                let mut hybrid = Kolehmainen::new(domain, Permittivity::VACUUM, false, 0.6, Some(cells))
                    .expect("supported");
                evaluate(&mut hybrid, positions, charges)
            };
            let expected = run(&whole, [4, 3, 10], &all, &both);
            let (low, high) =
                (run(&low, [4, 3, 5], &positions, &charges), run(&high, [4, 3, 5], &turned, &charges));
            for i in 0..12 {
                let e = expected.components.far[i];
                assert!((low.components.far[i] - e).norm() < ROUND_OFF * 100.0, "{sides:?} {wall:?} low");
                let flipped = high.components.far[i].component_mul(&Vector3::new(1.0, 1.0, -1.0));
                assert!((flipped - e).norm() < ROUND_OFF * 100.0, "{sides:?} {wall:?} high");
            }
        }
    }
}

/// A slab without dipole is the middle of a tall box; a charged sheet of cells has E = σ/2ε on either side.
#[test]
fn open_slab_is_the_limit_of_a_tall_box() {
    let tall = domain([0.5, 0.6, 4.0], [PERIODIC, PERIODIC, GROUNDED]);
    let min = tall.min() + Vector3::new(0.0, 0.0, 1.6);
    let slab = Domain::new(min, min + Vector3::new(0.5, 0.6, 0.8), [PERIODIC, PERIODIC, OPEN]).unwrap();
    let mut positions = points(&slab, 10);
    let mut charges: Vec<f64> = (0..10).map(|i| if i % 2 == 0 { 1e-10 } else { -1e-10 }).collect();
    for i in 0..10 {
        let x = positions[i];
        positions.push(Vector3::new(x.y.mul_add(0.3, x.x).rem_euclid(0.5) - 0.2, x.y, 10.0 - x.z));
        charges.push(charges[i]);
    }
    let run = |domain: &Domain, cells| {
        let mut hybrid =
            Kolehmainen::new(domain, Permittivity::VACUUM, false, 0.4, Some(cells)).expect("supported");
        evaluate(&mut hybrid, &positions, &charges)
    };
    let (a, b) = (run(&slab, [5, 6, 8]), run(&tall, [5, 6, 40]));
    for (a, b) in a.components.far.iter().zip(&b.components.far) {
        // In-plane waves fall as e^{−2π z/0.6} over 3.2: 3e-15.
        assert!((a - b).norm() < 1e-9, "{a:?} {b:?}");
    }
    let sheet = [min + Vector3::new(0.05, 0.05, 0.05), min + Vector3::new(0.3, 0.3, 0.75)];
    let mut coarse =
        Kolehmainen::new(&slab, Permittivity::VACUUM, false, 0.9, Some([1, 1, 8])).expect("fine enough");
    let out = evaluate(&mut coarse, &sheet, &[1e-10, 0.0]);
    let expected = 1e-10 / (0.5 * 0.6) / (2.0 * VACUUM_PERMITTIVITY);
    assert!((out.components.far[1].z - expected).abs() < 1e-9 * expected, "{:?}", out.components.far[1]);
}

#[test]
fn values_on_faces_beside_open_ones_are_added() {
    let plate = domain([1.0; 3], [PERIODIC, PERIODIC, [Boundary::Potential(7.0), Boundary::Open]]);
    let mut hybrid = Kolehmainen::new(&plate, Permittivity::VACUUM, false, 0.5, None).unwrap();
    let out = evaluate(&mut hybrid, &[plate.centre()], &[0.0]);
    assert!((out.potential[0] - 7.0).abs() < 1e-12 && out.e[0].norm() < 1e-12);
    let charged = domain([1.0; 3], [PERIODIC, PERIODIC, [insulating(-3.0), Boundary::Open]]);
    let mut hybrid = Kolehmainen::new(&charged, Permittivity::VACUUM, false, 0.5, None).unwrap();
    let out = evaluate(&mut hybrid, &[charged.centre()], &[0.0]);
    assert!((out.e[0] - Vector3::new(0.0, 0.0, 3.0)).norm() < 1e-12);
}
