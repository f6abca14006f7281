//! The moving grains, sorted in space: structures of arrays.

use amberfield_core::{Domain, Particles, Vector3};
use serde::{Deserialize, Serialize};

/// Index of a grain in the set-up's order, by which everything constant is found.
///
/// A plain index of a grain is one in the order of the last sort.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) struct Original(u32);

impl Original {
    /// Index of a grain of the set-up.
    pub(crate) fn new(index: usize) -> Self {
        Self(index as u32)
    }

    /// Index into arrays of the set-up.
    #[inline(always)]
    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}

/// Moving grains in the order of the last sort; everything constant stays with the set-up's particles and is
/// found through `original`.
#[derive(Debug, Default)]
pub(crate) struct Grains {
    /// Index in the set-up's order.
    pub(crate) original: Vec<Original>,
    /// Centre and radius [m]; periodic coordinates are wrapped at rebuilds only.
    pub(crate) centre: Vec<[f64; 4]>,
    /// Velocity [m/s]; during a step that of its middle.
    pub(crate) velocity: Vec<Vector3<f64>>,
    /// Velocity forecast in a step for its end, from the forces before [m/s]; no state.
    pub(crate) forecast: Vec<Vector3<f64>>,
    /// Angular velocity [rad/s]; during a step that of its middle.
    pub(crate) angular: Vec<Vector3<f64>>,
    /// Force of the last evaluation without gravity [N].
    pub(crate) force: Vec<Vector3<f64>>,
    /// Torque of the last evaluation [N·m]; empty when nothing can turn a grain.
    pub(crate) torque: Vec<Vector3<f64>>,
    /// Rates Γ at which all contacts of a grain slowed it at the last evaluation [1/s].
    pub(crate) slowing: Vec<f64>,
    /// 1/m [1/kg]; 0 of a grain that never moves, as if it were infinitely heavy.
    pub(crate) inverse_mass: Vec<f64>,
    /// Whether any grain never moves.
    pub(crate) some_fixed: bool,
    /// Material index.
    pub(crate) material: Vec<u16>,
    /// Level of the cells.
    pub(crate) level: Vec<u8>,
    /// Memory of the reordering.
    pub(crate) spare: Spare,
}

/// A grain about to come.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Newcomer {
    /// Index in the set-up's order.
    pub(crate) original: u32,
    /// Level of the cells.
    pub(crate) level: u8,
    /// Place of the centre [m].
    pub(crate) position: Vector3<f64>,
    /// Velocity in the middle of the step [m/s].
    pub(crate) middle: Vector3<f64>,
    /// Velocity at the end of the step, without forces but gravity [m/s].
    pub(crate) end: Vector3<f64>,
    /// Whether it is further than the lists' skin from all grains and walls.
    pub(crate) is_alone: bool,
}

/// State of the grains, for checkpoints, in the order of the last sort.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct GrainsState {
    /// Index in the set-up's order.
    pub(crate) original: Vec<Original>,
    /// Centre [m].
    pub(crate) centre: Vec<Vector3<f64>>,
    /// Velocity [m/s].
    pub(crate) velocity: Vec<Vector3<f64>>,
    /// Angular velocity [rad/s].
    pub(crate) angular: Vec<Vector3<f64>>,
    /// Force of the last evaluation without gravity [N].
    pub(crate) force: Vec<Vector3<f64>>,
    /// Torque of the last evaluation [N·m]; empty when nothing can turn a grain.
    pub(crate) torque: Vec<Vector3<f64>>,
    /// Rates at which all contacts of a grain slowed it at the last evaluation [1/s].
    pub(crate) slowing: Vec<f64>,
}

/// Arrays that reordering writes into, kept so that rebuilds do not allocate.
#[derive(Debug, Default)]
pub(crate) struct Spare {
    pub(crate) vectors: Vec<Vector3<f64>>,
    quads: Vec<[f64; 4]>,
    reals: Vec<f64>,
    originals: Vec<Original>,
    materials: Vec<u16>,
    levels: Vec<u8>,
}

