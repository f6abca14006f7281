//! The direct sum against the reference sets, and every other geometry against one that is known.

use amberfield_core::{Boundary, Domain, Permittivity, Vector3};
use amberfield_field::{Direct, FieldError, FieldMethod, FieldValues, Wanted};
use amberfield_oracle::{ErrorNorms, field_scale, reference};
use std::f64::consts::PI;

/// Error that the direct sum may have on the reference sets, relative to the scale of E.
const REFERENCE: f64 = 1e-9;
/// Error that the direct sum reaches: terms left out are below 1e-14.
const REACHED: f64 = 1e-12;

const GROUNDED: [Boundary; 2] = [Boundary::Grounded; 2];
const PERIODIC: [Boundary; 2] = [Boundary::Periodic; 2];
const OPEN: [Boundary; 2] = [Boundary::Open; 2];
const INSULATOR: Boundary = Boundary::Insulating { normal_field_v_m: 0.0 };
const INSULATING: [Boundary; 2] = [INSULATOR; 2];

fn domain(extent: [f64; 3], faces: [[Boundary; 2]; 3]) -> Domain {
    Domain::new(Vector3::zeros(), Vector3::from(extent), faces).expect("a valid box")
}

/// E and potential over 1/(4πε₀).
fn field(domain: &Domain, positions: &[Vector3<f64>], charges: &[f64]) -> FieldValues {
    let mut out = FieldValues::default();
    let wanted = Wanted { potential: true, components: true };
    let mut direct = Direct::new(domain, Permittivity::VACUUM, false);
    direct.evaluate(positions, charges, wanted, &mut out).expect("a valid system");
    let k = Permittivity::VACUUM.coulomb();
    out.e.iter_mut().for_each(|e| *e /= k);
    out.potential.iter_mut().for_each(|potential| *potential /= k);
    out
}

/// Evenly spread points with charges ±1 in turn.
fn system(count: u32, extent: [f64; 3]) -> (Vec<Vector3<f64>>, Vec<f64>) {
    let coordinate = |i: u32, step: f64| (0.31 + f64::from(i) * step).fract() * 0.96 + 0.02;
    let steps = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9];
    let point = |i| Vector3::from_fn(|axis, _| extent[axis] * coordinate(i, steps[axis]));
    ((0..count).map(point).collect(), (0..count).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect())
}

fn assert_same(a: &FieldValues, b: &FieldValues, count: usize, charges: &[f64], volume: f64, what: &str) {
    let scale = field_scale(&b.e[..count], charges, volume, 1.0);
    let error = ErrorNorms::new(&a.e[..count], &b.e[..count], scale);
    assert!(error.worst < REACHED, "{what}: E {:e}", error.worst);
    for (index, (a, b)) in a.potential[..count].iter().zip(&b.potential).enumerate() {
        assert!((a - b).abs() < REACHED * 100.0 * b.abs().max(1.0), "{what}: potential {index}: {a} {b}");
    }
}

#[test]
fn reference_sets_agree() {
    for set in reference::all() {
        let out = field(&set.domain, &set.position, &set.charge);
        let error = ErrorNorms::new(&out.e, &set.e, set.scale());
        assert!(error.relative_rms < REFERENCE && error.worst < REFERENCE, "{}: {error:?}", set.name);
        for (value, expected) in out.potential.iter().zip(&set.potential) {
            // 2000 charges near 1 give potentials of up to 1e4.
            assert!((value - expected).abs() < REFERENCE * expected.abs().max(1.0), "{}", set.name);
        }
    }
}

#[test]
fn a_single_charge_in_a_grounded_cube_sees_its_images() {
    let cube = reference::f_cube_domain();
    for row in reference::f_cube_single() {
        let out = field(&cube, &[row.position], &[1.0]);
        assert!((out.e[0] - row.e).norm() < REFERENCE * row.e.norm().max(1.0), "{row:?}");
        assert!((out.potential[0] - row.potential).abs() < REFERENCE * row.potential.abs().max(1.0));
    }
}

