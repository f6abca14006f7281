//! Cost of an evaluation that ranks share: seconds, memory and what is sent, by the number of ranks.
//!
//! `cargo run --release -p amberfield-field --example over_ranks -- [grains] [tolerance] [most ranks]`
//!
//! Ranks are threads with one core each. Where there are fewer cores than ranks the wall time says nothing;
//! the processor time of the slowest rank is what a machine with enough of them would take, without waiting.
//!
//! The last lines are a model of the same: what a rank of a cube of bricks sends, and what a thousand ranks
//! with 10⁹ grains would take. docs/host-codes.md says what it assumes.
#![expect(clippy::print_stdout, reason = "prints its table")]

use amberfield_core::{Boundary, Domain, FieldSettings, Tuning, Vector3};
use amberfield_field::{Choice, ElectricField, FieldError, FieldValues, Parcels, Ranks, ThreadRank, Wanted};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

const EVALUATIONS: usize = 10;
/// Edge of the cube [m].
const EDGE: f64 = 1e-2;

/// Counts what a rank sends to others.
#[derive(Debug)]
struct Counted {
    ranks: ThreadRank,
    numbers: AtomicUsize,
    messages: AtomicUsize,
}

impl Counted {
    fn count_parcels(&self, sizes: impl Iterator<Item = usize>) {
        for (_, size) in sizes.enumerate().filter(|(rank, size)| *rank != self.rank() && *size > 0) {
            self.numbers.fetch_add(size, Ordering::Relaxed);
            self.messages.fetch_add(1, Ordering::Relaxed);
        }
    }
}

impl Ranks for Counted {
    fn rank(&self) -> usize {
        self.ranks.rank()
    }

    fn count(&self) -> usize {
        self.ranks.count()
    }

    fn exchange(&self, sent: &Parcels, received: &mut Parcels) -> Result<(), FieldError> {
        self.count_parcels(sent.sizes());
        self.ranks.exchange(sent, received)
    }

    fn sum(&self, values: &mut [f64]) -> Result<(), FieldError> {
        self.ranks.sum(values)
    }
}

/// Cost of one rank for an evaluation.
#[derive(Clone, Copy)]
struct Cost {
    wall_ms: f64,
    processor_ms: f64,
    memory_mb: f64,
    sent_mb: f64,
    messages: f64,
    /// Part of the time that the grid takes.
    of_grid: f64,
}

/// A cube of grains, cut into bricks, one for each rank.
#[derive(Clone, Copy)]
struct Model {
    grains: f64,
    ranks: f64,
    /// Nodes along an edge.
    nodes: f64,
    /// Cut-off radius over the edge.
    cutoff: f64,
    order: f64,
}

impl Model {
    /// A cube of the same density with other grains and ranks.
    fn with(self, grains: f64, ranks: f64) -> Self {
        let longer = (grains / self.grains).cbrt();
        Self { grains, ranks, nodes: self.nodes * longer, cutoff: self.cutoff / longer, ..self }
    }

    /// Numbers that a rank sends [MB]: grains near a brick's faces; its nodes to the planes and back; its
    /// share of the grid to the lines and back.
    fn sent_mb(self) -> f64 {
        if self.ranks == 1.0 {
            return 0.0;
        }
        let edge = self.ranks.cbrt().recip();
        let near = ((1.0 + 2.0 * self.cutoff / edge).powi(3) - 1.0) * self.grains / self.ranks;
        let brick = (self.nodes * edge + self.order - 1.0).powi(3);
        let share = self.nodes.powi(3) / self.ranks;
        8e-6 * (4.0 * near + 2.0 * (brick + share) * (1.0 - 1.0 / self.ranks))
    }

    /// Messages that a rank sends: to all ranks about boxes, sizes, and lines there and back; to its
    /// neighbours with grains; to the ranks that have its planes.
    fn messages(self) -> f64 {
        let others = self.ranks - 1.0;
        4.0 * others + others.min(26.0) + 2.0 * others.min(self.ranks.powf(2.0 / 3.0))
    }

    /// Time of a rank for its own work, from that of one rank with fewer grains.
    fn computing_ms(self, known: Self, cost: Cost) -> f64 {
        let growth = self.nodes.ln() / known.nodes.ln();
        let each = cost.processor_ms / known.grains * (1.0 - cost.of_grid + cost.of_grid * growth);
        each * self.grains / self.ranks
    }
}

/// Time that this thread has had a processor [s].
fn processor_seconds() -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    told.split_whitespace().next().and_then(|word| word.parse().ok()).unwrap_or(f64::NAN) * 1e-9
}

/// Grains: places and charges.
type Grains = (Vec<Vector3<f64>>, Vec<f64>);

/// A field, with its parameters.
struct Scene {
    domain: Domain,
    settings: FieldSettings,
    choice: Choice,
}

