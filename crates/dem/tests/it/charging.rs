//! Charge traded on contact: closed forms, balances, resume.

use crate::common::{domain, floor, grain, lattice, material, mesh_floor, run, setup};
use amberfield_core::{
    Boundary, ChargeTransfer, Domain, FieldSettings, ForceLimit, Grain, Material, Method, Vector3, Wall,
    WallCharging, WallShape,
};
use amberfield_dem::{FieldStageSetup, Setup, Simulation, State};
use amberfield_oracle::{DampedHertzImpact, HertzImpact};
use proptest::prelude::*;

/// The grains of DESIGN §4.
pub(super) const RADIUS: f64 = 75e-6;
const DENSITY: f64 = 1000.0;
const CHARGE: f64 = 1e-13;
const SPEED: f64 = 0.1;
pub(super) const CUTOFF: f64 = 5e-7;
/// Charge of one impact at 400 steps a contact, relative.
const ONE_IMPACT: f64 = 1e-4;
/// The largest area lies between two steps: the error is of second order, bounded by this over the squared
/// number of steps.
const SECOND_ORDER: f64 = 10.0;
/// Charges that add up, over the sum of what moved.
const ROUND_OFF: f64 = 1e-13;

pub(super) fn solid(young_pa: f64, restitution: f64) -> Material {
    Material {
        young_pa,
        poisson: 0.3,
        density_kg_m3: DENSITY,
        work_function_ev: Some(4.5),
        ..material(restitution, 0.0, 0.0)
    }
}

fn ball(id: u64, position: [f64; 3], velocity: [f64; 3], charge: f64) -> Grain {
    Grain { radius: RADIUS, density: DENSITY, charge, ..grain(id, position, velocity) }
}

/// The field without its force.
pub(super) fn transfer(setup: Setup, transfer: ChargeTransfer) -> Setup {
    let settings = FieldSettings {
        method: Method::Direct,
        force_limit: Some(ForceLimit { factor: 0.0 }),
        ..FieldSettings::default()
    };
    let member = vec![true; setup.particles.len()];
    let field = FieldStageSetup { transfer: Some(transfer), ..FieldStageSetup::new(settings, member) };
    Setup { field: Some(field), ..setup }
}

fn impact(young: f64, restitution: f64) -> DampedHertzImpact {
    let elastic = HertzImpact::equal_spheres(RADIUS, DENSITY, young, 0.3, SPEED);
    DampedHertzImpact { elastic, restitution }
}

/// Charge that moves in one impact.
fn moved(material: Material, settings: ChargeTransfer, steps_a_contact: f64) -> f64 {
    let elastic = impact(material.young_pa, 1.0).elastic;
    let step = elastic.contact_time() / steps_a_contact;
    // Contact begins somewhere within a step.
    let gap = 20.37 * step * SPEED;
    let left = ball(1, [-RADIUS - 0.5 * gap, 0.0, 0.0], [0.5 * SPEED, 0.0, 0.0], CHARGE);
    let right = ball(2, [RADIUS + 0.5 * gap, 0.0, 0.0], [-0.5 * SPEED, 0.0, 0.0], -CHARGE);
    let mut simulation =
        Simulation::new(transfer(setup(vec![left, right], material, step), settings)).expect("a good scene");
    run(&mut simulation, (3.0 * steps_a_contact) as u64);
    assert_eq!(simulation.contacts(), 0, "they have parted");
    let charge = simulation.particles().charge;
    assert!((charge[0] + charge[1]).abs() < ROUND_OFF * CHARGE);
    assert!(
        (simulation.ledger().expect("a good scene").moved - (CHARGE - charge[0])).abs() < ROUND_OFF * CHARGE
    );
    CHARGE - charge[0]
}

