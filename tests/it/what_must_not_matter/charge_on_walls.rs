//! Changes of insulating and grounded walls that physics does not see, after which grains have the same
//! charge.

use super::walls::common::{RADIUS, grain, material, run, setup, wall};
use super::walls::{FLOORS, HALF, Line, sheet};
use amberfield_core::{
    Boundary, ChargeTransfer, Domain, FieldSettings, Material, Method, Vector3, Wall, WallCharging, WallShape,
};
use amberfield_dem::{FieldStageSetup, Setup, Simulation};

/// Difference of charges over the largest that other roundings of places make.
const ROUND_OFF: f64 = 1e-6;

/// Grains of two sizes that bounce on an insulating floor: two on one spot, one beside it, one that rolls.
/// After some bounces the floor's charge weighs as much as the grains' own.
fn scene(walls: Vec<Wall>) -> Setup {
    let stuff = Material { young_pa: 2e4, work_function_ev: Some(4.2), ..material(0.95, 0.2, 0.01) };
    let mut grains = vec![
        grain(1, [0.0, 0.0, 1.02 * RADIUS], [0.0, 0.0, -0.1]),
        grain(2, [1e-5, 2e-5, 3.3 * RADIUS], [0.0, 0.0, -0.1]),
        grain(3, [-2.3 * RADIUS, 0.4 * RADIUS, 1.02 * RADIUS], [0.05, 0.0, -0.1]),
        grain(4, [1.6 * RADIUS, 0.0, 0.42 * RADIUS], [-0.01, 0.0, -0.1]),
    ];
    grains[3].radius = 0.4 * RADIUS;
    let mut scene = setup(grains, stuff, 1e-5);
    scene.materials.push(Material { work_function_ev: Some(4.9), ..scene.materials[0].clone() });
    scene.walls = walls;
    for wall in &mut scene.walls {
        wall.material = amberfield_core::MaterialId(1);
        wall.charging = WallCharging::Insulating;
    }
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
    scene.time.allow_unstable = true;
    let settings = FieldSettings { method: Method::Direct, ..FieldSettings::default() };
    let field = FieldStageSetup::new(settings, vec![true; 4]);
    scene.field = Some(FieldStageSetup { transfer: Some(ChargeTransfer::new(5e-7)), ..field });
    scene
}

/// Charges of the grains, then that of the walls together [C].
fn charges(scene: Setup, steps: u64) -> Vec<f64> {
    let mut simulation = Simulation::new(scene).expect("a good scene");
    run(&mut simulation, steps);
    let held: f64 = simulation.charged_spots().map(|(spot, _)| spot.charge).sum();
    let particles = simulation.particles();
    let of =
        |id: u64| particles.charge[particles.id.iter().position(|known| *known == id).expect("it stays")];
    (1..=4).map(of).chain([held]).collect()
}

fn assert_same(name: &str, known: &[f64], found: &[f64], bound: f64) {
    let largest = known.iter().fold(0.0_f64, |largest, charge| largest.max(charge.abs()));
    let apart = known.iter().zip(found).map(|(a, b)| (a - b).abs() / largest).fold(0.0, f64::max);
    assert!(apart <= bound, "{name}: {apart:e}, {found:?} for {known:?}");
}

/// Floor at z = 0 with an underside, a hundredth of a radius below.
fn thin_body() -> Vec<Wall> {
    let WallShape::Mesh(mut under) = sheet(HALF, HALF, [7, 5]).shape else { unreachable!("a mesh") };
    under.vertices.iter_mut().for_each(|x| x.z = -0.01 * RADIUS);
    under.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    vec![sheet(HALF, HALF, [3, 3]), wall(WallShape::Mesh(under))]
}

#[test]
fn how_an_insulating_floor_is_made_does_not_matter() {
    let floors = || FLOORS.iter().chain(&[Line { name: "a thin body", walls: thin_body }]);
    let known = charges(scene(vec![super::walls::plane()]), 6000);
    assert!(known.iter().all(|charge| charge.abs() > 1e-13), "{known:?}");
    for Line { name, walls } in floors() {
        assert_same(name, &known, &charges(scene(walls()), 6000), ROUND_OFF);
    }
}

