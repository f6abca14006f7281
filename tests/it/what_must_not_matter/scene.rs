//! Grains, the frame that they are seen in, and their field over whatever cells.

use amberfield_core::{FieldSettings, Matrix3, Permittivity, Tuning, Vector3};
use amberfield_field::far::{FarField, FarMesh, FarRequest, FarValues};
use amberfield_field::{ElectricField, FieldError, FieldValues, Wanted};
use amberfield_tests::foam_case::Random;
use std::sync::{Arc, Mutex};

/// Charge of a grain [C].
pub(super) const CHARGE: f64 = 1e-12;

/// Charged grain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grain {
    /// Name by which the grain is known after a change.
    pub(super) name: usize,
    /// Place [m].
    pub(super) place: Vector3<f64>,
    /// Charge [C].
    pub(super) charge: f64,
}

/// Grain at a place [mm] with a charge in units of [`CHARGE`].
pub(super) fn grain(name: usize, place_mm: [f64; 3], charge: f64) -> Grain {
    Grain { name, place: 1e-3 * Vector3::from(place_mm), charge: charge * CHARGE }
}

/// Cloud of grains of both signs in a box with corners [mm], no two closer than a distance [mm].
pub(super) fn cloud(count: usize, low: [f64; 3], high: [f64; 3], apart: f64, seed: u64) -> Vec<Grain> {
    let mut random = Random(seed);
    let mut grains: Vec<Grain> = Vec::new();
    while grains.len() < count {
        let name = grains.len();
        let place = [0, 1, 2].map(|axis| low[axis] + (high[axis] - low[axis]) * random.number());
        let next = grain(name, place, if name.is_multiple_of(2) { 1.0 } else { -1.0 });
        if grains.iter().all(|other| (other.place - next.place).norm() > 1e-3 * apart) {
            grains.push(next);
        }
    }
    grains
}

/// Frame in which a scene is seen: x ↦ scale·turn·x + shift. Charges go with the square of the scale, with
/// the medium and the sign, potentials with the scale and the sign, so that E is turned, has the sign, and is
/// else the same.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) turn: Matrix3<f64>,
    /// Shift [m].
    pub(super) shift: Vector3<f64>,
    pub(super) scale: f64,
    /// Sign of all charges and potentials.
    pub(super) sign: f64,
    /// Relative permittivity.
    pub(super) medium: f64,
}

impl Frame {
    pub(super) fn identity() -> Self {
        Self { turn: Matrix3::identity(), shift: Vector3::zeros(), scale: 1.0, sign: 1.0, medium: 1.0 }
    }

    pub(super) fn shifted(shift: [f64; 3]) -> Self {
        Self { shift: shift.into(), ..Self::identity() }
    }

    pub(super) fn scaled(scale: f64) -> Self {
        Self { scale, ..Self::identity() }
    }

    /// Turned by an angle [rad] about an axis of some length.
    pub(super) fn turned(about: [f64; 3], angle: f64) -> Self {
        let axis = Vector3::from(about).normalize();
        let cross = axis.cross_matrix();
        let turn = Matrix3::identity() + angle.sin() * cross + (1.0 - angle.cos()) * cross * cross;
        Self { turn, ..Self::identity() }
    }

    /// Mirrored along x.
    pub(super) fn mirrored() -> Self {
        Self { turn: Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, 1.0)), ..Self::identity() }
    }

    /// Seen with the other sign of charge.
    pub(super) fn of_other_sign() -> Self {
        Self { sign: -1.0, ..Self::identity() }
    }

    /// Puts it into a medium of a relative permittivity.
    pub(super) fn in_medium(medium: f64) -> Self {
        Self { medium, ..Self::identity() }
    }

    pub(super) fn place(&self, place: &Vector3<f64>) -> Vector3<f64> {
        self.scale * (self.turn * place) + self.shift
    }
}