#[test]
fn components_add_up_and_permittivity_divides() {
    let set = reference::by_name("a_nacl_64").expect("the set is there");
    let (mut vacuum, mut glass) = (FieldValues::default(), FieldValues::default());
    let wanted = Wanted { potential: true, components: true };
    for (permittivity, out) in [(1.0, &mut vacuum), (5.0, &mut glass)] {
        let mut direct = Direct::new(&set.domain, Permittivity::from_relative(permittivity), false);
        direct.evaluate(&set.position, &set.charge, wanted, out).expect("neutral");
    }
    for index in 0..64 {
        let sum = vacuum.components.near[index] + vacuum.components.far[index];
        assert!((sum - vacuum.e[index]).norm() <= 1e-14 * vacuum.components.near[index].norm());
        assert!((vacuum.potential[index] / glass.potential[index] - 5.0).abs() < 1e-13);
    }
}

/// Conductor below, insulator above: a box of twice the height between conductors with mirrored charges.
#[test]
fn conductor_opposite_an_insulator_is_half_a_box() {
    let sides = [[INSULATOR, Boundary::Grounded], PERIODIC];
    let (positions, charges) = system(40, [1.0, 1.5, 0.7]);
    let single = domain([1.0, 1.5, 0.7], [sides[0], sides[1], [Boundary::Grounded, INSULATOR]]);
    let double = domain([1.0, 1.5, 1.4], [sides[0], sides[1], GROUNDED]);
    let mirrored = positions.iter().map(|x| Vector3::new(x.x, x.y, 1.4 - x.z));
    let all: Vec<_> = positions.iter().copied().chain(mirrored).collect();
    let a = field(&single, &positions, &charges);
    let b = field(&double, &all, &[charges.clone(), charges.clone()].concat());
    // The double box does not count the mirror charge of a particle as its own image: it is a particle there.
    assert_same(&a, &b, 40, &charges, 1.05, "conductor and insulator");
    let upside_down: Vec<_> = positions.iter().map(|x| Vector3::new(x.x, x.y, 0.7 - x.z)).collect();
    let turned = domain([1.0, 1.5, 0.7], [sides[0], sides[1], [INSULATOR, Boundary::Grounded]]);
    let c = field(&turned, &upside_down, &charges);
    for (a, c) in a.e.iter().zip(&c.e) {
        assert!((a - c.component_mul(&Vector3::new(1.0, 1.0, -1.0))).norm() < REACHED * a.norm().max(10.0));
    }
}

/// Half space and corner: the open sum with explicit mirror charges.
#[test]
fn open_corner_is_the_open_sum_with_mirror_charges() {
    let (positions, charges) = system(30, [1.0, 1.0, 1.0]);
    let corner = domain([1.0; 3], [[Boundary::Grounded, Boundary::Open], [Boundary::Open, INSULATOR], OPEN]);
    let mut all = positions.clone();
    let mut all_charges = charges.clone();
    for (mirror, sign) in [((true, false), -1.0), ((false, true), 1.0), ((true, true), -1.0)] {
        for (x, charge) in positions.iter().zip(&charges) {
            let (mx, my) = (if mirror.0 { -x.x } else { x.x }, if mirror.1 { 2.0 - x.y } else { x.y });
            all.push(Vector3::new(mx, my, x.z));
            all_charges.push(charge * sign);
        }
    }
    let a = field(&corner, &positions, &charges);
    let b = field(&domain([1.0; 3], [OPEN; 3]), &all, &all_charges);
    assert_same(&a, &b, 30, &charges, 1.0, "corner");
}

/// ± pairs in mirrored places have no dipole: a slab far from conductors or from its own copies is free.
fn without_dipole(count: u32, extent: [f64; 3], lift: f64) -> (Vec<Vector3<f64>>, Vec<f64>) {
    let (mut positions, mut charges) = system(count, extent);
    for x in &mut positions {
        x.z += lift;
    }
    let twice_mean = 2.0 * lift + extent[2];
    for index in 0..positions.len() {
        let x = positions[index];
        positions.push(Vector3::new((x.x + 0.37 * extent[0]) % extent[0], extent[1] - x.y, twice_mean - x.z));
        charges.push(charges[index]);
    }
    let dipole: f64 = positions.iter().zip(&charges).map(|(x, q)| x.z * q).sum();
    assert!(dipole.abs() < 1e-12);
    (positions, charges)
}

