//! The truncated sum against loops over all pairs.

use amberfield_core::{Boundary, Domain, Permittivity, Vector3};
use amberfield_field::{Cutoff, FieldError, FieldMethod, FieldValues, Wanted};
use amberfield_oracle::{open_sum, reference};

/// Round-off of sums of up to some thousand terms.
const ROUND_OFF: f64 = 1e-12;

const WANTED: Wanted = Wanted { potential: true, components: true };

fn evaluate(domain: &Domain, radius: f64, positions: &[Vector3<f64>], charges: &[f64]) -> (FieldValues, f64) {
    let mut out = FieldValues::default();
    let mut cutoff = Cutoff::new(domain, Permittivity::from_relative(2.0), radius).expect("a valid radius");
    cutoff.evaluate(positions, charges, WANTED, &mut out).expect("valid particles");
    (out, cutoff.pairs_per_particle())
}

/// Coulomb's sum over copies of the periodic axes, by brute force.
fn brute_force(
    domain: &Domain,
    radius: f64,
    positions: &[Vector3<f64>],
    charges: &[f64],
    at: usize,
) -> (Vector3<f64>, f64, usize) {
    let (mut e, mut potential, mut partners) = (Vector3::zeros(), 0.0, 0);
    let copies = |axis: usize| {
        let periodic = domain.faces()[axis][0] == Boundary::Periodic;
        let most = if periodic { 6 } else { 0 };
        (-most..=most).map(f64::from)
    };
    for (index, (x, q)) in positions.iter().zip(charges).enumerate() {
        for a in copies(0) {
            for b in copies(1) {
                for c in copies(2) {
                    let shift = domain.extent().component_mul(&Vector3::new(a, b, c));
                    let d = positions[at] - x - shift;
                    if (index != at || shift != Vector3::zeros()) && d.norm() < radius {
                        e += d * (q / d.norm().powi(3));
                        potential += q / d.norm();
                        partners += 1;
                    }
                }
            }
        }
    }
    (e, potential, partners)
}

#[test]
fn any_radius_agrees_with_all_pairs_and_copies() {
    let count = 40;
    let faces = [[Boundary::Periodic; 2], [Boundary::Grounded; 2], [Boundary::Periodic; 2]];
    let domain = Domain::new(Vector3::repeat(-0.5), Vector3::new(0.5, 1.0, 0.2), faces).unwrap();
    let step = Vector3::new(0.819_172_5, 0.671_043_6, 0.549_700_4);
    let positions: Vec<_> = (0..count)
        .map(|i| domain.min() + (step * f64::from(i)).map(f64::fract).component_mul(&domain.extent()))
        .collect();
    let charges: Vec<_> = (0..count).map(|i| f64::from(i % 5) - 1.5).collect();
    // Below and above half the box, and beyond several copies of it.
    for radius in [0.2, 0.45, 0.9, 3.1] {
        let (out, pairs) = evaluate(&domain, radius, &positions, &charges);
        let mut partners = 0;
        for at in 0..positions.len() {
            let (e, potential, near) = brute_force(&domain, radius, &positions, &charges, at);
            let k = Permittivity::from_relative(2.0).coulomb();
            assert!((out.e[at] / k - e).norm() < ROUND_OFF * 1e3, "radius {radius}");
            assert!((out.potential[at] / k - potential).abs() < ROUND_OFF * 1e3);
            assert_eq!(out.components.near[at], out.e[at]);
            partners += near;
        }
        assert!((pairs * f64::from(count) - partners as f64).abs() < 0.5, "radius {radius}: {pairs}");
    }
}

#[test]
fn a_radius_beyond_an_open_box_is_the_direct_sum() {
    let set = reference::by_name("e_open_bip_2000").expect("the set is there");
    let (out, pairs) = evaluate(&set.domain, 2.0, &set.position, &set.charge);
    assert_eq!(pairs, 1999.0);
    for at in [0, 1234, 1999] {
        let coulomb = Permittivity::from_relative(2.0).coulomb();
        let exact = open_sum(coulomb, &set.position, &set.charge, at);
        assert!((out.e[at] - exact.e).norm() < ROUND_OFF * coulomb * set.scale());
        assert!((out.potential[at] / exact.potential - 1.0).abs() < ROUND_OFF * 10.0);
    }
}

#[test]
fn results_do_not_depend_on_threads_or_earlier_calls() {
    let set = reference::by_name("b_periodic_bip_2000").expect("the set is there");
    let (first, _) = evaluate(&set.domain, 0.2, &set.position, &set.charge);
    for threads in [1, 4] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut cutoff = Cutoff::new(&set.domain, Permittivity::from_relative(2.0), 0.2).unwrap();
        let mut out = FieldValues::default();
        pool.install(|| cutoff.evaluate(&set.position[..100], &set.charge[..100], WANTED, &mut out)).unwrap();
        pool.install(|| cutoff.evaluate(&set.position, &set.charge, WANTED, &mut out)).unwrap();
        assert!(out == first, "{threads} threads");
        let memory = cutoff.memory_bytes();
        pool.install(|| cutoff.evaluate(&set.position, &set.charge, WANTED, &mut out)).unwrap();
        assert_eq!(cutoff.memory_bytes(), memory);
    }
}

#[test]
fn bad_radius_is_refused() {
    let domain = Domain::new(Vector3::zeros(), Vector3::repeat(1.0), [[Boundary::Open; 2]; 3]).unwrap();
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(Cutoff::new(&domain, Permittivity::VACUUM, radius), Err(FieldError::Settings(_))));
    }
}