/// Evaluates on one rank, in one thread.
fn cost(scene: &Scene, ranks: ThreadRank, (positions, charges): &Grains) -> Result<Cost, FieldError> {
    let Scene { domain, settings, choice } = scene;
    let counted = Arc::new(Counted { ranks, numbers: 0.into(), messages: 0.into() });
    let ranks = Arc::clone(&counted) as Arc<dyn Ranks>;
    let mut field = ElectricField::over_ranks_with_choice(ranks, domain, settings, choice)?;
    let mut values = FieldValues::default();
    field.evaluate(positions, charges, Wanted::default(), &mut values)?;
    let sent = [&counted.numbers, &counted.messages].map(|count| count.swap(0, Ordering::Relaxed));
    let (start, busy) = (Instant::now(), processor_seconds());
    for _ in 0..EVALUATIONS {
        field.evaluate(positions, charges, Wanted::default(), &mut values)?;
    }
    let each = 1e3 / EVALUATIONS as f64;
    let stages = field.statistics().seconds;
    let all: f64 = stages.iter().map(|(_, seconds)| seconds).sum();
    let grid: f64 = stages.iter().filter(|(name, _)| *name == "grid").map(|(_, seconds)| seconds).sum();
    Ok(Cost {
        wall_ms: start.elapsed().as_secs_f64() * each,
        processor_ms: (processor_seconds() - busy) * each,
        memory_mb: field.memory_bytes() as f64 * 1e-6,
        sent_mb: 8e-6 * sent[0] as f64,
        messages: sent[1] as f64,
        of_grid: grid / all,
    })
}

/// Bricks of grains with the same number each: halves along the three axes in turn.
fn bricks((positions, charges): &Grains, ranks: usize) -> Vec<Grains> {
    let mut parts = vec![(0..positions.len()).collect::<Vec<_>>()];
    for axis in (0..3).cycle().take(usize::ilog2(ranks) as usize) {
        let halves = parts.into_iter().flat_map(|mut part| {
            part.sort_by(|&a, &b| positions[a][axis].total_cmp(&positions[b][axis]));
            let rest = part.split_off(part.len() / 2);
            [part, rest]
        });
        parts = halves.collect();
    }
    parts.iter().map(|part| part.iter().map(|&i| (positions[i], charges[i])).unzip()).collect()
}

/// Evaluates on so many ranks at a time.
fn costs(scene: &Scene, grains: &Grains, ranks: usize) -> Result<Vec<Cost>, String> {
    std::thread::scope(|scope| {
        let work = |(rank, part): (ThreadRank, Grains)| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
            let pool = pool.map_err(|error| error.to_string())?;
            pool.install(|| cost(scene, rank, &part).map_err(|error| error.to_string()))
        };
        let shared = ThreadRank::all(ranks).into_iter().zip(bricks(grains, ranks));
        let threads: Vec<_> = shared.map(|one| scope.spawn(move || work(one))).collect();
        let joined =
            threads.into_iter().map(|thread| thread.join().map_err(|_| "a rank panicked".to_owned())?);
        joined.collect()
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<f64> = std::env::args().skip(1).map(|word| word.parse()).collect::<Result<_, _>>()?;
    let word = |number: usize, otherwise: f64| words.get(number).copied().unwrap_or(otherwise);
    let (count, tolerance, most) = (word(0, 1e5) as usize, word(1, 1e-4), word(2, 8.0) as usize);

    // A cube of charges of both signs, in a sequence that fills it evenly.
    let domain = Domain::new(Vector3::zeros(), Vector3::repeat(EDGE), [[Boundary::Periodic; 2]; 3])?;
    let at = |i: usize, step: f64| EDGE * (i as f64 * step).fract();
    let place = |i: usize| Vector3::new(at(i, 0.819_172_5), at(i, 0.671_043_6), at(i, 0.549_700_5));
    let charge = |i: usize| if i.is_multiple_of(2) { 1e-14 } else { -1e-14 };
    let grains: Grains = (0..count).map(|i| (place(i), charge(i))).unzip();
    let settings = FieldSettings {
        tolerance,
        tuning: Tuning::Model,
        neutralising_background: true,
        ..FieldSettings::default()
    };
    let choice = ElectricField::new(&domain, &settings, &grains.0, &grains.1)?.choice().clone();
    println!("{count} grains, tolerance {tolerance:e}: {choice}");
    println!("ranks  wall_ms  processor_ms  memory_MB  sent_MB  (model)  messages  (model)");
    let Choice::P3m(parameters) = choice else { return Err("these grains need no grid".into()) };
    let alone = Model {
        grains: count as f64,
        ranks: 1.0,
        nodes: (EDGE / parameters.spacing_m).round(),
        cutoff: parameters.cutoff_m / EDGE,
        order: parameters.order as f64,
    };
    let scene = Scene { domain, settings, choice };
    let mut cost_alone = None;
    for ranks in (0..).map(|power| 1 << power).take_while(|ranks| *ranks <= most) {
        let costs = costs(&scene, &grains, ranks)?;
        let most = |of: fn(&Cost) -> f64| costs.iter().map(of).fold(0.0, f64::max);
        let model = alone.with(count as f64, ranks as f64);
        println!(
            "{ranks:5}  {:7.1}  {:12.1}  {:9.1}  {:7.2}  {:7.2}  {:8.0}  {:7.0}",
            most(|cost| cost.wall_ms),
            most(|cost| cost.processor_ms),
            most(|cost| cost.memory_mb),
            most(|cost| cost.sent_mb),
            model.sent_mb(),
            most(|cost| cost.messages),
            model.messages()
        );
        cost_alone = cost_alone.or(costs.first().copied());
    }
    let many = alone.with(1e9, 1e3);
    let computing = cost_alone.map_or(f64::NAN, |cost| many.computing_ms(alone, cost));
    let (sent, messages) = (many.sent_mb(), many.messages());
    println!("model of 1e9 grains on 1000 ranks, {:.0} nodes along an edge, for a rank:", many.nodes);
    println!("{computing:.0} ms of work, {sent:.0} MB sent in {messages:.0} messages");
    Ok(())
}