#[test]
fn slab_is_the_limit_of_distant_faces() {
    let (positions, charges) = without_dipole(20, [1.0, 1.2, 0.5], 4.0);
    for sides in [
        [PERIODIC, PERIODIC],
        [PERIODIC, INSULATING],
        [GROUNDED, PERIODIC],
        [[INSULATOR, Boundary::Grounded], INSULATING],
    ] {
        let slab = field(&domain([1.0, 1.2, 9.0], [sides[0], sides[1], OPEN]), &positions, &charges);
        let far = domain([1.0, 1.2, 8.5], [sides[0], sides[1], GROUNDED]);
        // Slowest decay e^{−kz}, k ≥ π/2 here, there and back over 2 × 4.
        let error = ErrorNorms::new(&slab.e, &field(&far, &positions, &charges).e, 10.0);
        assert!(error.worst < 1e-4, "{sides:?}: {error:?}");
    }
    let sides = [PERIODIC, PERIODIC];
    let slab = field(&domain([1.0, 1.2, 9.0], [sides[0], sides[1], OPEN]), &positions, &charges);
    let tall = field(&domain([1.0, 1.2, 8.5], [sides[0], sides[1], GROUNDED]), &positions, &charges);
    // Periodic sides decay as e^{−2π·8/1.2} = 6e-19.
    assert_same(&slab, &tall, 40, &charges, 0.6, "periodic slab");
}

#[test]
fn slab_over_a_wall_is_a_slab_with_mirror_charges() {
    for (wall, sign) in [(Boundary::Grounded, -1.0), (INSULATOR, 1.0)] {
        let (positions, charges) = system(30, [1.0, 1.2, 0.5]);
        let mut charges = charges;
        charges[3] = 2.5;
        let over = field(
            &domain([1.0, 1.2, 0.6], [PERIODIC, GROUNDED, [wall, Boundary::Open]]),
            &positions,
            &charges,
        );
        let under_positions: Vec<_> = positions.iter().map(|x| Vector3::new(x.x, x.y, 0.6 - x.z)).collect();
        let under = domain([1.0, 1.2, 0.6], [PERIODIC, GROUNDED, [Boundary::Open, wall]]);
        let under = field(&under, &under_positions, &charges);
        let mut all = positions.clone();
        let mut all_charges = charges.clone();
        for (x, charge) in positions.iter().zip(&charges) {
            all.push(Vector3::new(x.x, x.y, -x.z));
            all_charges.push(sign * charge);
        }
        let free = field(&domain([1.0, 1.2, 0.6], [PERIODIC, GROUNDED, OPEN]), &all, &all_charges);
        assert_same(&over, &free, 30, &charges, 0.6, "over the wall");
        for (over, under) in over.e.iter().zip(&under.e) {
            let turned = under.component_mul(&Vector3::new(1.0, 1.0, -1.0));
            assert!((over - turned).norm() < REACHED * over.norm().max(10.0));
        }
    }
}

/// A charged layer, far away: E = 2πσ on either side, and the potential falls as −2πσ|z|. Any axis may be
/// open.
#[test]
fn a_charged_layer_has_the_field_of_a_sheet() {
    const PROBE: f64 = 1e-9;
    for axis in 0..3 {
        let mut faces = [PERIODIC, PERIODIC, PERIODIC];
        faces[axis] = OPEN;
        let mut extent = [0.5, 0.8, 0.8];
        extent[axis] = 10.0;
        let area = extent.iter().product::<f64>() / 10.0;
        let mut positions = vec![Vector3::repeat(0.3), Vector3::repeat(0.1), Vector3::repeat(0.1)];
        for (position, at) in positions.iter_mut().zip([2.0, 9.0, 0.5]) {
            position[axis] = at;
        }
        let out = field(&domain(extent, faces), &positions, &[1.0, PROBE, PROBE]);
        assert!((out.e[1][axis] - 2.0 * PI / area).abs() < 1e-7, "above: {:?}", out.e[1]);
        // Not yet far: e^{−2π·1.5/0.8} = 7e-6 of in-plane structure.
        assert!((out.e[2][axis] + 2.0 * PI / area).abs() < 1e-3, "below: {:?}", out.e[2]);
        assert!((out.potential[1] + 2.0 * PI / area * 7.0).abs() < 1e-6, "potential {}", out.potential[1]);
    }
}