#[test]
fn one_impact_moves_the_charge_of_the_closed_form() {
    for young in [1e5, 1e6, 1e7, 1e8] {
        for restitution in [1.0, 0.9, 0.3] {
            let exact = impact(young, restitution).charge_moved(RADIUS, CHARGE);
            for steps in [100.0, 400.0] {
                let moved = moved(solid(young, restitution), ChargeTransfer::new(CUTOFF), steps);
                let error = (moved / exact - 1.0).abs();
                let bound = SECOND_ORDER / (steps * steps);
                assert!(error < bound, "Y {young:e} e {restitution}: {moved:e} for {exact:e}, {error:e}");
                assert!(steps < 400.0 || error < ONE_IMPACT, "Y {young:e} e {restitution}: {error:e}");
            }
        }
    }
}

#[test]
fn corrected_areas_collapse_on_the_real_stiffness() {
    let settings = ChargeTransfer { stiffness_correction: Some(1.0), ..ChargeTransfer::new(CUTOFF) };
    for restitution in [1.0, 0.9, 0.3] {
        let exact = impact(1e8, restitution).charge_moved(RADIUS, CHARGE);
        for young in [1e5, 1e6, 1e7, 1e8] {
            let soft = Material { young_real_pa: Some(1e8), ..solid(young, restitution) };
            let error = moved(soft, settings, 400.0) / exact - 1.0;
            // A smaller exponent αA leaves 1 − e^{−αA} a little nearer to αA: that is no error of the area.
            assert!(error.abs() < ONE_IMPACT, "Y {young:e} e {restitution}: {error:e}");
        }
    }
}

/// A ball that falls on a wall again and again, and loses nothing.
fn bounces(wall: Wall, domain: Domain, work: [f64; 2], count: usize) -> (Vec<f64>, f64) {
    let young = 1e6;
    let [of_ball, of_wall] = work;
    let grain_material = Material { work_function_ev: Some(of_ball), ..solid(young, 1.0) };
    let wall_material = Material { work_function_ev: Some(of_wall), ..solid(young, 1.0) };
    let gravity = 9.81;
    let height = 2.0 * RADIUS;
    let speed = (2.0 * gravity * height).sqrt();
    let of_pair = HertzImpact::equal_spheres(RADIUS, DENSITY, young, 0.3, speed);
    let elastic = HertzImpact { reduced_mass: 2.0 * of_pair.reduced_mass, reduced_radius: RADIUS, ..of_pair };
    let step = elastic.contact_time() / 400.0;
    let start = ball(1, [1e-6, 2e-6, RADIUS + height], [0.0; 3], 0.0);
    let wall = Wall { material: amberfield_core::MaterialId(1), ..wall };
    let mut scene = setup(vec![start], grain_material, step);
    scene.materials.push(wall_material);
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -gravity);
    scene = Setup { walls: vec![wall], domain, ..scene };
    let mut simulation = Simulation::new(transfer(scene, ChargeTransfer::new(CUTOFF))).expect("a good scene");
    let mut charges = Vec::new();
    let mut touching = false;
    while charges.len() < count {
        simulation.step().expect("a good scene");
        let now = simulation.contacts() > 0;
        if touching && !now {
            charges.push(simulation.particles().charge[0]);
        }
        touching = now;
    }
    let ledger = simulation.ledger().expect("a good scene");
    let held: f64 = simulation.charged_spots().map(|(spot, _)| spot.charge).sum();
    assert!((ledger.walls[0] + charges[charges.len() - 1]).abs() < ROUND_OFF * ledger.moved);
    assert!((ledger.walls[0] - held).abs() < ROUND_OFF * ledger.moved);
    // Gravity does not end at touch: the ball falls by the overlap too.
    let overlap = (0..9).fold(0.0, |overlap: f64, _| {
        let speed = (speed * speed + 2.0 * gravity * overlap).sqrt();
        HertzImpact { speed, ..elastic }.largest_overlap()
    });
    (charges, overlap / (2.0 * RADIUS))
}

