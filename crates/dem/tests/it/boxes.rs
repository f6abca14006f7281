//! Small periodic boxes, size mixtures across periodic faces, what a scene does not need, and guards.

use crate::common::{RADIUS, floor, grain, lattice, material, mesh_floor, run, setup};
use amberfield_core::{
    Boundary, CouplingInterval, Domain, DragLaw, FieldSettings, ForceLimit, Gas, Method, OnExit, Particles,
    Vector3,
};
use amberfield_dem::{DemError, ElectricEnergy, FieldStageSetup, Setup, Simulation};
use proptest::prelude::*;

/// Contacts found by looking at every pair and every image.
fn brute_contacts(domain: &Domain, p: &Particles) -> usize {
    let extent = domain.extent();
    let mut count = 0;
    for i in 0..p.len() {
        for j in i + 1..p.len() {
            let mut d = p.position[j] - p.position[i];
            for a in 0..3 {
                d[a] -= extent[a] * (d[a] / extent[a]).round();
            }
            count += usize::from(d.norm() < p.radius[i] + p.radius[j]);
        }
    }
    count
}

fn periodic(half: f64) -> Domain {
    Domain::new(Vector3::repeat(-half), Vector3::repeat(half), [[Boundary::Periodic; 2]; 3])
        .expect("a good scene")
}

/// Deterministic scattered numbers in [−1, 1).
fn scatter(k: u64) -> f64 {
    2.0 * ((k.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11) as f64 / (1_u64 << 53) as f64) - 1.0
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, ..ProptestConfig::default() })]

    /// A 100:1 mixture in a periodic box has at every moment the contacts that a search of all pairs finds.
    #[test]
    fn mixture_across_periodic_faces_has_every_contact(seed in 0_u64..10_000) {
        let (big, small) = (RADIUS, 0.01 * RADIUS);
        let half = 2.4 * big;
        let mut grains = Vec::new();
        for k in 0..400_u64 {
            let n = 6 * k + 10_000 * seed;
            let at = |a| half * 0.999 * scatter(n + a);
            // Big ones touch the faces; small ones sit near the big ones' surfaces.
            let position = if k < 4 {
                let s = |bit: u64| if (k ^ seed) >> bit & 1 == 0 { 0.55 } else { -0.55 };
                Vector3::new(half * s(0), half * s(1), half * s(0) * s(1).signum())
            } else {
                let centre: Vector3<f64> = grains[(k % 4) as usize % grains.len()];
                let direction = Vector3::new(at(0), at(1), at(2)).normalize();
                centre + direction * (big + small * (1.0 + 0.3 * scatter(n + 3)))
            };
            grains.push(position);
        }
        let domain = periodic(half);
        let grains: Vec<_> = grains.iter().enumerate().map(|(k, x)| {
            let x = domain.wrap(*x);
            let n = 6 * k as u64 + 10_000 * seed;
            let v = [0.2 * scatter(n + 4), 0.2 * scatter(n + 5), 0.2 * scatter(n + 7)];
            let mut g = grain(k as u64, [x.x, x.y, x.z], v);
            g.radius = if k < 4 { big } else { small };
            g
        }).collect();
        let mut scene = setup(grains, material(0.7, 0.3, 0.0), 1e-7);
        scene.domain = domain.clone();
        scene.time.allow_overlap = true;
        scene.time.allow_unstable = true;
        let mut simulation = Simulation::new(scene).expect("a good scene");
        for _ in 0..12 {
            run(&mut simulation, 25);
            prop_assert_eq!(simulation.contacts(), brute_contacts(&domain, &simulation.particles()));
        }
    }
}

#[test]
fn few_grains_in_the_smallest_periodic_box_keep_momentum_and_energy() {
    // Two largest diameters and two skins, and a little.
    let half = 0.5 * (4.0 * RADIUS + 0.4 * RADIUS) * 1.0001;
    let domain = periodic(half);
    let grains = vec![
        grain(1, [-half, 0.0, 0.0], [0.3, 0.1, -0.2]),
        grain(2, [0.0, half, 0.3e-3], [-0.3, 0.2, 0.1]),
        grain(3, [0.0, 0.0, -half], [0.1, -0.3, 0.1]),
        grain(4, [-half, half, -half], [-0.1, 0.0, 0.0]),
    ];
    let mut scene = setup(grains, material(1.0, 0.0, 0.0), 1e-6);
    scene.domain = domain.clone();
    let mut simulation = Simulation::new(scene).expect("a good scene");
    let momentum = |p: &Particles| p.velocity.iter().sum::<Vector3<f64>>();
    let start = simulation.particles();
    let energy = simulation.energies(ElectricEnergy::LeftOut).expect("a good scene").kinetic;
    let mut met = 0;
    for _ in 0..300 {
        run(&mut simulation, 100);
        met += simulation.contacts();
        let (p, e) =
            (simulation.particles(), simulation.energies(ElectricEnergy::LeftOut).expect("a good scene"));
        assert_eq!(simulation.contacts(), brute_contacts(&domain, &p));
        assert!((momentum(&p) - momentum(&start)).norm() < 1e-12);
        // Elastic: second order at some 300 steps in a collision, a few dozen collisions.
        assert!(((e.kinetic + e.contact) / energy - 1.0).abs() < 1e-3);
    }
    assert!(met > 20, "{met}");
}

