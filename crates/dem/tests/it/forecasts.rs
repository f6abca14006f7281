//! Stated error of the electric forces between evaluations of the field, beside the true one: the field of
//! the present places and charges, evaluated by another field in every step.

use crate::common::{RADIUS, floor, grain, lattice, material, setup};
use amberfield_core::{
    Boundary, ChargeTransfer, CouplingInterval, Domain, FieldSettings, Grain, Material, MaterialId, Method,
    Vector3, Wall, WallCharging,
};
use amberfield_dem::{FieldStageSetup, Setup, Simulation};
use amberfield_field::{ElectricField, FieldValues, Wanted};

const TOLERANCE: f64 = 1e-2;
/// Ratio of the stated error to the true one that is allowed, either way.
const OF_TRUTH: f64 = 2.0;
/// True error over the tolerance below which any stated error as small does.
const NOTHING: f64 = 1e-2;

/// Scene of the set.
struct Scene {
    name: &'static str,
    setup: Setup,
    steps: u64,
}

fn settings() -> FieldSettings {
    FieldSettings { method: Method::Direct, tolerance: TOLERANCE, ..FieldSettings::default() }
}

/// Scene of grains in a field, in a box of a half width [m].
fn scene(
    name: &'static str,
    grains: Vec<Grain>,
    half: f64,
    faces: [[Boundary; 2]; 3],
    gravity: [f64; 3],
    steps: u64,
) -> Scene {
    let count = grains.len();
    let mut setup = setup(grains, works(material(0.8, 0.3, 0.0), 4.0), 2e-5);
    let low = Vector3::new(-half, -half, 0.0);
    setup.domain = Domain::new(low, Vector3::new(half, half, 2.0 * half), faces).expect("a good box");
    setup.time.gravity_m_s2 = gravity.into();
    setup.field = Some(FieldStageSetup::new(settings(), vec![true; count]));
    setup.time.allow_overlap = true;
    Scene { name, setup, steps }
}

fn works(material: Material, work_function_ev: f64) -> Material {
    Material { work_function_ev: Some(work_function_ev), ..material }
}

const OPEN: [[Boundary; 2]; 3] = [[Boundary::Open; 2]; 3];

impl Scene {
    fn with_floor(mut self, charging: WallCharging) -> Self {
        self.setup.materials.push(works(material(0.8, 0.3, 0.0), 5.0));
        self.setup.walls = vec![Wall { charging, material: MaterialId(1), ..floor() }];
        self
    }

    fn with_charging(mut self) -> Self {
        let field = self.setup.field.as_mut().expect("a field");
        field.transfer = Some(ChargeTransfer::new(5e-7));
        self
    }

    /// Stated and true RMS relative errors of the electric forces, and the evaluations of the field.
    fn errors(self) -> (f64, f64, u64) {
        let domain = self.setup.domain.clone();
        let mut run = Simulation::new(self.setup).expect("a good scene");
        let mut squares = 0.0;
        for _ in 0..self.steps {
            run.step().expect("a good step");
            squares += square(&domain, &run);
        }
        let intervals = run.intervals().expect("a field");
        (intervals.error(), (squares / self.steps as f64).sqrt(), intervals.evaluations)
    }
}

/// Squared relative error of the forces in the last step.
fn square(domain: &Domain, run: &Simulation) -> f64 {
    let particles = run.particles();
    let positions: Vec<_> = particles.position.iter().map(|x| domain.wrap(*x)).collect();
    let mut field = ElectricField::new(domain, &settings(), &positions, &particles.charge);
    let Ok(field) = &mut field else { return 0.0 };
    let mut values = FieldValues::default();
    let wanted = Wanted { potential: false, components: false };
    field.evaluate(&positions, &particles.charge, wanted, &mut values).expect("a good scene");
    let used = run.electric_forces().expect("a field");
    let (mut error, mut size) = (0.0, 0.0);
    for ((used, e), q) in used.iter().zip(&values.e).zip(&particles.charge) {
        error += (used - e * *q).norm_squared();
        size += (e * *q).norm_squared();
    }
    if error > 0.0 { error / size } else { 0.0 }
}

