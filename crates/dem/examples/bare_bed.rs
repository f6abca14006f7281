//! The plain bed by the lower folders of this crate alone: motion and contacts, compiled here without all
//! that builds on them. There is no electric field, no charge, no gas and no wall in this program.
//!
//! `cargo xtask leaving-out` compares its instructions with those of `plain_bed`, which runs the same bed as
//! a `Simulation`. Both print the same numbers.

#[path = "../src/contacts/mod.rs"]
#[expect(dead_code, unused_imports, unreachable_pub, reason = "a plain bed needs a part of them")]
mod contacts;
#[path = "../src/motion/mod.rs"]
#[expect(dead_code, reason = "a plain bed needs a part of it")]
mod motion;

mod bed;

use amberfield_core::{Domain, Vector3};
use contacts::Contacts;
use contacts::cells::{LinkedCells, levels_of, shifts};
use contacts::material_pairs::PairTable;
use contacts::neighbours::Neighbours;
use motion::chunks::{Loads, chunk_count};
use motion::grains::{Grains, SortKey};
use motion::verlet::{Bounds, ChunkMotion, drift, kick};

/// Margin of the displacement test against round-off, as in a run.
const HALF_SKIN: f64 = 0.499_999;

struct Bed {
    domain: Domain,
    grains: Grains,
    contacts: Contacts,
    keys: Vec<SortKey>,
    order: Vec<u32>,
    loads: Loads,
    motion: Vec<ChunkMotion>,
    /// Bound on any grain's displacement since the lists were built [m].
    travel: f64,
}

impl Bed {
    fn new() -> Self {
        let (domain, particles) = (bed::domain(), bed::particles());
        let table = PairTable::new(&bed::materials(), &[], Default::default());
        let features = table.features();
        let (level, level_radius) = levels_of(particles.radius.iter().copied());
        let neighbours =
            Neighbours::new(LinkedCells::new(level_radius, bed::SKIN_M), shifts(&domain), features);
        let count = particles.len();
        let mut bed = Self {
            domain,
            grains: Grains::new(&particles, level, features.rotation()),
            contacts: Contacts { table, features, neighbours, walls: None },
            keys: Vec::new(),
            order: Vec::new(),
            loads: Loads::default(),
            motion: vec![ChunkMotion::default(); chunk_count(count)],
            travel: 0.0,
        };
        bed.loads.resize(count, features.rotation());
        bed.list();
        bed.push_and_kick(0.0);
        bed
    }

    fn step(&mut self) {
        let bounds = Bounds { min: [f64::NEG_INFINITY; 3], max: [f64::INFINITY; 3] };
        let motion = drift(&mut self.grains, Vector3::zeros(), bed::STEP_S, &bounds, &mut self.motion);
        self.travel += bed::STEP_S * motion.speed;
        if self.has_used_up_skin() {
            self.list();
        }
        self.push_and_kick(bed::STEP_S);
    }

    fn has_used_up_skin(&mut self) -> bool {
        let limit = HALF_SKIN * bed::SKIN_M;
        if self.travel <= limit {
            return false;
        }
        let reference = self.contacts.neighbours.reference.iter().enumerate();
        let moved2 = reference.map(|(i, x)| (self.grains.position(i) - x).norm_squared()).fold(0.0, f64::max);
        self.travel = moved2.sqrt();
        self.travel > limit
    }

    fn list(&mut self) {
        self.grains.wrap(&self.domain);
        self.grains.spatial_order(&mut self.keys, &mut self.order);
        self.grains.reorder(&self.order);
        self.contacts.list(&self.domain, &self.grains, self.grains.len(), &self.order, bed::SKIN_M, &[]);
        self.travel = 0.0;
    }

    fn push_and_kick(&mut self, step: f64) {
        self.contacts.push_grains(&self.grains, step, None, &mut self.loads);
        let neighbours = &self.contacts.neighbours;
        let gravity = Vector3::zeros();
        kick(&mut self.grains, gravity, |k| neighbours.pushes(k), step, &mut self.loads);
    }
}

fn main() {
    let mut bed = Bed::new();
    for _ in 0..bed::STEPS {
        bed.step();
    }
    let mut order: Vec<usize> = (0..bed.grains.len()).collect();
    order.sort_unstable_by_key(|&i| bed.grains.original[i]);
    bed::tell(bed.contacts.count(), order.into_iter().map(|i| bed.grains.velocity[i]));
}