#[test]
fn bounces_on_one_spot_approach_the_steady_charge() {
    let grounded = |wall: Wall| Wall { charging: WallCharging::Grounded, ..wall };
    let plane = || grounded(floor());
    let mesh = || grounded(mesh_floor(1e-3, 7));
    let open = || domain(1.0, Boundary::Open);
    // The wall as a face of the field's domain: the grain's own image comes with the field.
    let faces = [[Boundary::Open; 2], [Boundary::Open; 2], [Boundary::Grounded, Boundary::Open]];
    let face =
        || Domain::new(Vector3::new(-1.0, -1.0, 0.0), Vector3::repeat(1.0), faces).expect("a good scene");
    let kept = |wall: Wall| Wall { charging: WallCharging::Insulating, ..wall };
    let insulating = Boundary::Insulating { normal_field_v_m: 0.0 };
    let faces = [[Boundary::Open; 2], [Boundary::Open; 2], [insulating, Boundary::Open]];
    let insulator =
        || Domain::new(Vector3::new(-1.0, -1.0, 0.0), Vector3::repeat(1.0), faces).expect("a good scene");
    // What one grain leaves on an insulator acts on it as the image in a conductor does.
    for (name, wall, domain) in [
        ("plane", plane(), open()),
        ("mesh", mesh(), open()),
        ("face", plane(), face()),
        ("insulating plane", kept(floor()), open()),
        ("insulating mesh", kept(mesh_floor(1e-3, 7)), open()),
        ("insulating fine mesh", kept(mesh_floor(1e-4, 40)), open()),
        ("insulating face", kept(floor()), insulator()),
    ] {
        let (charges, relaxation) = bounces(wall, domain, [5.0, 4.0], 20);
        let steady = -6.2587e-13;
        for (n, charge) in charges.iter().enumerate() {
            let expected = steady * (1.0 - (-(n as f64 + 1.0) * relaxation).exp());
            let bound = if name.starts_with("insulating") { 5.0 * ONE_IMPACT } else { ONE_IMPACT };
            assert!(
                (charge / expected - 1.0).abs() < bound,
                "{name}, bounce {n}: {charge:e} for {expected:e}"
            );
        }
    }
}

#[test]
fn own_image_in_an_insulating_face_moves_no_charge() {
    let wall = || Wall { charging: WallCharging::Insulating, ..floor() };
    let insulating = Boundary::Insulating { normal_field_v_m: 0.0 };
    let faces = [[Boundary::Open; 2], [Boundary::Open; 2], [insulating, Boundary::Open]];
    let face = Domain::new(Vector3::new(-1.0, -1.0, 0.0), Vector3::repeat(1.0), faces).expect("a good scene");
    let (alone, _) = bounces(wall(), domain(1.0, Boundary::Open), [5.0, 4.0], 1);
    let (before_face, _) = bounces(wall(), face, [5.0, 4.0], 1);
    assert!((before_face[0] / alone[0] - 1.0).abs() < ONE_IMPACT, "{before_face:?} {alone:?}");
}

#[test]
fn breakdown_field_ends_the_charging() {
    // Steady charge of 1 eV: 1 eV/(eδ) = 2 MV/m at the contact, which 0.2 MV/m cuts to 10 %.
    let limit = 2e5;
    let wall = Wall { charging: WallCharging::Grounded, ..floor() };
    let settings = ChargeTransfer { breakdown_field_v_m: Some(limit), ..ChargeTransfer::new(CUTOFF) };
    let mut start = ball(1, [0.0, 0.0, 0.95 * RADIUS], [0.0, 0.0, -0.3], 0.0);
    start.charge = -5e-14;
    let mut scene = setup(vec![start], solid(1e5, 1.0), 1e-8);
    scene.materials.push(Material { work_function_ev: Some(4.5 - 1.0), ..solid(1e5, 1.0) });
    scene.walls = vec![Wall { material: amberfield_core::MaterialId(1), ..wall }];
    scene.time.allow_overlap = true;
    let mut simulation = Simulation::new(transfer(scene, settings)).expect("a good scene");
    run(&mut simulation, 10_000);
    let charge = simulation.particles().charge[0];
    let field = charge / (2.0 * std::f64::consts::PI * 8.854_187_812_8e-12 * RADIUS * RADIUS);
    assert!((field / -limit - 1.0).abs() < 1e-9, "{field:e}");
}

