//! Energies of the grains.

use crate::contacts::Contacts;
use crate::contacts::material_pairs::{Features, PairConstants};
use crate::contacts::memory::Spring;
use crate::contacts::normal;
use crate::contacts::walls::ContactWalls;
use crate::motion::grains::Grains;
use amberfield_core::{Cohesion, RollingModel, Vector3};
use amberfield_laws::{rolling_epsd, rolling_epsd2};

/// Energies [J].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energies {
    /// Translation and rotation [J].
    pub kinetic: f64,
    /// Elastic energy of the contacts: normal, tangential and rolling springs, less what adhesion gained
    /// since they were made [J].
    pub contact: f64,
    /// −Σ m g·x [J] of the grains that move, zero at the origin; along periodic axes with the coordinates
    /// that the run uses.
    pub gravity: f64,
    /// ½ Σ q (V + V_external) [J]; `None` when not asked for or without a field.
    pub electric: Option<f64>,
    /// Error of their sum that rounding, and the field within its tolerance, may make [J].
    pub error: f64,
}

/// Error of mechanical energies by rounding, over the sum of the sizes of their terms.
pub(crate) const ROUND_OFF: f64 = 1e-9;

/// Way to find the electric energy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElectricEnergy {
    /// Left out.
    LeftOut,
    /// Extrapolated in time from the last two evaluations of the field: costs nothing, and is as good as the
    /// force. A grain that has left counts until the next evaluation.
    Forecast,
    /// Evaluated once more, at the present positions.
    Evaluated,
}

/// ½ m v² + ½ I ω², I = (2/5) m r², of the grains that move.
pub(crate) fn kinetic(grains: &Grains) -> f64 {
    grains
        .moving()
        .map(|i| {
            let r = grains.centre[i][3];
            let spin = 0.4 * r * r * grains.angular[i].norm_squared();
            0.5 * (grains.velocity[i].norm_squared() + spin) / grains.inverse_mass[i]
        })
        .sum()
}

/// −Σ m g·x of the grains that move, and the sum of the sizes of its terms.
pub(crate) fn gravity(grains: &Grains, gravity: Vector3<f64>) -> (f64, f64) {
    let terms = grains.moving().map(|i| -grains.position(i).dot(&gravity) / grains.inverse_mass[i]);
    terms.fold((0.0, 0.0), |(sum, sizes), term| (sum + term, sizes + term.abs()))
}

/// Elastic energy of all touching contacts.
pub(crate) fn contact(grains: &Grains, contacts: &Contacts) -> f64 {
    let Contacts { table, features, neighbours, walls } = contacts;
    let mut sum = 0.0;
    for touching in neighbours.touching() {
        let list = &neighbours.lists[touching.chunk];
        let (a, b) = (&grains.centre[touching.i], &grains.centre[touching.j]);
        let distance = touching.distance(grains, &neighbours.shifts);
        let overlap = a[3] + b[3] - distance;
        let springs = Springs {
            pair: table.get(grains.material[touching.i], grains.material[touching.j]),
            features: *features,
            radius: a[3] * b[3] / (a[3] + b[3]),
            overlap: if features.stretches() { overlap } else { overlap.max(0.0) },
            joined: 0.0,
            work: table.work(grains.material[touching.i], grains.material[touching.j]),
        };
        let spring = list.spring.get(touching.entry).copied().unwrap_or_default();
        let rolling = list.rolling.get(touching.entry).copied().unwrap_or_default();
        sum += springs.energy(&spring, &rolling);
    }
    for touching in walls.iter().flat_map(ContactWalls::touching) {
        let springs = Springs {
            pair: table.get(grains.material[touching.grain], touching.material),
            features: *features,
            radius: grains.centre[touching.grain][3],
            overlap: touching.overlap,
            joined: touching.joined,
            work: table.work(grains.material[touching.grain], touching.material),
        };
        sum += springs.energy(&touching.spring, &touching.rolling);
    }
    sum
}

/// Springs of a touching contact, as the contact law has them.
struct Springs<'a> {
    pair: &'a PairConstants<f64>,
    features: Features,
    radius: f64,
    overlap: f64,
    /// Overlap with the line where the contact joins a deeper one, whose energy is not its own.
    joined: f64,
    /// Work of adhesion [J/m²].
    work: f64,
}

impl Springs<'_> {
    fn energy(&self, spring: &Spring, rolling: &[f64; 3]) -> f64 {
        let (features, pair) = (self.features, self.pair);
        if features.cohesion != Cohesion::None {
            return self.with_others(self.normal_with_cohesion(), self.cohesive_radius(), spring, rolling);
        }
        let contact_radius = (self.radius * self.overlap).sqrt();
        let mut energy = 0.4 * pair.hertz * contact_radius * self.overlap * self.overlap;
        if self.joined > 0.0 {
            let whole = (self.overlap.powf(1.5) + self.joined.powf(1.5)).cbrt().powi(5);
            energy = 0.4 * pair.hertz * self.radius.sqrt() * (whole - self.joined.powf(2.5));
        }
        self.with_others(energy, contact_radius, spring, rolling)
    }

    /// Normal energy of a contact that sticks, less that of the line where it joins a deeper one [J].
    fn normal_with_cohesion(&self) -> f64 {
        let of =
            |overlap| normal::energy_by(self.features.cohesion, overlap, self.radius, self.pair, self.work);
        of(self.overlap) - if self.joined > 0.0 { of(self.joined) } else { 0.0 }
    }

    /// Contact radius of a contact that sticks, less that of the line where it joins a deeper one [m].
    fn cohesive_radius(&self) -> f64 {
        let of = |overlap| {
            let cohesion = self.features.cohesion;
            normal::elastic_by(cohesion, overlap, self.radius, self.pair, self.work).contact_radius
        };
        let line = if self.joined > 0.0 { of(self.joined) } else { 0.0 };
        (of(self.overlap).powi(2) - line * line).max(0.0).sqrt()
    }

    /// Adds the energies of the tangential and the rolling spring [J] to that of the normal one.
    fn with_others(&self, normal: f64, contact_radius: f64, spring: &Spring, rolling: &[f64; 3]) -> f64 {
        let mut energy = normal;
        if self.features.friction && contact_radius > 0.0 {
            let force2 = spring.force.iter().map(|f| f * f).sum::<f64>();
            energy += 0.5 * force2 / (self.pair.tangential * contact_radius);
        }
        if self.features.rolling && contact_radius > 0.0 && self.pair.rolling > 0.0 {
            energy += 0.5 * rolling.iter().map(|t| t * t).sum::<f64>() / self.rolling(contact_radius);
        }
        energy
    }

    /// Stiffness of the rolling spring [N·m/rad], infinite where the model has none.
    fn rolling(&self, contact_radius: f64) -> f64 {
        let (pair, radius) = (self.pair, self.radius);
        match self.features.rolling_model {
            RollingModel::Epsd => rolling_epsd::stiffness(pair.normal * contact_radius, pair.rolling, radius),
            RollingModel::Epsd2 => rolling_epsd2::stiffness(pair.tangential * contact_radius, radius),
            RollingModel::Cdt => f64::INFINITY,
        }
    }
}
