//! Scenes, their fields in one process and over ranks, and what counts as round-off.

use amberfield_core::{Domain, FieldSettings, Tuning, Vector3};
use amberfield_field::{
    Choice, ElectricField, FieldError, FieldValues, P3mParameters, Ranks, ThreadRank, Wanted,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;

/// Shapes of cloud and window for a cut-off of three node spacings, by order from 4.
const SHAPES: [[f64; 2]; 5] = [[7.16, 6.88], [8.39, 8.23], [9.00, 9.13], [9.57, 9.51], [9.68, 10.97]];
/// Round-off may be this many times what one process shows when its input changes by round-off.
const TIMES: f64 = 100.0;

/// Charges in a box.
#[derive(Clone, Debug)]
pub(crate) struct Scene {
    pub(crate) domain: Domain,
    pub(crate) settings: FieldSettings,
    pub(crate) positions: Vec<Vector3<f64>>,
    pub(crate) charges: Vec<f64>,
}

impl Scene {
    /// Charges that add up to zero, at random places.
    pub(crate) fn neutral(domain: Domain, count: usize, seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let positions = (0..count)
            .map(|_| domain.min() + domain.extent().map(|length| length * random.random_range(0.01..0.99)))
            .collect();
        let sign = |i: usize| if i.is_multiple_of(2) { 1e-13 } else { -1e-13 };
        let charges = (0..count).map(sign).collect();
        let external_field_v_m = Vector3::new(10.0, -20.0, 5.0);
        let settings =
            FieldSettings { tuning: Tuning::Model, external_field_v_m, ..FieldSettings::default() };
        Self { domain, settings, positions, charges }
    }

    /// The grains with these numbers.
    fn part(&self, numbers: &[usize]) -> (Vec<Vector3<f64>>, Vec<f64>) {
        numbers.iter().map(|&i| (self.positions[i], self.charges[i])).unzip()
    }
}

/// Field and potential at the grains.
#[derive(Debug)]
pub(crate) struct Field {
    pub(crate) e: Vec<Vector3<f64>>,
    pub(crate) potential: Vec<f64>,
}

impl Field {
    /// Largest difference of E, and of potentials over the same length, to another field; and the largest E.
    pub(crate) fn difference(&self, other: &Self) -> (f64, f64) {
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let of_e = largest(&mut self.e.iter().zip(&other.e).map(|(a, b)| (a - b).norm()));
        let e = largest(&mut self.e.iter().map(|e| e.norm()));
        let pairs = self.potential.iter().zip(&other.potential);
        let of_potential = largest(&mut pairs.map(|(a, b)| (a - b).abs()));
        let potential = largest(&mut self.potential.iter().map(|value| value.abs()));
        let as_e = if potential > 0.0 { of_potential / potential * e } else { of_potential };
        (of_e.max(as_e), e)
    }
}

/// Parameters with a window of the given order, in double precision.
pub(crate) fn parameters(order: usize, cutoff_m: f64) -> Choice {
    let [cloud_shape, window_shape] = SHAPES[order - 4];
    Choice::P3m(P3mParameters {
        cutoff_m,
        cloud_shape,
        spacing_m: cutoff_m / 3.0,
        order,
        window_shape,
        kernel_accuracy: 1e-12,
        far: None,
    })
}

const WANTED: Wanted = Wanted { potential: true, components: false };

/// The field in one process.
pub(crate) fn field_of_one(scene: &Scene, choice: &Choice) -> Field {
    let mut field = ElectricField::with_choice(&scene.domain, &scene.settings, choice).unwrap();
    let mut values = FieldValues::default();
    field.evaluate(&scene.positions, &scene.charges, WANTED, &mut values).unwrap();
    Field { e: values.e, potential: values.potential }
}

/// Numbers of the grains of each rank, that lie side by side along the box's longest edge.
pub(crate) fn spread_out(scene: &Scene, ranks: usize) -> Vec<Vec<usize>> {
    let mut numbers: Vec<usize> = (0..scene.positions.len()).collect();
    let axis = scene.domain.extent().imax();
    numbers.sort_by(|&a, &b| scene.positions[a][axis].total_cmp(&scene.positions[b][axis]));
    let part =
        |rank: usize| numbers[numbers.len() * rank / ranks..numbers.len() * (rank + 1) / ranks].to_vec();
    (0..ranks).map(part).collect()
}

/// The field over ranks, in the order of the scene.
pub(crate) fn field_over(scene: &Scene, parts: &[Vec<usize>], choice: &Choice) -> Field {
    let fields = run(scene, parts, choice, |_, values| values.clone());
    let mut field = Field {
        e: vec![Vector3::zeros(); scene.positions.len()],
        potential: vec![0.0; scene.positions.len()],
    };
    for (numbers, values) in parts.iter().zip(fields) {
        assert_eq!(values.e.len(), numbers.len());
        for (place, &number) in numbers.iter().enumerate() {
            field.e[number] = values.e[place];
            field.potential[number] = values.potential[place];
        }
    }
    field
}

/// Evaluates the field twice over ranks with parts of the scene, and returns what `look` finds on each.
pub(crate) fn run<T: Send>(
    scene: &Scene,
    parts: &[Vec<usize>],
    choice: &Choice,
    look: impl Fn(&ElectricField, &FieldValues) -> T + Sync,
) -> Vec<T> {
    let outcomes: Vec<Result<T, FieldError>> = on_ranks(parts.len(), |ranks| {
        let (positions, charges) = scene.part(&parts[ranks.rank()]);
        let mut field = ElectricField::over_ranks_with_choice(ranks, &scene.domain, &scene.settings, choice)?;
        let mut values = FieldValues::default();
        field.evaluate(&positions, &charges, WANTED, &mut values)?;
        let first = values.clone();
        field.evaluate(&positions, &charges, WANTED, &mut values)?;
        assert_eq!(first, values, "an evaluation leaves nothing behind");
        Ok(look(&field, &values))
    });
    outcomes.into_iter().collect::<Result<_, _>>().unwrap()
}

/// Chooses parameters over ranks, evaluates, and returns what `look` finds on each.
pub(crate) fn choose_and_run<T: Send>(
    scene: &Scene,
    parts: &[Vec<usize>],
    look: impl Fn(&mut ElectricField, &[Vector3<f64>], &[f64], &FieldValues) -> T + Sync,
) -> Vec<Result<T, FieldError>> {
    on_ranks(parts.len(), |ranks| {
        let (positions, charges) = scene.part(&parts[ranks.rank()]);
        let mut field =
            ElectricField::over_ranks(ranks, &scene.domain, &scene.settings, &positions, &charges)?;
        let mut values = FieldValues::default();
        field.evaluate(&positions, &charges, WANTED, &mut values)?;
        Ok(look(&mut field, &positions, &charges, &values))
    })
}

/// Does the same work on so many ranks at a time, each a thread.
pub(crate) fn on_ranks<T: Send>(count: usize, work: impl Fn(Arc<dyn Ranks>) -> T + Sync) -> Vec<T> {
    let work = &work;
    std::thread::scope(|scope| {
        let threads: Vec<_> = ThreadRank::all(count)
            .into_iter()
            .map(|rank| scope.spawn(move || work(Arc::new(rank) as Arc<dyn Ranks>)))
            .collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    })
}

/// Change that another order of adding may make: what one process shows when charges and places change in
/// their last digit, times [`TIMES`]. Windows of high order divide by what is small, so that they show more.
pub(crate) fn round_off(scene: &Scene, choice: &Choice, one: &Field) -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut changed = scene.clone();
    for charge in &mut changed.charges {
        *charge *= 1.0 + f64::EPSILON * random.random_range(-1.0..1.0_f64).signum();
    }
    for position in &mut changed.positions {
        for axis in 0..3 {
            // As many metres as the last digit of a coordinate has, when it is moved by a period.
            let ends = [position[axis], scene.domain.min()[axis], scene.domain.max()[axis]];
            let digit = f64::EPSILON * ends.into_iter().fold(0.0, |most: f64, end| most.max(end.abs()));
            position[axis] += digit * random.random_range(-1.0..1.0_f64).signum();
        }
    }
    changed.settings.neutralising_background = true;
    TIMES * one.difference(&field_of_one(&changed, choice)).0
}