#[test]
fn frame_and_steps_do_not_matter_to_kept_charge() {
    let known = charges(scene(vec![super::walls::plane()]), 3000);
    let mut elsewhere = scene(vec![super::walls::plane()]);
    let shift = Vector3::new(0.31, -0.12, 0.0);
    elsewhere.particles.position.iter_mut().for_each(|x| *x += shift);
    assert_same("elsewhere", &known, &charges(elsewhere, 3000), ROUND_OFF);
    let mut turned = scene(vec![super::walls::plane()]);
    let quarter = |x: &mut Vector3<f64>| *x = Vector3::new(-x.y, x.x, x.z);
    turned.particles.position.iter_mut().for_each(quarter);
    turned.particles.velocity.iter_mut().for_each(quarter);
    assert_same("turned", &known, &charges(turned, 3000), ROUND_OFF);
    let mut finer = scene(vec![super::walls::plane()]);
    finer.time.step = amberfield_core::Step::Seconds(2.5e-6);
    assert_same("finer steps", &known, &charges(finer, 12_000), 1e-2);
    // A period through the spots that grains charge.
    let mut periodic = scene(vec![super::walls::plane()]);
    let faces = [[Boundary::Periodic; 2], [Boundary::Open; 2], [Boundary::Open; 2]];
    let mut across = |low: f64| {
        periodic.domain =
            Domain::new(Vector3::new(low, -0.05, -0.05), Vector3::new(low + 0.1, 0.05, 0.05), faces)
                .expect("a good box");
        for x in &mut periodic.particles.position {
            *x = periodic.domain.wrap(*x);
        }
        charges(periodic.clone(), 3000)
    };
    let whole = across(-0.05);
    // Sums over periods are split in another way.
    assert_same("a period through the spots", &whole, &across(1e-4), 1e-5);
}

/// One bounce on a grounded floor in a field along its normal.
fn in_field(domain: [[Boundary; 2]; 2], external: f64, floor: Wall) -> f64 {
    let mut scene = scene(vec![floor]);
    let faces = [[Boundary::Periodic; 2], domain[0], domain[1]];
    scene.domain = Domain::new(Vector3::new(-0.01, -0.01, 0.0), Vector3::new(0.01, 0.01, 0.02), faces)
        .expect("a good box");
    scene.particles = [grain(1, [0.0, 0.0, 1.02 * RADIUS], [0.0, 0.0, -0.1])].into_iter().collect();
    scene.walls[0].charging = WallCharging::Grounded;
    scene.walls[0].material = amberfield_core::MaterialId(0);
    let field = scene.field.as_mut().expect("it has one");
    field.member.truncate(1);
    field.settings.external_field_v_m = Vector3::new(0.0, 0.0, external);
    let mut simulation = Simulation::new(scene).expect("a good scene");
    run(&mut simulation, 700);
    simulation.particles().charge[0]
}

#[test]
fn who_gives_a_field_at_a_grounded_floor_does_not_matter() {
    let raised = |height: f64| {
        let WallShape::Mesh(mut mesh) = sheet([-0.01, 0.01], [-0.01, 0.01], [3, 4]).shape else {
            unreachable!("a mesh")
        };
        mesh.vertices.iter_mut().for_each(|x| x.z = height);
        wall(WallShape::Mesh(mesh))
    };
    let (periodic, open) = ([Boundary::Periodic; 2], [Boundary::Open; 2]);
    // 1 MV/m upwards, by electrodes or from outside.
    let plates = [Boundary::Grounded, Boundary::Potential(-2e4)];
    let known = in_field([periodic, plates], 0.0, super::walls::plane());
    assert!(known > 1e-15, "{known:e}");
    for (name, faces, external, floor) in [
        ("a plane and electrodes with open sides", [open, plates], 0.0, super::walls::plane()),
        ("a sheet on the face", [periodic, plates], 0.0, raised(0.0)),
        ("a sheet a little off the face", [periodic, plates], 0.0, raised(1e-9)),
        ("a plane and a field from outside", [periodic, open], 1e6, super::walls::plane()),
        ("a sheet and a field from outside", [open, open], 1e6, raised(0.0)),
    ] {
        let found = in_field(faces, external, floor);
        assert!((found / known - 1.0).abs() < 2e-3, "{name}: {found:e} for {known:e}");
    }
}
