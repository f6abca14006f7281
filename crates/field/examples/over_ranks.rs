//! Cost of an evaluation that ranks share: seconds, memory and what is sent, by the number of ranks.
//!
//! `cargo run --release -p amberfield-field --example over_ranks -- [grains] [tolerance] [most ranks]`
//!
//! Ranks are threads with one core each. Where there are fewer cores than ranks the wall time says nothing;
//! the processor time of the slowest rank is what a machine with enough of them would take, without waiting.
#![expect(clippy::print_stdout, reason = "prints its table")]

use amberfield_core::{Boundary, Domain, FieldSettings, Tuning, Vector3};
use amberfield_field::{Choice, ElectricField, FieldError, FieldValues, Parcels, Ranks, ThreadRank, Wanted};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

const EVALUATIONS: usize = 10;

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
}

/// Time that this thread has had a processor [s].
fn processor_seconds() -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    told.split_whitespace().next().and_then(|word| word.parse().ok()).unwrap_or(f64::NAN) * 1e-9
}

fn cost(
    ranks: ThreadRank,
    domain: &Domain,
    settings: &FieldSettings,
    choice: &Choice,
    (positions, charges): &(Vec<Vector3<f64>>, Vec<f64>),
) -> Result<Cost, FieldError> {
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
    Ok(Cost {
        wall_ms: start.elapsed().as_secs_f64() * each,
        processor_ms: (processor_seconds() - busy) * each,
        memory_mb: field.memory_bytes() as f64 * 1e-6,
        sent_mb: 8e-6 * sent[0] as f64,
        messages: sent[1] as f64,
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<f64> = std::env::args().skip(1).map(|word| word.parse()).collect::<Result<_, _>>()?;
    let word = |number: usize, otherwise: f64| words.get(number).copied().unwrap_or(otherwise);
    let (count, tolerance, most) = (word(0, 1e5) as usize, word(1, 1e-4), word(2, 8.0) as usize);

    // A cube, grains at a fraction of 0.3 in a sequence that fills it evenly.
    let domain = Domain::new(Vector3::zeros(), Vector3::repeat(1e-2), [[Boundary::Periodic; 2]; 3])?;
    let at = |i: usize, step: f64| 1e-2 * (i as f64 * step).fract();
    let positions: Vec<_> = (0..count)
        .map(|i| Vector3::new(at(i, 0.819_172_5), at(i, 0.671_043_6), at(i, 0.549_700_5)))
        .collect();
    let charges: Vec<f64> = (0..count).map(|i| if i % 2 == 0 { 1e-14 } else { -1e-14 }).collect();
    let settings = FieldSettings {
        tolerance,
        tuning: Tuning::Model,
        neutralising_background: true,
        ..FieldSettings::default()
    };
    let choice = ElectricField::new(&domain, &settings, &positions, &charges)?.choice().clone();
    println!("{count} grains, tolerance {tolerance:e}: {choice}");
    println!("ranks  wall_ms  processor_ms  memory_MB  sent_MB  messages");
    for ranks in (0..).map(|power| 1 << power).take_while(|ranks| *ranks <= most) {
        // Bricks: halves along the three axes in turn.
        let mut parts = vec![(0..count).collect::<Vec<_>>()];
        for axis in (0..3).cycle().take(usize::ilog2(ranks) as usize) {
            parts = parts
                .into_iter()
                .flat_map(|mut part| {
                    part.sort_by(|&a, &b| positions[a][axis].total_cmp(&positions[b][axis]));
                    let rest = part.split_off(part.len() / 2);
                    [part, rest]
                })
                .collect();
        }
        let pick = |part: &Vec<usize>| part.iter().map(|&i| (positions[i], charges[i])).unzip();
        let parts: Vec<(Vec<_>, Vec<_>)> = parts.iter().map(pick).collect();
        let (domain, settings, choice) = (&domain, &settings, &choice);
        let costs: Vec<Cost> = std::thread::scope(|scope| {
            let threads = ThreadRank::all(ranks).into_iter().zip(&parts).map(|(rank, part)| {
                scope.spawn(move || {
                    let pool =
                        rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(|e| e.to_string());
                    pool?.install(|| cost(rank, domain, settings, choice, part).map_err(|e| e.to_string()))
                })
            });
            let threads: Vec<_> = threads.collect();
            threads
                .into_iter()
                .map(|thread| thread.join().map_err(|_| "a rank panicked".to_owned())?)
                .collect::<Result<_, _>>()
        })?;
        let most = |of: fn(&Cost) -> f64| costs.iter().map(of).fold(0.0, f64::max);
        println!(
            "{ranks:5}  {:7.1}  {:12.1}  {:9.1}  {:7.2}  {:8.0}",
            most(|cost| cost.wall_ms),
            most(|cost| cost.processor_ms),
            most(|cost| cost.memory_mb),
            most(|cost| cost.sent_mb),
            most(|cost| cost.messages)
        );
    }
    Ok(())
}
