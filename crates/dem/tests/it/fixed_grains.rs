//! Grains that never move: touched as if they were infinitely heavy, charged, and where they were.

use crate::common::{DENSITY, RADIUS, floor, grain, lattice, mass, material, run, setup};
use amberfield_core::{
    Boundary, ChargeTransfer, Domain, DragLaw, FieldSettings, ForceLimit, Gas, Grain, GroupId, Material,
    Method, Particles, Permittivity, Step, Vector3,
};
use amberfield_dem::{DemError, ElectricEnergy, FieldStageSetup, Setup, Simulation, State};
use amberfield_laws::hertz_mindlin as hertz;
use amberfield_oracle::{DampedHertzImpact, HertzImpact};

/// Group of the grains that never move.
const BED: GroupId = GroupId(1);
/// Speed of impacts [m/s].
const SPEED: f64 = 0.2;
/// Difference of two ways to compute the same impact in some hundred steps.
const SAME_IMPACT: f64 = 1e-9;
/// Error of a restitution at 400 steps in a contact, as in the tests of collisions.
const RESTITUTION: f64 = 1e-3;
/// Error of the largest overlap and of the energy at 400 steps in a contact.
const SECOND_ORDER: f64 = 1e-4;
/// Difference to grains that are enormously heavy.
const AS_HEAVY: f64 = 1e-6;
/// Charges that add up, over the sum of what moved.
const ROUND_OFF: f64 = 1e-13;

fn fixed(grain: Grain) -> Grain {
    Grain { group: BED, ..grain }
}

fn scene(grains: Vec<Grain>, material: Material, step_s: f64) -> Setup {
    let mut setup = setup(grains, material, step_s);
    setup.particles.fixed_groups = vec![BED];
    setup
}

/// Y*, R* and m* of a grain on a fixed one of its size.
fn pair() -> (f64, f64, f64) {
    (hertz::effective_young(1e7, 0.25, 1e7, 0.25), 0.5 * RADIUS, mass(RADIUS))
}

fn step() -> f64 {
    let (young, radius, mass) = pair();
    hertz::contact_time(young, radius, mass, SPEED) / 400.0
}

/// Overlaps and velocities of a grain that falls on something below, `gap` beneath it.
fn impact(mut setup: Setup, ground: f64) -> Vec<[f64; 2]> {
    setup.time.step = Step::Seconds(step());
    let mover = setup.particles.len() - 1;
    let mut simulation = Simulation::new(setup).expect("a good scene");
    let row = |simulation: &Simulation| {
        let p = simulation.particles();
        [p.position[mover].z - p.radius[mover] - ground, p.velocity[mover].z]
    };
    (0..600)
        .map(|_| {
            run(&mut simulation, 1);
            row(&simulation)
        })
        .collect()
}

fn on_fixed(e: f64) -> Vec<[f64; 2]> {
    let top = grain(2, [0.0, 0.0, 2.000_000_1 * RADIUS], [0.0, 0.0, -SPEED]);
    impact(scene(vec![fixed(grain(1, [0.0; 3], [0.0; 3])), top], material(e, 0.3, 0.1), 1e-6), RADIUS)
}

#[test]
fn rebound_is_that_of_a_flat_wall_and_the_effective_radius() {
    for e in [0.3, 0.7, 1.0] {
        let found = on_fixed(e);
        // The same mass and R*: half the radius and eight times the density on a plane.
        let ball = Grain {
            radius: 0.5 * RADIUS,
            density: 8.0 * DENSITY,
            ..grain(2, [0.0, 0.0, 0.500_000_1 * RADIUS], [0.0, 0.0, -SPEED])
        };
        let mut flat = setup(vec![ball], material(e, 0.3, 0.1), 1e-6);
        flat.walls = vec![floor()];
        let expected = impact(flat, 0.0);
        for ([gap, speed], [gap_of_flat, speed_of_flat]) in found.iter().zip(&expected) {
            assert!((gap - gap_of_flat).abs() < SAME_IMPACT * RADIUS, "e = {e}: {gap} {gap_of_flat}");
            assert!((speed - speed_of_flat).abs() < SAME_IMPACT * SPEED, "e = {e}: {speed} {speed_of_flat}");
        }
        let [gap, rebound] = found[found.len() - 1];
        assert!(gap > 0.0 && (rebound / SPEED - e).abs() < RESTITUTION, "e = {e}: {rebound}");
    }
}

#[test]
fn elastic_bounce_has_hertz_overlap_and_keeps_the_energy() {
    let found = on_fixed(1.0);
    let (young, radius, mass) = pair();
    let expected = hertz::largest_overlap(young, radius, mass, SPEED);
    let deepest = found.iter().map(|[gap, _]| -gap).fold(0.0, f64::max);
    assert!((deepest / expected - 1.0).abs() < SECOND_ORDER, "{deepest:e} for {expected:e}");
    let [_, rebound] = found[found.len() - 1];
    assert!(((rebound / SPEED).powi(2) - 1.0).abs() < SECOND_ORDER, "{rebound}");
}