/// Grains of two materials that are shaken between charging walls of every kind.
fn shaken(seed: u64, work: f64, settings: ChargeTransfer, friction: f64) -> Setup {
    const HALF: f64 = 5e-4;
    let faces = [[Boundary::Periodic; 2], [Boundary::Grounded; 2], [Boundary::Open; 2]];
    let corner = Vector3::new(HALF, 1.2 * HALF, 1.2 * HALF);
    let mut grains = lattice([0.0; 3], [6e-3, 6e-3, 6e-3], 2.1e-3, 0.5, seed);
    let scale = HALF / 3e-3;
    for (n, grain) in grains.iter_mut().enumerate() {
        grain.position = (grain.position - Vector3::repeat(3e-3)) * scale;
        grain.radius *= scale;
        grain.material = amberfield_core::MaterialId((n % 2) as u16);
        grain.charge = 1e-14 * (n as f64 % 5.0 - 2.0);
    }
    let shape = |normal: Vector3<f64>| WallShape::Plane { point: normal * -HALF, normal };
    let wall = |normal, charging| Wall { charging, ..crate::common::wall(shape(normal)) };
    let mut mesh = mesh_floor(HALF, 2);
    if let WallShape::Mesh(mesh) = &mut mesh.shape {
        mesh.vertices.iter_mut().for_each(|v| v.z = -HALF);
    }
    let mut scene = setup(grains, Material { friction, ..solid(1e6, 0.8) }, 1e-7);
    scene.materials.push(Material { work_function_ev: Some(4.5 + work), ..solid(1e6, 0.8) });
    scene.domain = Domain::new(-corner, corner, faces).expect("a good scene");
    scene.walls = vec![
        wall(Vector3::y(), WallCharging::Grounded),
        wall(-Vector3::y(), WallCharging::Insulating),
        Wall { charging: WallCharging::Insulating, ..mesh },
        wall(-Vector3::z(), WallCharging::None),
    ];
    transfer(scene, settings)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn charge_of_grains_and_walls_is_conserved(
        seed in 0_u64..1000,
        work in -1.0..1.0_f64,
        beyond in any::<bool>(),
        breakdown in any::<bool>(),
        friction in prop_oneof![Just(0.0), Just(0.3)],
    ) {
        let settings = ChargeTransfer {
            beyond_previous_maximum: beyond,
            breakdown_field_v_m: breakdown.then_some(1e6),
            stiffness_correction: None,
            cutoff_m: CUTOFF,
        };
        let mut simulation = Simulation::new(shaken(seed, work, settings, friction)).expect("a good scene");
        let before = simulation.particles().net_charge();
        run(&mut simulation, 10_000);
        let ledger = simulation.ledger().expect("a good scene").clone();
        let after = simulation.particles().net_charge() + ledger.walls.iter().sum::<f64>();
        prop_assert!(ledger.moved > 0.0 && ledger.walls[3] == 0.0);
        prop_assert!((after - before).abs() < ROUND_OFF * ledger.moved, "{before:e} {after:e} {ledger:?}");
    }
}

#[test]
fn resumed_run_and_any_number_of_threads_are_bit_for_bit_the_same() {
    let settings = ChargeTransfer { beyond_previous_maximum: true, ..ChargeTransfer::new(CUTOFF) };
    let scene = || shaken(3, 0.5, settings, 0.3);
    let mut whole = Simulation::new(scene()).expect("a good scene");
    run(&mut whole, 1503);
    let text =
        bincode::serde::encode_to_vec(whole.state(), bincode::config::standard()).expect("a good scene");
    let (state, _): (State, usize) =
        bincode::serde::decode_from_slice(&text, bincode::config::standard()).expect("a good scene");
    let mut resumed = Simulation::resume(scene(), state).expect("a good scene");
    run(&mut whole, 700);
    run(&mut resumed, 700);
    assert_eq!(whole.state(), resumed.state());
    assert!(whole.ledger().expect("a good scene").moved > 0.0);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("a good scene");
    let threads = pool.install(|| {
        let mut threads = Simulation::new(scene()).expect("a good scene");
        run(&mut threads, 2203);
        threads.state()
    });
    assert_eq!(whole.state(), threads);
}