/// Scene apart from its cells.
#[derive(Clone, Debug)]
pub(super) struct Content {
    /// Grains of several scenes on the same cells: clouds, and grains that are alone.
    pub(super) sets: Vec<Vec<Grain>>,
    /// Frame of the cells and of the grains; the places of `sets` are those before it.
    pub(super) frame: Frame,
    /// Tolerance of the field.
    pub(super) tolerance: f64,
    /// Whether the field was computed for other grains before.
    pub(super) has_history: bool,
}

impl Content {
    pub(super) fn new(sets: Vec<Vec<Grain>>) -> Self {
        Self { sets, frame: Frame::identity(), tolerance: 1e-2, has_history: false }
    }
}

/// Scene with cells.
pub(super) trait Scene: Clone {
    fn content(&self) -> &Content;

    /// The solver on the cells in the frame of the scene.
    fn solver(&self) -> Solver;
}

/// Solver of several fields, one after the other.
#[derive(Clone, Debug)]
pub(super) struct Solver {
    mesh: FarMesh,
    solver: Arc<Mutex<Box<dyn FarField>>>,
}

impl Solver {
    pub(super) fn new(solver: Box<dyn FarField>) -> Self {
        Self { mesh: solver.mesh().clone(), solver: Arc::new(Mutex::new(solver)) }
    }
}

impl FarField for Solver {
    fn mesh(&self) -> &FarMesh {
        &self.mesh
    }

    fn solve(&mut self, request: &FarRequest<'_>, values: &mut FarValues) -> Result<(), FieldError> {
        self.solver.lock().unwrap().solve(request, values)
    }
}

/// Field at the grains of a set.
#[derive(Debug)]
pub(super) struct Field {
    /// E by grain, turned back into the frame of the base [V/m].
    pub(super) e: Vec<(usize, Vector3<f64>)>,
    /// Error that is stated, over `scale`.
    pub(super) stated: f64,
    /// RMS of E, or q_rms n^{2/3}/(4πε) if that is larger [V/m].
    pub(super) scale: f64,
}

/// Fields of all sets of a scene.
pub(super) fn fields(scene: &impl Scene) -> Vec<Field> {
    let (content, solver) = (scene.content(), scene.solver());
    content.sets.iter().map(|grains| field(&solver, content, grains)).collect()
}

fn field(solver: &Solver, content: &Content, grains: &[Grain]) -> Field {
    let Content { frame, tolerance, .. } = content;
    let positions: Vec<_> = grains.iter().map(|grain| frame.place(&grain.place)).collect();
    let factor = frame.scale * frame.scale * frame.sign * frame.medium;
    let charges: Vec<f64> = grains.iter().map(|grain| grain.charge * factor).collect();
    let permittivity = Permittivity::from_relative(frame.medium);
    let settings = FieldSettings {
        tolerance: *tolerance,
        tuning: Tuning::Model,
        permittivity,
        ..FieldSettings::default()
    };
    let mut field = ElectricField::over_mesh(Box::new(solver.clone()), &settings, &positions, &charges)
        .expect("a good scene");
    let mut values = FieldValues::default();
    if content.has_history {
        let others: Vec<_> = positions.iter().rev().copied().collect();
        let halved: Vec<f64> = charges.iter().map(|charge| -0.5 * charge).collect();
        field.evaluate(&others, &halved, Wanted::default(), &mut values).expect("finite values");
    }
    field.evaluate(&positions, &charges, Wanted::default(), &mut values).expect("finite values");
    let stated = field.error_measured().expect("grains are charged").relative_rms;

    let count = grains.len() as f64;
    let volume: f64 = solver.mesh.volumes().iter().sum();
    let charge = (charges.iter().map(|q| q * q).sum::<f64>() / count).sqrt();
    let spacing = permittivity.coulomb() * charge * (count / volume).powf(2.0 / 3.0);
    let square: f64 = values.e.iter().map(|e| e.norm_squared()).sum();
    let scale = (square / count).sqrt().max(spacing);
    let back = frame.sign * frame.turn.transpose();
    Field {
        e: grains.iter().zip(&values.e).map(|(grain, e)| (grain.name, back * e)).collect(),
        stated,
        scale,
    }
}
