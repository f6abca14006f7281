//! Distance of the time step's guards from the true edge of stability, found by bisection.

use crate::common::{RADIUS, grain, material, setup};
use amberfield_core::{
    Boundary, CouplingInterval, Domain, DragLaw, FieldSettings, Gas, Method, Permittivity, Skin, Step,
    Vector3,
};
use amberfield_dem::{FieldStageSetup, Setup, Simulation};

const CHARGE: f64 = 5e-10;
/// Displacement from rest at the start, over a radius.
const DISPLACED: f64 = 1e-5;
/// Growth that no stable motion has, and the steps in which an unstable one has it.
const GROWTH: f64 = 100.0;
const STEPS: usize = 3000;
/// Distance of the next charge over a radius: they all but touch.
const NEXT: f64 = 2.01;
/// Guards of harmonic motions agree with the edge.
const AGREEMENT: f64 = 0.05;

/// Charges at z = `heights` over a radius, held by an external field along z; the first one is looked at.
fn held(heights: &[f64], floor: Boundary, field: f64) -> Setup {
    let grains = heights.iter().enumerate().map(|(n, height)| {
        let mut grain = grain(n as u64, [0.0, 0.0, height * RADIUS], [0.0; 3]);
        grain.charge = CHARGE;
        if n > 0 {
            grain.density = 1e15;
        }
        grain
    });
    let mut scene = setup(grains.collect(), material(0.9, 0.0, 0.0), 1.0);
    let open = [Boundary::Open; 2];
    let (min, max) = (Vector3::new(-1.0, -1.0, 0.0), Vector3::repeat(1.0));
    scene.domain = Domain::new(min, max, [open, open, [floor, Boundary::Open]]).expect("a good box");
    scene.time.skin = Skin::Metres(RADIUS);
    scene.time.allow_unstable = true;
    let settings = FieldSettings {
        method: Method::Direct,
        coupling_interval: CouplingInterval::Steps(1),
        external_field_v_m: Vector3::new(0.0, 0.0, field),
        ..FieldSettings::default()
    };
    scene.field = Some(FieldStageSetup::new(settings, vec![true; heights.len()]));
    scene
}

/// Whether the first grain stays where it is.
fn stays(scene: &Setup, step: f64) -> bool {
    let mut scene = scene.clone();
    scene.time.step = Step::Seconds(step);
    let mut run = Simulation::new(scene).expect("a good scene");
    let start = run.particles().position[0];
    (0..STEPS).all(|_| {
        let is_good = run.step().is_ok();
        is_good && (run.particles().position[0] - start).norm() < GROWTH * DISPLACED * RADIUS
    })
}

/// Longest stable step over the guard's limit.
fn edge_over(guard: &str, scene: &Setup) -> f64 {
    let mut first = scene.clone();
    first.time.step = Step::Seconds(1e-9);
    let guards = Simulation::new(first).expect("a good scene").guards();
    let limit = guards.iter().find(|g| g.name == guard).expect("the guard is there").limit_s;
    let (mut stable, mut unstable) = (0.25, 16.0);
    assert!(stays(scene, stable * limit) && !stays(scene, unstable * limit), "{guard}: {limit:e} s");
    while unstable / stable > 1.005 {
        let middle = (stable * unstable).sqrt();
        if stays(scene, middle * limit) {
            stable = middle;
        } else {
            unstable = middle;
        }
    }
    stable
}

#[test]
fn pair_guard_is_the_edge_for_a_charge_between_two_others() {
    // Both push it back: twice the stiffness of one is one's with half the mass, as the guard has it for
    // equal grains.
    let scene = held(&[10.0 + DISPLACED, 10.0 - NEXT, 10.0 + NEXT], Boundary::Open, 0.0);
    let edge = edge_over("electric pair", &scene);
    assert!((edge - 1.0).abs() < AGREEMENT, "{edge}");
}

#[test]
fn plasma_guard_is_within_the_edge_for_a_charge_whose_field_is_extrapolated() {
    // The box around the three makes ω_p nearly the charge's own frequency. No interval is stable for ever;
    // this one's growth is not seen in thousands of steps.
    let mut scene = held(&[10.0 + DISPLACED, 10.0 - NEXT, 10.0 + NEXT], Boundary::Open, 0.0);
    for interval in [4, 20] {
        let field = scene.field.as_mut().expect("a field");
        field.settings.coupling_interval = CouplingInterval::Steps(interval);
        let edge = edge_over("plasma", &scene);
        assert!(edge > 1.0, "interval {interval}: {edge}");
    }
}

#[test]
fn wall_image_guard_is_the_edge_for_a_charge_that_hovers_over_an_insulator() {
    let height = 0.5 * NEXT;
    let hover = Permittivity::VACUUM.coulomb() * CHARGE / (NEXT * RADIUS).powi(2);
    let insulator = Boundary::Insulating { normal_field_v_m: 0.0 };
    let scene = held(&[height + DISPLACED], insulator, -hover);
    let edge = edge_over("wall image", &scene);
    assert!((edge - 1.0).abs() < AGREEMENT, "{edge}");
}

#[test]
fn gas_guard_is_the_edge_for_a_grain_that_is_slowed() {
    let mut scene = held(&[10.0], Boundary::Open, 0.0);
    scene.field = None;
    // It comes to rest within much less than the growth that is none.
    scene.particles.velocity[0].x = 1e-10;
    scene.gas = Some(
        Gas {
            drag: DragLaw::Stokes,
            density_kg_m3: 1.2,
            viscosity_pa_s: 1.8e-5,
            velocity_m_s: Vector3::zeros(),
            magnus_lift: false,
            flow: None,
        }
        .into(),
    );
    let edge = edge_over("gas response", &scene);
    assert!((edge - 1.0).abs() < AGREEMENT, "{edge}");
}

#[test]
fn rayleigh_guard_is_within_the_edge_for_a_grain_that_rocks_between_two() {
    // Pressed a hundredth of a radius into heavy ones on either side, without friction or damping.
    let mut scene = held(&[10.0 + DISPLACED, 10.0 - 1.99, 10.0 + 1.99], Boundary::Open, 0.0);
    scene.field = None;
    scene.time.allow_overlap = true;
    scene.materials[0].restitution = 1.0;
    let edge = edge_over("rayleigh", &scene);
    assert!(edge > 1.0, "{edge}");
}

#[test]
fn hertz_guard_is_within_the_edge_for_an_elastic_impact() {
    /// Gain of a rebound that is allowed with steps that are nearly too long.
    const GAIN: f64 = 0.05;
    const SPEED: f64 = 1.0;
    let mut scene = held(&[12.5, 10.0], Boundary::Open, 0.0);
    scene.field = None;
    scene.materials[0].restitution = 1.0;
    scene.particles.velocity[0].z = -SPEED;
    scene.time.step = Step::Seconds(1e-9);
    let guards = Simulation::new(scene.clone()).expect("a good scene").guards();
    let limit = guards.iter().find(|g| g.name == "hertz").expect("the guard is there").limit_s;
    for share in 1..=40 {
        let step = limit * f64::from(share) / 40.0;
        scene.time.step = Step::Seconds(step);
        let mut run = Simulation::new(scene.clone()).expect("a good scene");
        // There and back.
        let steps = (1.2 * RADIUS / SPEED / step) as u64;
        crate::common::run(&mut run, steps);
        let rebound = run.particles().velocity[0].z;
        assert!(rebound > 0.0 && rebound < (1.0 + GAIN) * SPEED, "{share}/40 of the guard: {rebound}");
    }
}
