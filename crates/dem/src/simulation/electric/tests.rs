//! Charge transfer in whole scenes: the field at contacts, networks of contacts that stay bounded.

use super::Simulation;
use crate::contacts::memory::{Follow, Grown};
use crate::contacts::neighbours::Listed;
use crate::motion::chunks::CHUNK;
use crate::setup::{FieldStageSetup, Setup};
use amberfield_core::constants::VACUUM_PERMITTIVITY;
use amberfield_core::{
    Boundary, ChargeTransfer, Domain, FieldSettings, Grain, GroupId, Material, MaterialId, Method, OnExit,
    Permittivity, RollingModel, Skin, Step, TimeSettings, Vector3,
};
use amberfield_laws::charge_transfer::{self, between_grains};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

const RADIUS: f64 = 75e-6;
/// Overlap of touching grains over the smaller radius.
const OVERLAP: f64 = 1e-6;
/// Steady driving terms of a network that cannot vanish together, and of sweeps that end at either side of
/// it, over those at the start.
const PLATEAU: f64 = 0.05;

fn packed(places: &[(Vector3<f64>, f64)], work_functions: &[f64], cutoff_m: f64) -> Simulation {
    built(places, work_functions, Some(ChargeTransfer::new(cutoff_m)))
}

fn built(
    places: &[(Vector3<f64>, f64)],
    work_functions: &[f64],
    transfer: Option<ChargeTransfer>,
) -> Simulation {
    let grain = |n: usize| Grain {
        id: n as u64,
        position: places[n].0,
        velocity: Vector3::zeros(),
        angular_velocity: Vector3::zeros(),
        radius: places[n].1,
        density: 1000.0,
        charge: 0.0,
        material: MaterialId(n as u16),
        group: GroupId(0),
    };
    let material = |work: &f64| Material {
        name: "solid".into(),
        density_kg_m3: 1000.0,
        young_pa: 1e6,
        young_real_pa: None,
        poisson: 0.3,
        restitution: 1.0,
        friction: 0.0,
        rolling_friction: 0.0,
        surface_energy_j_m2: 0.0,
        work_function_ev: Some(*work),
    };
    let settings = FieldSettings { method: Method::Direct, ..FieldSettings::default() };
    let field = FieldStageSetup::new(settings, vec![true; places.len()]);
    let domain = Domain::new(Vector3::repeat(-1.0), Vector3::repeat(1.0), [[Boundary::Open; 2]; 3]);
    let setup = Setup {
        domain: domain.expect("a good scene"),
        materials: work_functions.iter().map(material).collect(),
        rolling_model: RollingModel::default(),
        cohesion: Default::default(),
        pairs: Vec::new(),
        particles: (0..places.len()).map(grain).collect(),
        walls: Vec::new(),
        time: TimeSettings {
            step: Step::Seconds(1e-9),
            end_s: 1.0,
            gravity_m_s2: Vector3::zeros(),
            skin: Skin::Auto,
            allow_unstable: true,
            on_exit: OnExit::Stop,
            allow_overlap: false,
        },
        gas: None,
        field: Some(FieldStageSetup { transfer, ..field }),
        feeds: Default::default(),
        outlets: Vec::new(),
    };
    Simulation::new(setup).expect("a good scene")
}

/// Face-centred cubic: twelve touching grains around each one inside.
fn close_packed(cells: i32) -> Vec<(Vector3<f64>, f64)> {
    let edge = 2.0 * 2.0_f64.sqrt() * RADIUS * (1.0 - OVERLAP / 2.0);
    let corners = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]];
    let cell = |n: i32| {
        Vector3::new(f64::from(n / cells / cells), f64::from(n / cells % cells), f64::from(n % cells))
    };
    (0..cells * cells * cells)
        .flat_map(|n| corners.map(|corner| ((cell(n) + Vector3::from(corner)) * edge, RADIUS)))
        .collect()
}

/// One grain a hundred times as large as those that sit on it.
fn studded() -> Vec<(Vector3<f64>, f64)> {
    let large = 100.0 * RADIUS;
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    let stud = |n: u32| {
        let z = 1.0 - 2.0 * (f64::from(n) + 0.5) / 60.0;
        let (rho, angle) = ((1.0 - z * z).sqrt(), golden * f64::from(n));
        (Vector3::new(rho * angle.cos(), rho * angle.sin(), z) * (large + RADIUS * (1.0 - OVERLAP)), RADIUS)
    };
    std::iter::once((Vector3::zeros(), large)).chain((0..60).map(stud)).collect()
}

fn work_functions(count: usize, step: usize) -> Vec<f64> {
    (0..count).map(|n| 5.0 * ((n * step) as f64 * 0.618_034).fract()).collect()
}

/// Touching pairs: chunk, entry, sorted indices.
fn touching(run: &Simulation) -> Vec<(usize, Grown, usize, usize)> {
    let listed = |pair: Listed| {
        let grown = Grown { entry: pair.entry as u32, local: (pair.i % CHUNK) as u32 };
        (pair.chunk, grown, pair.i, pair.j)
    };
    run.contacts.neighbours.touching().map(listed).collect()
}