/// A grain between fixed or heavy ones, on whose corners it bounces.
fn cage(of: impl Fn(Grain) -> Grain) -> Setup {
    let corners = (0..8_u32).map(|k| [0, 1, 2].map(|axis| if k >> axis & 1 == 1 { 1.05 } else { -1.05 }));
    let mut grains: Vec<Grain> = (1..)
        .zip(corners)
        .map(|(id, corner)| of(grain(id, corner.map(|x| 1.5 * RADIUS * x), [0.0; 3])))
        .collect();
    let mut mover = grain(9, [0.1 * RADIUS, -0.05 * RADIUS, 0.02 * RADIUS], [0.31, 0.17, -0.23]);
    mover.angular_velocity = Vector3::new(40.0, -10.0, 25.0);
    grains.push(mover);
    scene(grains, material(0.9, 0.4, 0.05), 2e-6)
}

#[test]
fn fixed_grains_are_as_heavy_ones_are() {
    let after = |setup: Setup| {
        let mut simulation = Simulation::new(setup).expect("a good scene");
        run(&mut simulation, 3000);
        let energies = simulation.energies(ElectricEnergy::LeftOut).expect("a good scene");
        (simulation.particles().grain(8), energies)
    };
    let (held, energy) = after(cage(fixed));
    let (heavy, _) = after(cage(|grain| Grain { density: 1e18 * DENSITY, ..grain }));
    let start = cage(fixed).particles.grain(8);
    assert!((held.velocity - start.velocity).norm() > 0.1, "it has bounced: {:?}", held.velocity);
    let [near, slow] = [(held.position - heavy.position).norm(), (held.velocity - heavy.velocity).norm()];
    assert!(near < AS_HEAVY * RADIUS && slow < AS_HEAVY * SPEED, "{near:e} {slow:e}");
    let spin = (held.angular_velocity - heavy.angular_velocity).norm();
    assert!(spin < AS_HEAVY * heavy.angular_velocity.norm(), "{spin:e}");
    // Energies are those of the grain that moves.
    let inertia = 0.4 * mass(RADIUS) * RADIUS * RADIUS;
    let kinetic = 0.5 * mass(RADIUS) * held.velocity.norm_squared()
        + 0.5 * inertia * held.angular_velocity.norm_squared();
    assert!((energy.kinetic / kinetic - 1.0).abs() < ROUND_OFF, "{} {kinetic}", energy.kinetic);
}

/// More than two chunks of grains that fall on a fixed bed whose grains overlap, in a box that is periodic
/// sideways.
fn bed() -> Setup {
    let half = 14.0 * RADIUS;
    let mut grains = lattice([-half, -half, 2.0 * RADIUS], [half, half, 32.0 * RADIUS], 2.1 * RADIUS, 0.2, 1);
    let first = grains.len() as u64 + 1;
    assert!(first > 2048, "{first}");
    let places = (0..400_u64).map(|k| [k % 20, k / 20].map(|n| 1.4 * RADIUS * (n as f64 + 0.5) - half));
    let below = (first..).zip(places).map(|(id, [x, y])| fixed(grain(id, [x, y, 0.0], [0.0; 3])));
    grains.extend(below);
    let mut scene = scene(grains, material(0.7, 0.4, 0.05), 5e-6);
    let mut faces = [[Boundary::Periodic; 2]; 3];
    faces[2] = [Boundary::Open; 2];
    let corners = [Vector3::new(-half, -half, -RADIUS), Vector3::new(half, half, 40.0 * RADIUS)];
    scene.domain = Domain::new(corners[0], corners[1], faces).expect("a good scene");
    scene.time.gravity_m_s2 = Vector3::new(0.5, 0.0, -9.81);
    scene
}

fn bits(particles: &Particles) -> Vec<u64> {
    let vectors = particles.position.iter().chain(&particles.velocity).chain(&particles.angular_velocity);
    vectors.flat_map(|v| v.iter().map(|x| x.to_bits())).collect()
}

fn run_with(threads: usize) -> Simulation {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| {
        let mut simulation = Simulation::new(bed()).expect("a good scene");
        run(&mut simulation, 800);
        simulation
    })
}