fn charged(mut grains: Vec<Grain>, charge: impl Fn(usize) -> f64) -> Vec<Grain> {
    grains.iter_mut().enumerate().for_each(|(n, grain)| grain.charge = charge(n));
    grains
}

fn scenes() -> Vec<Scene> {
    let bed = |speed: f64| lattice([-0.009, -0.009, 0.0005], [0.009, 0.009, 0.0095], 2.9 * RADIUS, speed, 7);
    let sign = |n: usize| if n.is_multiple_of(2) { 2e-12 } else { -2e-12 };
    let falling = |grains: Vec<Grain>, velocity: [f64; 3]| -> Vec<Grain> {
        grains.into_iter().map(|grain| Grain { velocity: velocity.into(), ..grain }).collect()
    };
    let down = [0.0, 0.0, -9.81];
    let slope = [5.0, 0.0, -8.4];
    let grounded = [[Boundary::Open; 2], [Boundary::Open; 2], [Boundary::Grounded, Boundary::Open]];
    let two = |charges: [f64; 2]| {
        let mut grains = vec![
            grain(1, [-0.02, 0.0, 0.02], [2.0, 0.0, 0.0]),
            grain(2, [0.02, 3e-3, 0.02], [-2.0, 0.0, 0.0]),
        ];
        grains.iter_mut().zip(charges).for_each(|(grain, charge)| grain.charge = charge);
        grains
    };
    let mut gas = scene("charging gas", bed(1.0), 0.0095, [[Boundary::Periodic; 2]; 3], [0.0; 3], 1500);
    gas.setup.materials.push(works(material(0.9, 0.0, 0.0), 5.0));
    for n in 0..gas.setup.particles.len() {
        gas.setup.particles.material[n] = MaterialId((n % 2) as u16);
    }
    let lone = charged(vec![grain(1, [0.0, 0.0, 0.012], [0.0, 0.0, -0.5])], |_| 1e-10);
    vec![
        scene("settling", charged(bed(0.1), sign), 0.1, OPEN, down, 2500).with_floor(WallCharging::None),
        scene("charging on a wall", falling(bed(0.0), [0.0, 0.0, -0.5]), 0.1, OPEN, down, 1500)
            .with_floor(WallCharging::Grounded)
            .with_charging(),
        gas.with_charging(),
        scene("chute", falling(bed(0.0), [0.3, 0.0, -0.3]), 0.1, OPEN, slope, 2000)
            .with_floor(WallCharging::Grounded)
            .with_charging(),
        scene("landing", charged(falling(bed(0.0), [0.1, 0.05, -0.5]), sign), 0.1, grounded, down, 400)
            .with_floor(WallCharging::None),
        scene("first charges", falling(bed(0.0), [0.0, 0.0, -0.5]), 0.1, grounded, down, 150)
            .with_floor(WallCharging::Grounded)
            .with_charging(),
        scene("fast passage", two([1e-11, 1e-11]), 0.05, OPEN, [0.0; 3], 1000),
        scene("lone grain", lone, 0.05, grounded, down, 1500).with_floor(WallCharging::None),
    ]
}

#[test]
fn stated_error_of_the_forces_is_the_true_one() {
    let mut seen = Vec::new();
    for scene in scenes() {
        let name = scene.name;
        let (stated, truth, evaluations) = scene.errors();
        println!("{name}: stated {stated:.2e}, true {truth:.2e}, {evaluations} evaluations");
        let small = stated.max(truth) < NOTHING * TOLERANCE;
        let close = stated <= OF_TRUTH * truth && truth <= OF_TRUTH * stated;
        if !(small || close) || stated.max(truth) > TOLERANCE {
            seen.push(format!("{name}: stated {stated:.2e}, true {truth:.2e}"));
        }
    }
    assert!(seen.is_empty(), "{}", seen.join("\n"));
}

#[test]
fn field_that_is_evaluated_in_every_step_is_not_forecast() {
    for mut scene in scenes() {
        scene.steps = 300;
        scene.setup.field.as_mut().expect("a field").settings.coupling_interval = CouplingInterval::Steps(1);
        let (stated, truth, _) = scene.errors();
        // Sums in another order.
        assert!(stated == 0.0 && truth < 1e-9, "{}: {stated:e} {truth:e}", "interval 1");
    }
}
