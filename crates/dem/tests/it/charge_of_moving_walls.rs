//! Charge that insulating walls keep goes along with them.

use crate::charging::{CUTOFF, RADIUS, solid, transfer};
use crate::common::{lattice, mesh_floor, run, setup};
use amberfield_core::{
    Boundary, ChargeTransfer, CouplingInterval, Domain, Material, MotionKind, Vector3, Wall, WallCharging,
    WallMotion,
};
use amberfield_dem::{Setup, Simulation};

/// Grains that bounce on an insulating sheet which moves, with a velocity [m/s] added to theirs.
fn on_a_sheet(motion: Vec<MotionKind>, added: Vector3<f64>) -> Setup {
    let mut grains = lattice([0.0; 3], [8e-3, 8e-3, 4.4e-3], 2.2e-3, 0.3, 11);
    let scale = RADIUS / 1e-3;
    for (n, grain) in grains.iter_mut().enumerate() {
        grain.position = (grain.position - Vector3::new(4e-3, 4e-3, -0.5e-3)) * scale;
        grain.radius *= scale;
        grain.charge = 1e-14 * (n as f64 % 5.0 - 2.0);
        grain.velocity = grain.velocity * scale - Vector3::z() * 0.1 + added;
    }
    let mut sheet = Wall { charging: WallCharging::Insulating, ..mesh_floor(3e-3, 6) };
    sheet.material = amberfield_core::MaterialId(1);
    let legs = motion.into_iter().map(|kind| WallMotion { start_s: 0.0, end_s: f64::INFINITY, kind });
    sheet.motion = legs.collect();
    let mut scene = setup(grains, solid(1e6, 0.9), 2e-7);
    scene.materials.push(Material { work_function_ev: Some(4.0), ..solid(1e6, 0.9) });
    scene.walls = vec![sheet];
    scene.time.gravity_m_s2.z = -9.81;
    let mut scene = transfer(scene, ChargeTransfer::new(CUTOFF));
    // Evaluations at the same times in every frame.
    if let Some(field) = &mut scene.field {
        field.settings.coupling_interval = CouplingInterval::Steps(10);
    }
    scene
}

fn spots(simulation: &Simulation) -> Vec<(Vector3<f64>, f64)> {
    simulation.charged_spots().map(|(spot, _)| (spot.place, spot.charge)).collect()
}

#[test]
fn charge_goes_along_with_a_wall_that_moves() {
    let after = |motion: Vec<MotionKind>, added: Vector3<f64>| {
        let mut simulation = Simulation::new(on_a_sheet(motion, added)).expect("a good scene");
        run(&mut simulation, 20_000);
        simulation
    };
    let rest = after(Vec::new(), Vector3::zeros());
    let kept = spots(&rest);
    assert!(kept.len() > 8 && kept.iter().any(|(_, charge)| charge.abs() > 1e-16));

    // A velocity of zero is no motion, bit for bit.
    let still = after(vec![MotionKind::Translate(Vector3::zeros())], Vector3::zeros());
    assert_eq!((still.particles(), spots(&still)), (rest.particles(), kept.clone()));

    // Grains and sheet in a frame that moves at constant speed.
    let velocity = Vector3::new(0.2, -0.1, 0.0);
    let moved = after(vec![MotionKind::Translate(velocity)], velocity);
    let shift = velocity * moved.time_s();
    let largest = rest.particles().charge.iter().fold(0.0, |most: f64, charge| most.max(charge.abs()));
    for (one, other) in rest.particles().charge.iter().zip(&moved.particles().charge) {
        assert!((one - other).abs() < 1e-7 * largest, "{one:e} {other:e}");
    }
    for ((place, charge), (found, other)) in kept.iter().zip(spots(&moved)) {
        assert!((found - place - shift).norm() < 1e-6 * RADIUS && (charge - other).abs() < 1e-7 * largest);
    }
}

#[test]
fn charge_is_back_after_a_whole_turn_of_its_wall() {
    let turns_per_s = 1000.0;
    let spin = MotionKind::Rotate { origin: Vector3::zeros(), axis: Vector3::z(), turns_per_s };
    let mut scene = on_a_sheet(vec![spin], Vector3::zeros());
    // It turns when the grains have left, which fly on for ever.
    scene.time.gravity_m_s2.z = 0.0;
    scene.walls[0].motion[0].start_s = 8e-3;
    let mut simulation = Simulation::new(scene).expect("a good scene");
    run(&mut simulation, 40_000);
    let before = spots(&simulation);
    run(&mut simulation, 2_500);
    assert!(before.len() > 4, "{}", before.len());
    for ((place, charge), (half, same)) in before.iter().zip(spots(&simulation)) {
        let opposite = Vector3::new(-place.x, -place.y, place.z);
        assert!((half - opposite).norm() < 1e-9 * RADIUS && *charge == same, "{place} {half}");
    }
    let state = simulation.checkpoint().expect("no solver");
    run(&mut simulation, 2_500);
    for ((place, _), (whole, _)) in before.iter().zip(spots(&simulation)) {
        assert!((whole - place).norm() < 1e-9 * RADIUS, "{place} {whole}");
    }
    let mut scene = on_a_sheet(
        vec![MotionKind::Rotate { origin: Vector3::zeros(), axis: Vector3::z(), turns_per_s }],
        Vector3::zeros(),
    );
    scene.time.gravity_m_s2.z = 0.0;
    scene.walls[0].motion[0].start_s = 8e-3;
    let mut resumed = Simulation::resume(scene, state).expect("the same scene");
    run(&mut resumed, 2_500);
    assert_eq!(resumed.state(), simulation.state());
}

#[test]
fn charge_that_turns_across_a_periodic_axis_is_refused() {
    let spin = MotionKind::Rotate { origin: Vector3::zeros(), axis: Vector3::z(), turns_per_s: 1.0 };
    let boxed = |periodic: usize| {
        let mut scene = on_a_sheet(vec![spin.clone()], Vector3::zeros());
        let mut faces = [[Boundary::Open; 2]; 3];
        faces[periodic] = [Boundary::Periodic; 2];
        scene.domain = Domain::new(scene.domain.min(), scene.domain.max(), faces).expect("a good box");
        Simulation::new(scene).map(|_| ())
    };
    assert!(boxed(2).is_ok());
    let message = boxed(0).expect_err("its copies turn elsewhere").to_string();
    assert!(message.contains("across a periodic axis"), "{message}");
}