#[test]
fn bed_is_where_it_was_bit_for_bit_and_holds_the_others_for_any_number_of_threads() {
    let start = bed().particles;
    let mut one = run_with(1);
    let after = one.particles();
    assert!(one.contacts() > 200, "{}", one.contacts());
    for i in (0..start.len()).filter(|&i| start.is_fixed(i)) {
        let [was, is] = [start.position[i], after.position[i]].map(|x| [x.x, x.y, x.z].map(f64::to_bits));
        assert!(was == is, "grain {}", start.id[i]);
        assert!(after.velocity[i] == Vector3::zeros() && after.angular_velocity[i] == Vector3::zeros());
    }
    let lowest = after.moving().map(|i| after.position[i].z).fold(f64::INFINITY, f64::min);
    assert!(lowest > RADIUS, "{lowest}");
    assert_eq!(after.moving().count() + 400, start.len());
    let gravity: f64 = after.moving().map(|i| 9.81 * after.position[i].z * after.mass(i)).sum();
    let found = one.energies(ElectricEnergy::LeftOut).expect("a good scene").gravity;
    let sideways: f64 = after.moving().map(|i| 0.5 * after.position[i].x * after.mass(i)).sum();
    // Coordinates along periodic axes may be a period away.
    let period = 28.0 * RADIUS * 0.5 * mass(RADIUS);
    let periods = (found - gravity + sideways) / period;
    assert!((periods - periods.round()).abs() < 1e-6, "{found:e} {gravity:e} {sideways:e}");
    assert!(bits(&after) == bits(&run_with(2).particles()));
    assert!(bits(&after) == bits(&run_with(3).particles()));
}

#[test]
fn resumed_run_gives_the_same_bits() {
    let mut whole = Simulation::new(bed()).expect("a good scene");
    run(&mut whole, 500);
    let bytes = bincode::serde::encode_to_vec(whole.state(), bincode::config::standard()).expect("bytes");
    run(&mut whole, 300);
    let (state, _): (State, usize) =
        bincode::serde::decode_from_slice(&bytes, bincode::config::standard()).expect("a state");
    let mut resumed = Simulation::resume(bed(), state).expect("a good scene");
    run(&mut resumed, 300);
    assert!(bits(&whole.particles()) == bits(&resumed.particles()));
}

/// A charged field without its force, where charge moves at contacts.
fn charging(mut setup: Setup, force: Option<ForceLimit>, transfer: bool) -> Setup {
    let settings = FieldSettings { method: Method::Direct, force_limit: force, ..FieldSettings::default() };
    let member = vec![true; setup.particles.len()];
    let transfer = transfer.then(|| ChargeTransfer::new(5e-7));
    setup.field = Some(FieldStageSetup { transfer, ..FieldStageSetup::new(settings, member) });
    setup
}

#[test]
fn impact_on_a_fixed_grain_moves_the_charge_of_the_closed_form() {
    let charge = 1e-13;
    let (young, radius, mass) = pair();
    let elastic =
        HertzImpact { reduced_mass: mass, reduced_radius: radius, reduced_young: young, speed: SPEED };
    for e in [0.5, 1.0] {
        let solid = Material { work_function_ev: Some(4.5), ..material(e, 0.0, 0.0) };
        let below = Grain { charge: -charge, ..fixed(grain(1, [0.0; 3], [0.0; 3])) };
        // Contact begins somewhere within a step.
        let height = 2.0 * RADIUS + 20.37 * step() * SPEED;
        let top = Grain { charge, ..grain(2, [0.0, 0.0, height], [0.0, 0.0, -SPEED]) };
        let mut setup =
            charging(scene(vec![below, top], solid, step()), Some(ForceLimit { factor: 0.0 }), true);
        setup.time.step = Step::Seconds(step());
        let mut simulation = Simulation::new(setup).expect("a good scene");
        run(&mut simulation, 1500);
        assert_eq!(simulation.contacts(), 0, "they have parted");
        let after = simulation.particles();
        assert!(after.net_charge().abs() < ROUND_OFF * charge);
        let expected = DampedHertzImpact { elastic, restitution: e }.charge_moved(RADIUS, charge);
        let moved = charge - after.charge[1];
        assert!((moved / expected - 1.0).abs() < SECOND_ORDER, "e = {e}: {moved:e} for {expected:e}");
        assert!(moved > 0.0 && (after.charge[0] + charge - moved).abs() < ROUND_OFF * charge);
    }
}