#[test]
fn background_takes_a_net_charge_where_allowed() {
    let cube = domain([2.0; 3], [PERIODIC; 3]);
    let mut out = FieldValues::default();
    let at = [Vector3::repeat(0.3)];
    let refused =
        Direct::new(&cube, Permittivity::VACUUM, false).evaluate(&at, &[1.0], Wanted::default(), &mut out);
    assert!(matches!(refused, Err(FieldError::NetCharge { .. })));
    let wanted = Wanted { potential: true, components: false };
    Direct::new(&cube, Permittivity::VACUUM, true).evaluate(&at, &[1.0], wanted, &mut out).unwrap();
    // Wigner crystal, simple cubic: ξ = −2.837297479480619 over the edge.
    let expected = -2.837_297_479_480_619 / 2.0;
    assert!(
        (out.potential[0] / Permittivity::VACUUM.coulomb() - expected).abs() < REACHED,
        "{}",
        out.potential[0]
    );
    assert!(out.e[0].norm() < 1e-2, "by symmetry, round-off of 9e9");
}

#[test]
fn scale_does_not_matter_and_threads_do_not_either() {
    let (positions, charges) = system(200, [1.0; 3]);
    let mixed = [GROUNDED, PERIODIC, [INSULATOR, Boundary::Grounded]];
    let large = field(&domain([1.0; 3], mixed), &positions, &charges);
    let small_positions: Vec<_> = positions.iter().map(|x| x * 1e-4).collect();
    let small_charges: Vec<_> = charges.iter().map(|q| q * 1e-14).collect();
    let small = field(&domain([1e-4; 3], mixed), &small_positions, &small_charges);
    for (large, small) in large.e.iter().zip(&small.e) {
        assert!((large * 1e-6 - small).norm() < 1e-18 * large.norm().max(10.0) * 10.0);
    }
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let again = pool.install(|| field(&domain([1.0; 3], mixed), &positions, &charges));
        assert!(large == again, "bit-identical on {threads} threads");
    }
}

#[test]
fn bad_input_is_an_error() {
    let cube = domain([1.0; 3], [GROUNDED; 3]);
    let mut out = FieldValues::default();
    let mut direct = Direct::new(&cube, Permittivity::VACUUM, false);
    let mut evaluate = |positions: &[Vector3<f64>], charges: &[f64]| {
        direct.evaluate(positions, charges, Wanted::default(), &mut out)
    };
    let inside = Vector3::repeat(0.3);
    assert_eq!(evaluate(&[inside], &[f64::NAN]), Err(FieldError::NotFinite { index: 0 }));
    assert!(matches!(evaluate(&[inside, Vector3::zeros()], &[1.0, 1.0]), Err(FieldError::Settings(_))));
    assert!(matches!(evaluate(&[inside, inside], &[1.0, 1.0]), Err(FieldError::Settings(_))));
    assert_eq!(evaluate(&[], &[]), Ok(()));
}

/// Field of charges between grounded plates z = 0 and z = `gap` by their images, which fall as e^{−πρ/gap}
/// where summed in pairs, and by the series in K₀: two sums that share nothing with Ewald's.
fn between_plates(positions: &[Vector3<f64>], charges: &[f64], gap: f64) -> Vec<Vector3<f64>> {
    let one = |at: &Vector3<f64>, from: &Vector3<f64>, same: bool| {
        let mut e = Vector3::zeros();
        // Alternate images converge as 1/n³ once each is met by the mean of its neighbours' partial sums.
        let mut last = Vector3::zeros();
        for n in 0..4000_i32 {
            for m in if n == 0 { vec![0] } else { vec![n, -n] } {
                for (z, sign) in [(from.z, 1.0), (-from.z, -1.0)] {
                    let d = at - Vector3::new(from.x, from.y, z + 2.0 * gap * f64::from(m));
                    if !(same && m == 0 && sign > 0.0) {
                        e += sign * d / d.norm().powi(3);
                    }
                }
            }
            last = if n == 3999 { e } else { last };
        }
        last
    };
    positions
        .iter()
        .enumerate()
        .map(|(i, at)| {
            let sum = |(j, (from, q)): (usize, (&Vector3<f64>, &f64))| *q * one(at, from, i == j);
            positions.iter().zip(charges).enumerate().map(sum).sum()
        })
        .collect()
}