impl Grains {
    pub(crate) fn new(particles: &Particles, level: Vec<u8>, rotation: bool) -> Self {
        let count = particles.len();
        Self {
            original: (0..count as u32).map(Original).collect(),
            centre: (0..count)
                .map(|i| {
                    let x = particles.position[i];
                    [x.x, x.y, x.z, particles.radius[i]]
                })
                .collect(),
            velocity: particles.velocity.clone(),
            forecast: particles.velocity.clone(),
            angular: particles.angular_velocity.clone(),
            force: vec![Vector3::zeros(); count],
            torque: vec![Vector3::zeros(); if rotation { count } else { 0 }],
            slowing: vec![0.0; count],
            inverse_mass: (0..count).map(|i| inverse_mass(particles, i)).collect(),
            some_fixed: (0..count).any(|i| particles.is_fixed(i)),
            material: particles.material.iter().map(|m| m.0).collect(),
            level,
            spare: Spare::default(),
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.original.len()
    }

    /// Whether a grain never moves.
    #[inline(always)]
    pub(crate) fn is_fixed(&self, index: usize) -> bool {
        self.inverse_mass[index] == 0.0
    }

    /// Sorted indices of the grains that move.
    pub(crate) fn moving(&self) -> impl Iterator<Item = usize> {
        (0..self.len()).filter(|&i| !self.is_fixed(i))
    }

    pub(crate) fn position(&self, index: usize) -> Vector3<f64> {
        let c = self.centre[index];
        Vector3::new(c[0], c[1], c[2])
    }

    /// State for a checkpoint.
    pub(crate) fn state(&self) -> GrainsState {
        GrainsState {
            original: self.original.clone(),
            centre: (0..self.len()).map(|i| self.position(i)).collect(),
            velocity: self.velocity.clone(),
            angular: self.angular.clone(),
            force: self.force.clone(),
            torque: self.torque.clone(),
            slowing: self.slowing.clone(),
        }
    }

    /// Moves as a state says; the grains are in its order already.
    pub(crate) fn restore(&mut self, state: GrainsState) {
        self.place(&state.centre);
        self.forecast.clone_from(&state.velocity);
        self.velocity = state.velocity;
        self.angular = state.angular;
        self.force = state.force;
        self.torque = state.torque;
        self.slowing = state.slowing;
    }

    /// Puts the grains at other centres [m].
    pub(crate) fn place(&mut self, centres: &[Vector3<f64>]) {
        for (c, x) in self.centre.iter_mut().zip(centres) {
            (c[0], c[1], c[2]) = (x.x, x.y, x.z);
        }
    }

    /// Moves the grains that have passed a periodic face back into the domain.
    pub(crate) fn wrap(&mut self, domain: &Domain) {
        for c in &mut self.centre {
            let wrapped = domain.wrap(Vector3::new(c[0], c[1], c[2]));
            (c[0], c[1], c[2]) = (wrapped.x, wrapped.y, wrapped.z);
        }
    }

    /// Whether a grain's centre is finite.
    pub(crate) fn is_finite(&self, index: usize) -> bool {
        self.centre[index].iter().all(|x| x.is_finite())
    }

    /// Takes the order of a state, from that of the set-up; grains that the state does not name are dropped.
    pub(crate) fn take_order(&mut self, original: &[Original]) {
        let order: Vec<u32> = original.iter().map(|original| original.0).collect();
        self.reorder(&order);
    }

    /// Appends a grain of the set-up that was not there, on a level of the cells, at a position [m]. Its
    /// velocity is that of the middle of a step, with its forecast for the end [m/s]. `turns`: whether
    /// anything can turn a grain.
    pub(crate) fn admit(&mut self, particles: &Particles, newcomer: &Newcomer, turns: bool) {
        let Newcomer { original, level, position, middle, end, .. } = *newcomer;
        self.original.push(Original(original));
        let radius = particles.radius[original as usize];
        self.centre.push([position.x, position.y, position.z, radius]);
        self.velocity.push(middle);
        self.forecast.push(end);
        self.angular.push(particles.angular_velocity[original as usize]);
        self.force.push(Vector3::zeros());
        if turns {
            self.torque.push(Vector3::zeros());
        }
        self.slowing.push(0.0);
        self.inverse_mass.push(inverse_mass(particles, original as usize));
        self.material.push(particles.material[original as usize].0);
        self.level.push(level);
    }

    /// Reorders to `order[new] = old`; grains that are not named are dropped.
    pub(crate) fn reorder(&mut self, order: &[u32]) {
        let spare = &mut self.spare;
        pick(&mut self.original, order, &mut spare.originals);
        pick(&mut self.centre, order, &mut spare.quads);
        pick(&mut self.velocity, order, &mut spare.vectors);
        pick(&mut self.forecast, order, &mut spare.vectors);
        pick(&mut self.angular, order, &mut spare.vectors);
        pick(&mut self.force, order, &mut spare.vectors);
        if !self.torque.is_empty() {
            pick(&mut self.torque, order, &mut spare.vectors);
        }
        pick(&mut self.slowing, order, &mut spare.reals);
        pick(&mut self.inverse_mass, order, &mut spare.reals);
        pick(&mut self.material, order, &mut spare.materials);
        pick(&mut self.level, order, &mut spare.levels);
    }

    /// Order along a Morton curve, equal keys by original index: it depends on positions only.
    pub(crate) fn spatial_order(&self, keys: &mut Vec<SortKey>, order: &mut Vec<u32>) {
        let mut min = Vector3::repeat(f64::INFINITY);
        let mut max = Vector3::repeat(f64::NEG_INFINITY);
        for i in 0..self.len() {
            min = min.inf(&self.position(i));
            max = max.sup(&self.position(i));
        }
        // One scale for all axes keeps the curve's cells cubic.
        let extent = (max - min).max();
        let scale = if extent > 0.0 { f64::from((1_u32 << MORTON_BITS) - 1) / extent } else { 0.0 };
        keys.clear();
        keys.extend((0..self.len()).map(|i| {
            let cell = (self.position(i) - min) * scale;
            let curve = spread(cell.x as u64) | spread(cell.y as u64) << 1 | spread(cell.z as u64) << 2;
            SortKey { curve, original: self.original[i], index: i as u32 }
        }));
        keys.sort_unstable();
        order.clear();
        order.extend(keys.iter().map(|key| key.index));
    }
}

/// 1/m [1/kg] of a grain of the set-up; 0 where it never moves.
fn inverse_mass(particles: &Particles, index: usize) -> f64 {
    if particles.is_fixed(index) { 0.0 } else { 1.0 / particles.mass(index) }
}

/// Key of the sort in space; what comes first in it decides first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct SortKey {
    /// Place along the Morton curve.
    curve: u64,
    original: Original,
    /// Index before the sort.
    index: u32,
}

/// Bits per axis of the Morton key.
const MORTON_BITS: u32 = 20;

/// Spreads 20 bits to every third bit.
fn spread(x: u64) -> u64 {
    let x = x & 0x1f_ffff;
    let x = (x | x << 32) & 0x1f_0000_0000_ffff;
    let x = (x | x << 16) & 0x1f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

/// array[new] = array[order[new]]; `spare` lends its memory and takes that of the array.
pub(crate) fn pick<T: Copy>(array: &mut Vec<T>, order: &[u32], spare: &mut Vec<T>) {
    spare.clear();
    spare.extend(order.iter().map(|&old| array[old as usize]));
    std::mem::swap(array, spare);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_leaves_two_zero_bits_between() {
        assert_eq!(spread(0b1011), 0b1_000_001_001);
        assert_eq!(spread((1 << 20) - 1).count_ones(), 20);
    }
}