/// Mixed sizes that fall on a mesh floor in a box open at one side, through which grains leave; charged,
/// limited.
fn everything() -> Setup {
    let half = 12.0 * RADIUS;
    let mut grains = lattice([-half, -half, 0.0], [half, half, 20.0 * RADIUS], 2.1 * RADIUS, 0.8, 4);
    for (k, g) in grains.iter_mut().enumerate() {
        g.radius *= if k % 3 == 0 { 1.0 } else { 0.2 };
        g.charge = if k % 2 == 0 { 2e-12 } else { -2e-12 };
    }
    let count = grains.len();
    let mut scene = setup(grains, material(0.7, 0.4, 0.05), 4e-6);
    let mut faces = [[Boundary::Open; 2]; 3];
    faces[1] = [Boundary::Periodic; 2];
    let corner = Vector3::new(half, half, 30.0 * RADIUS);
    scene.domain = Domain::new(Vector3::new(-half, -half, -RADIUS), corner, faces).expect("a good scene");
    scene.walls = vec![mesh_floor(20.0 * RADIUS, 9)];
    scene.time.gravity_m_s2 = Vector3::new(200.0, 0.0, -9.81);
    scene.time.on_exit = OnExit::Delete;
    scene.gas = Some(
        Gas {
            drag: DragLaw::SchillerNaumann,
            density_kg_m3: 1.2,
            viscosity_pa_s: 1.8e-5,
            velocity_m_s: Vector3::new(0.0, 1.0, 0.0),
            magnus_lift: true,
            flow: None,
        }
        .into(),
    );
    let settings = FieldSettings {
        method: Method::Cutoff,
        cutoff_radius_m: Some(3.0 * RADIUS),
        force_limit: Some(ForceLimit { factor: 1e-6 }),
        coupling_interval: CouplingInterval::Auto,
        ..FieldSettings::default()
    };
    scene.field = Some(FieldStageSetup::new(settings, vec![true; count]));
    scene
}

#[test]
fn everything_at_once_has_the_same_bits_for_any_threads_and_on_resume() {
    let with = |threads: usize, stop: Option<u64>| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a good scene");
        pool.install(|| {
            let mut simulation = Simulation::new(everything()).expect("a good scene");
            let start = simulation.len();
            if let Some(stop) = stop {
                run(&mut simulation, stop);
                simulation = Simulation::resume(everything(), simulation.state()).expect("a good scene");
                run(&mut simulation, 1000 - stop);
            } else {
                run(&mut simulation, 1000);
            }
            assert!(
                simulation.len() < start && simulation.contacts() > 5,
                "{} {}",
                simulation.len(),
                simulation.contacts()
            );
            assert!(simulation.limited().expect("a good scene").grain_steps > 0);
            (simulation.particles(), simulation.electric_forces(), simulation.limited())
        })
    };
    let one = with(1, None);
    assert!(one == with(2, None) && one == with(3, None));
    assert!(one == with(2, Some(637)));
}

#[test]
fn last_grain_may_leave() {
    let mut scene = setup(vec![grain(1, [0.0, 0.0, 0.999], [0.0, 0.0, 1.0])], material(0.9, 0.3, 0.0), 1e-5);
    scene.walls = vec![floor()];
    scene.time.on_exit = OnExit::Delete;
    scene.particles.charge = vec![1e-12];
    let settings = FieldSettings {
        method: Method::Direct,
        coupling_interval: CouplingInterval::Steps(3),
        ..FieldSettings::default()
    };
    scene.field = Some(FieldStageSetup::new(settings, vec![true]));
    let mut simulation = Simulation::new(scene).expect("a good scene");
    run(&mut simulation, 300);
    assert!(simulation.is_empty());
    let resumed = simulation.state();
    assert_eq!(resumed.step_index(), 300);
}

#[test]
fn guards_are_watched_when_the_field_is_evaluated() {
    // A cloud that is compressed: nothing touches, lists are never rebuilt, yet its plasma frequency grows.
    let scene = |allow| {
        let mut grains = Vec::new();
        for k in 0..8_u64 {
            let s = |bit: u64| if k >> bit & 1 == 0 { -1.0 } else { 1.0 };
            let mut g =
                grain(k, [s(0) * 0.1, s(1) * 0.1, s(2) * 0.1], [-s(0) * 20.0, -s(1) * 20.0, -s(2) * 20.0]);
            g.charge = if k.count_ones() % 2 == 0 { 3e-8 } else { -3e-8 };
            grains.push(g);
        }
        let mut scene = setup(grains, material(0.9, 0.0, 0.0), 1e-5);
        scene.time.allow_unstable = allow;
        // A skin that is never used up.
        scene.time.skin = amberfield_core::Skin::Metres(1.0);
        let settings = FieldSettings {
            method: Method::Direct,
            coupling_interval: CouplingInterval::Steps(60),
            ..FieldSettings::default()
        };
        scene.field = Some(FieldStageSetup::new(settings, vec![true; 8]));
        scene
    };
    let mut simulation = Simulation::new(scene(false)).expect("a good scene");
    let error = (0..450).find_map(|_| simulation.step().err());
    assert!(matches!(error, Some(DemError::Unstable { guard: "plasma", .. })), "{error:?}");
    let mut simulation = Simulation::new(scene(true)).expect("a good scene");
    run(&mut simulation, 450);
}