#[test]
fn fixed_charges_push_and_feel_nothing_and_no_two_of_them_trade() {
    let charge = 1e-11;
    let solid = Material { work_function_ev: Some(4.5), ..material(0.9, 0.3, 0.0) };
    // Two fixed grains overlap, with charges that they would trade.
    let distance = 8.0 * RADIUS;
    let one = Grain { charge, ..fixed(grain(1, [0.0; 3], [0.0; 3])) };
    let other = Grain { charge: -0.5 * charge, ..fixed(grain(2, [-RADIUS, 0.0, 0.0], [0.0; 3])) };
    let mover = Grain { charge, ..grain(3, [distance, 0.0, 0.0], [0.0; 3]) };
    let mut simulation = Simulation::new(charging(scene(vec![one, other, mover], solid, 1e-6), None, true))
        .expect("a good scene");
    let coulomb = Permittivity::VACUUM.coulomb() * charge * charge;
    let expected = coulomb / distance.powi(2) - 0.5 * coulomb / (distance + RADIUS).powi(2);
    run(&mut simulation, 1);
    let force = simulation.electric_forces().expect("a field")[2];
    assert!((force.x / expected - 1.0).abs() < 1e-6, "{force:?} for {expected:e}");
    run(&mut simulation, 200);
    let after = simulation.particles();
    assert_eq!(after.charge, [charge, -0.5 * charge, charge]);
    assert_eq!(after.position[..2], [Vector3::zeros(), Vector3::new(-RADIUS, 0.0, 0.0)]);
    assert!(after.velocity[2].x > 0.0);
    assert_eq!(simulation.contacts(), 0);
}

#[test]
fn gas_and_gravity_leave_fixed_grains_and_the_guards_alone() {
    let gas = Gas {
        drag: DragLaw::SchillerNaumann,
        density_kg_m3: 1.2,
        viscosity_pa_s: 1.8e-5,
        velocity_m_s: Vector3::new(3.0, 0.0, 0.0),
        magnus_lift: true,
        flow: None,
    };
    // Dust, for which the step would be far too long if it moved.
    let dust = Grain { radius: 0.01 * RADIUS, ..fixed(grain(1, [0.0; 3], [0.0; 3])) };
    let mover = grain(2, [0.0, 0.0, 5.0 * RADIUS], [0.0; 3]);
    let mut windy = scene(vec![dust, mover], material(0.9, 0.3, 0.0), 2e-5);
    windy.gas = Some(gas.into());
    windy.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
    let mut alone = setup(vec![mover], material(0.9, 0.3, 0.0), 2e-5);
    alone.gas = Some(gas.into());
    alone.time.gravity_m_s2 = windy.time.gravity_m_s2;
    let [mut windy, mut alone] = [windy, alone].map(|scene| Simulation::new(scene).expect("a good scene"));
    assert_eq!(windy.guards(), alone.guards());
    run(&mut windy, 50);
    run(&mut alone, 50);
    let [with, without] = [windy.particles(), alone.particles()];
    assert_eq!((with.position[0], with.velocity[0]), (Vector3::zeros(), Vector3::zeros()));
    assert_eq!((with.position[1], with.velocity[1]), (without.position[0], without.velocity[0]));
    assert!(with.velocity[1].x > 0.0 && with.velocity[1].z < 0.0);
}

#[test]
fn fixed_grains_may_overlap_each_other_and_walls_but_no_grain_that_moves() {
    let one = fixed(grain(1, [0.0; 3], [0.0; 3]));
    let other = fixed(grain(2, [0.5 * RADIUS, 0.0, 0.0], [0.0; 3]));
    let solid = || material(0.9, 0.3, 0.0);
    let mut good = scene(vec![one, other], solid(), 1e-6);
    good.walls = vec![floor()];
    let mut simulation = Simulation::new(good).expect("a good scene");
    run(&mut simulation, 10);
    assert_eq!(
        (simulation.contacts(), simulation.energies(ElectricEnergy::LeftOut).unwrap().kinetic),
        (0, 0.0)
    );
    let deep = grain(3, [0.0, 0.0, 1.5 * RADIUS], [0.0; 3]);
    let error = Simulation::new(scene(vec![one, other, deep], solid(), 1e-6)).unwrap_err();
    assert!(matches!(error, DemError::Overlap { count: 2, .. }), "{error}");
}

#[test]
fn fixed_grains_that_cannot_be_are_refused() {
    let refusal = |grains: Vec<Grain>| {
        Simulation::new(scene(grains, material(0.9, 0.3, 0.0), 1e-6)).unwrap_err().to_string()
    };
    let fast = refusal(vec![fixed(grain(4, [0.0; 3], [0.0, 1e-3, 0.0]))]);
    assert!(fast.contains("grain 4") && fast.contains("never moves"), "{fast}");
    let here = fixed(grain(7, [0.0; 3], [0.0; 3]));
    let same =
        refusal(vec![here, fixed(grain(5, [3.0 * RADIUS, 0.0, 0.0], [0.0; 3])), Grain { id: 6, ..here }]);
    assert!(same.contains("grains 6 and 7 have the same centre"), "{same}");
    let mut automatic = scene(vec![here], material(0.9, 0.3, 0.0), 1e-6);
    automatic.time.step = Step::Auto;
    let none = Simulation::new(automatic).unwrap_err().to_string();
    assert!(none.contains("at least one grain that moves"), "{none}");
}