fn grain_of(run: &Simulation, i: usize) -> charge_transfer::ChargedSphere {
    let original = run.grains.original[i].index();
    charge_transfer::ChargedSphere {
        charge: run.particles.charge[original],
        radius: run.particles.radius[original],
    }
}

fn work(run: &Simulation, cutoff_m: f64, work_functions: &[f64], i: usize, j: usize) -> f64 {
    let of = |i: usize| work_functions[usize::from(run.grains.material[i])];
    charge_transfer::work_term(VACUUM_PERMITTIVITY, [of(i), of(j)], cutoff_m)
}

/// E·n of a unit charge at grain `source` at the contact of i and j.
fn seen(run: &Simulation, source: usize, i: usize, j: usize) -> f64 {
    let offset = run.grains.position(j) - run.grains.position(i);
    let (a, b) = (run.grains.centre[i][3], run.grains.centre[j][3]);
    let normal = offset.normalize();
    let place = run.grains.position(i) + normal * (a - 0.5 * (a + b - offset.norm()));
    let from = place - run.grains.position(source);
    Permittivity::VACUUM.coulomb() * from.dot(&normal) / from.norm().powi(3)
}

#[test]
fn contacts_remember_no_areas_unless_they_charge() {
    let places = close_packed(2);
    let run = built(&places, &work_functions(places.len(), 1), None);
    assert!(run.charging.is_none());
    assert!(run.contacts.neighbours.lists.iter().all(|list| [
        list.growth.capacity(),
        list.foreseen.capacity(),
        list.grown.capacity()
    ] == [0; 3]));
}

/// E_x·n of a pair at the last evaluation [V/m].
fn foreseen(run: &Simulation, k: usize, grown: Grown) -> Option<f64> {
    let evaluation = run.field.as_ref().expect("a field").intervals().evaluations;
    run.contacts.neighbours.lists[k].foreseen[grown.entry as usize].at(evaluation, 0.0)
}

#[test]
fn field_at_contacts_is_the_direct_sum_of_all_others_there() {
    let places = close_packed(2);
    let mut run = packed(&places, &work_functions(places.len(), 1), 5e-7);
    for (n, charge) in run.particles.charge.iter_mut().enumerate() {
        *charge = 1e-14 * (n as f64 * 0.7).sin();
    }
    run.evaluate_field().expect("a good scene");
    let pairs = touching(&run);
    assert!(pairs.len() > 90);
    let count = run.grains.len();
    for (k, grown, i, j) in pairs {
        let found = foreseen(&run, k, grown).expect("it touches");
        let others = (0..count).filter(|&source| source != i && source != j);
        let term = |source: usize| grain_of(&run, source).charge * seen(&run, source, i, j);
        let exact: f64 = others.clone().map(term).sum();
        let size: f64 = others.map(|source| term(source).abs()).sum();
        assert!((found - exact).abs() < 1e-11 * size, "{i} {j}: {found:e} for {exact:e}");
    }
}

#[test]
fn charges_of_touching_grains_are_seen_before_the_next_evaluation() {
    let places = close_packed(2);
    let mut run = packed(&places, &work_functions(places.len(), 1), 5e-7);
    run.evaluate_field().expect("a good scene");
    let pairs = touching(&run);
    // One grain is charged by hand: a contact of a neighbour of its sees it once contacts relax.
    let (_, _, charged, beside) = pairs[0];
    run.particles.charge[run.grains.original[charged].index()] = 1e-13;
    let sees = |i: usize, j: usize| {
        ![i, j].contains(&charged)
            && seen(&run, charged, i, j).abs() > 1e-2 * Permittivity::VACUUM.coulomb() / (RADIUS * RADIUS)
    };
    let &(k, grown, i, j) =
        pairs.iter().find(|(_, _, i, j)| [*i, *j].contains(&beside) && sees(*i, *j)).expect("a good scene");
    assert_eq!(foreseen(&run, k, grown), Some(0.0));
    let decay = between_grains(VACUUM_PERMITTIVITY, 0.0, [grain_of(&run, i), grain_of(&run, j)], 0.0).decay;
    force(&mut run, k, grown, 1e3 / decay);
    run.trade_between_grains();
    let field = 1e-13 * seen(&run, charged, i, j);
    let drive = between_grains(
        VACUUM_PERMITTIVITY,
        work(&run, 5e-7, &work_functions(places.len(), 1), i, j),
        [grain_of(&run, i), grain_of(&run, j)],
        field,
    );
    assert!(
        drive.drive.abs() < 1e-9 * VACUUM_PERMITTIVITY * field.abs(),
        "{:e} {:e}",
        drive.drive,
        VACUUM_PERMITTIVITY * field
    );
}

/// Makes a contact's area grow [m²].
fn force(run: &mut Simulation, k: usize, grown: Grown, growth: f64) {
    let follow = Follow { moves: true, beyond: false };
    run.contacts.neighbours.lists[k].growth[grown.entry as usize].follow(growth, false, follow);
}