#[test]
fn plates_with_open_sides_are_the_sum_over_images() {
    let (positions, mut charges) = system(12, [3.0, 1.0, 0.7]);
    charges[3] = 2.5;
    for closed in 0..3 {
        let turn = |x: &Vector3<f64>| Vector3::from_fn(|axis, _| x[(axis + 5 - closed) % 3]);
        let mut faces = [OPEN; 3];
        faces[closed] = GROUNDED;
        let extent = turn(&Vector3::new(3.0, 1.0, 0.7));
        let turned: Vec<_> = positions.iter().map(turn).collect();
        let found = field(&domain(extent.into(), faces), &turned, &charges);
        for (e, expected) in found.e.iter().zip(between_plates(&positions, &charges, 0.7)) {
            // 4000 images leave 1/(4000² · gap³) of the few charges out.
            assert!((e - turn(&expected)).norm() < 1e-6 * expected.norm(), "{closed}: {e} {expected}");
        }
    }
}

#[test]
fn plates_with_open_sides_are_the_limit_of_distant_sides() {
    let (mut positions, charges) = system(24, [1.0, 1.2, 0.5]);
    positions.iter_mut().for_each(|x| *x += Vector3::new(4.0, 4.0, 0.0));
    for plates in [GROUNDED, [INSULATOR, Boundary::Grounded]] {
        let open = field(&domain([9.0, 9.2, 0.5], [OPEN, OPEN, plates]), &positions, &charges);
        for sides in [PERIODIC, GROUNDED] {
            let far = field(&domain([9.0, 9.2, 0.5], [sides, sides, plates]), &positions, &charges);
            // Slowest decay e^{−πρ/2·0.5} over 2 × 4 there and back.
            let error = ErrorNorms::new(&open.e, &far.e, 10.0);
            assert!(error.worst < 1e-10, "{plates:?} {sides:?}: {error:?}");
        }
    }
}

#[test]
fn open_sides_over_a_wall_have_mirror_charges() {
    for (wall, sign) in [(Boundary::Grounded, -1.0), (INSULATOR, 1.0)] {
        for plates in [GROUNDED, PERIODIC, INSULATING] {
            let (positions, charges) = system(20, [0.6, 1.2, 0.5]);
            let extent = [0.6, 1.2, 0.5];
            let over = field(&domain(extent, [[wall, Boundary::Open], OPEN, plates]), &positions, &charges);
            let mut all = positions.clone();
            all.extend(positions.iter().map(|x| Vector3::new(-x.x, x.y, x.z)));
            let mirrored = charges.iter().map(|q| sign * q);
            let all_charges: Vec<_> = charges.iter().copied().chain(mirrored).collect();
            let free = field(&domain(extent, [OPEN, OPEN, plates]), &all, &all_charges);
            assert_same(&over, &free, 20, &charges, 0.36, "open sides over a wall");
        }
    }
}

/// A charge with its copies along one axis, far away: E = 2λ/ρ, and the potential −2λ ln(ρ/L).
#[test]
fn a_charged_row_has_the_field_of_a_line() {
    for axis in 0..3 {
        let mut faces = [OPEN; 3];
        faces[axis] = PERIODIC;
        let mut extent = [10.0; 3];
        extent[axis] = 0.8;
        let mut positions = vec![Vector3::repeat(2.0), Vector3::new(7.0, 8.0, 9.0)];
        positions.iter_mut().for_each(|x| x[axis] = 0.3);
        let out = field(&domain(extent, faces), &positions, &[1.0, 1e-9]);
        let mut across = positions[1] - positions[0];
        across[axis] = 0.0;
        let distance = across.norm();
        let expected = across * (2.0 / 0.8 / distance.powi(2));
        assert!((out.e[1] - expected).norm() < 1e-8, "{axis}: {:?} {expected:?}", out.e[1]);
        let potential = -2.0 / 0.8 * (distance / 0.8).ln();
        assert!((out.potential[1] - potential).abs() < 1e-8, "{axis}: {} {potential}", out.potential[1]);
    }
}