/// Driving terms of all contacts at the present charges, and the largest charge.
fn driving(run: &Simulation, cutoff_m: f64, works: &[f64]) -> (f64, f64) {
    let term = |(k, grown, i, j): (usize, Grown, usize, usize)| {
        let field = foreseen(run, k, grown).expect("it touches");
        let work = work(run, cutoff_m, works, i, j);
        between_grains(VACUUM_PERMITTIVITY, work, [grain_of(run, i), grain_of(run, j)], field).drive.powi(2)
    };
    let norm = touching(run).into_iter().map(term).sum::<f64>().sqrt();
    (norm, run.particles.charge.iter().fold(0.0, |largest: f64, charge| largest.max(charge.abs())))
}

/// Charges at which the driving terms are as small as charge that moves through the contacts can make them.
fn steady(run: &Simulation, cutoff_m: f64, works: &[f64]) -> f64 {
    let pairs = touching(run);
    let count = run.grains.len();
    let (mut of_charge, mut rest) = (DMatrix::zeros(pairs.len(), count), DVector::zeros(pairs.len()));
    let mut moves = DMatrix::zeros(count, pairs.len());
    for (c, &(_, _, i, j)) in pairs.iter().enumerate() {
        for source in (0..count).filter(|&source| source != i && source != j) {
            of_charge[(c, source)] = VACUUM_PERMITTIVITY * seen(run, source, i, j);
        }
        for (sign, grain) in [(1.0, i), (-1.0, j)] {
            of_charge[(c, grain)] = sign / (4.0 * PI * run.grains.centre[grain][3].powi(2));
            moves[(grain, c)] = -sign;
        }
        rest[c] = -work(run, cutoff_m, works, i, j);
    }
    let scale = 1e-9;
    let response = (&of_charge * &moves) * scale;
    let transfers = response.svd(true, true).solve(&rest, 1e-10).expect("a good scene");
    (moves * transfers * scale).amax()
}

#[test]
fn stiff_networks_stay_bounded_for_any_growth() {
    for (places, name) in [(close_packed(3), "packed"), (studded(), "studded")] {
        for (relaxation, cutoff_m) in [(1e-6, 5e-7), (0.1, 5e-7), (1.0, 1e-9), (10.0, 1e-5), (1e6, 5e-7)] {
            let works = work_functions(places.len(), 7);
            let mut run = packed(&places, &works, cutoff_m);
            run.evaluate_field().expect("a good scene");
            let pairs = touching(&run);
            let (start, _) = driving(&run, cutoff_m, &works);
            let steady = steady(&run, cutoff_m, &works);
            let (mut last, mut before) = (start, start);
            for sweep in 0..40 {
                for &(k, grown, i, j) in &pairs {
                    let pair = [grain_of(&run, i), grain_of(&run, j)];
                    let decay = between_grains(VACUUM_PERMITTIVITY, 0.0, pair, 0.0).decay;
                    force(&mut run, k, grown, relaxation / decay);
                }
                run.trade_between_grains();
                run.evaluate_field().expect("a good scene");
                let (norm, largest) = driving(&run, cutoff_m, &works);
                let case = format!(
                    "{name}, αΔA {relaxation:e}, sweep {sweep}: {norm:e} after {last:e}, start {start:e}"
                );
                assert!(norm <= last.max(PLATEAU * start), "{case}");
                assert!(norm <= before.max(PLATEAU * start), "{case}");
                assert!(largest <= 1.5 * steady, "{case}, charge {largest:e}, steady {steady:e}");
                let net: f64 = run.particles.charge.iter().sum();
                assert!(net.abs() < 1e-13 * run.ledger().expect("a good scene").moved, "{case}");
                (before, last) = (last, norm);
            }
            assert!(relaxation < 0.1 || last < PLATEAU * start, "{name} {relaxation:e} ends at {last:e}");
        }
    }
}

#[test]
fn explicit_update_of_all_at_once_runs_away_where_ours_does_not() {
    let places = close_packed(2);
    let works = work_functions(places.len(), 7);
    let mut run = packed(&places, &works, 5e-7);
    run.evaluate_field().expect("a good scene");
    let pairs = touching(&run);
    let (start, _) = driving(&run, 5e-7, &works);
    for _ in 0..10 {
        let drives: Vec<f64> = pairs
            .iter()
            .map(|&(k, grown, i, j)| {
                let field = foreseen(&run, k, grown).expect("a good scene");
                let pair = [grain_of(&run, i), grain_of(&run, j)];
                let drive = between_grains(VACUUM_PERMITTIVITY, work(&run, 5e-7, &works, i, j), pair, field);
                // αΔA = 1 of every contact.
                drive.drive / drive.decay
            })
            .collect();
        for (&(_, _, i, j), moved) in pairs.iter().zip(drives) {
            run.particles.charge[run.grains.original[i].index()] -= moved;
            run.particles.charge[run.grains.original[j].index()] += moved;
        }
        run.evaluate_field().expect("a good scene");
    }
    let (norm, _) = driving(&run, 5e-7, &works);
    assert!(norm > 1e3 * start, "{norm:e} {start:e}");
}
