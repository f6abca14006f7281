//! Constants of every pair of materials, mixed once.
//!
//! Y*, G* as in Hertz–Mindlin; restitution: geometric mean; friction and rolling friction: the smaller one
//! (sources with the laws); work of adhesion: 2√(γ_i γ_j). Values that the scene gives
//! for a pair replace them.

use amberfield_core::{Cohesion, Material, MaterialId, MaterialPair, RollingModel};
use amberfield_laws::{
    coulomb_friction, hertz_mindlin, jkr, restitution, rolling_friction, work_of_adhesion,
};

/// Constants of a pair of materials, or of several side by side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairConstants<T> {
    /// (4/3) Y* [Pa].
    pub(crate) hertz: T,
    /// 2 Y* [Pa]: S_n = this · √(R*δ).
    pub(crate) normal: T,
    /// 8 G* [Pa]: S_t = this · √(R*δ).
    pub(crate) tangential: T,
    /// 2√(5/6) β √(2Y*): γ_n = this · √(√(R*δ) m*).
    pub(crate) damping: T,
    /// √(S_t/S_n): γ_t = this · γ_n.
    pub(crate) tangential_ratio: T,
    /// μ.
    pub(crate) friction: T,
    /// μ_r.
    pub(crate) rolling: T,
}

impl<T> PairConstants<T> {
    /// Applies a function to every number.
    #[inline(always)]
    pub(crate) fn map<U>(self, each: impl Fn(T) -> U) -> PairConstants<U> {
        PairConstants {
            hertz: each(self.hertz),
            normal: each(self.normal),
            tangential: each(self.tangential),
            damping: each(self.damping),
            tangential_ratio: each(self.tangential_ratio),
            friction: each(self.friction),
            rolling: each(self.rolling),
        }
    }
}

impl PairConstants<f64> {
    /// Whether springs of a contact with other constants mean the same here; dashpots have no memory.
    pub(crate) fn has_springs_of(&self, other: &Self) -> bool {
        let springs = |pair: &Self| [pair.hertz, pair.normal, pair.tangential, pair.friction, pair.rolling];
        springs(self) == springs(other)
    }
}

impl<const LANES: usize> PairConstants<[f64; LANES]> {
    /// Sets one of the lanes.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, pair: &PairConstants<f64>) {
        self.hertz[lane] = pair.hertz;
        self.normal[lane] = pair.normal;
        self.tangential[lane] = pair.tangential;
        self.damping[lane] = pair.damping;
        self.tangential_ratio[lane] = pair.tangential_ratio;
        self.friction[lane] = pair.friction;
        self.rolling[lane] = pair.rolling;
    }
}

/// Table of all pairs.
#[derive(Clone, Debug)]
pub(crate) struct PairTable {
    materials: usize,
    constants: Vec<PairConstants<f64>>,
    cohesion: Cohesion,
    /// Works of adhesion [J/m²]; empty without cohesion.
    work: Vec<f64>,
}

impl PairTable {
    /// Mixes the constants of all pairs; values that are given for a pair replace mixed ones.
    pub(crate) fn new(materials: &[Material], pairs: &[MaterialPair], cohesion: Cohesion) -> Self {
        let count = materials.len();
        let all = (0..count).flat_map(|a| (0..count).map(move |b| (a, b)));
        let given = |(a, b): (usize, usize)| {
            let ids = (MaterialId(a as u16), MaterialId(b as u16));
            pairs.iter().find(|pair| pair.is_between(ids.0, ids.1))
        };
        let constants =
            all.clone().map(|(a, b)| Self::mix(&materials[a], &materials[b], given((a, b)))).collect();
        let work = |(a, b): (usize, usize)| {
            let of_pair = given((a, b)).and_then(|pair| pair.surface_energy_j_m2);
            let [one, other] = [a, b].map(|material| materials[material].surface_energy_j_m2);
            of_pair.map_or_else(|| work_of_adhesion::mixed(one, other), |energy| 2.0 * energy)
        };
        let work = if cohesion == Cohesion::None { Vec::new() } else { all.map(work).collect() };
        Self { materials: count, constants, cohesion, work }
    }

    fn mix(a: &Material, b: &Material, given: Option<&MaterialPair>) -> PairConstants<f64> {
        let young = hertz_mindlin::effective_young(a.young_pa, a.poisson, b.young_pa, b.poisson);
        let shear = hertz_mindlin::effective_shear(a.young_pa, a.poisson, b.young_pa, b.poisson);
        let or_mixed =
            |of_pair: fn(&MaterialPair) -> Option<f64>, mixed: f64| given.and_then(of_pair).unwrap_or(mixed);
        let restitution = or_mixed(|pair| pair.restitution, restitution::mixed(a.restitution, b.restitution));
        let beta = restitution::damping_ratio(restitution);
        PairConstants {
            hertz: 4.0 / 3.0 * young,
            normal: 2.0 * young,
            tangential: 8.0 * shear,
            damping: hertz_mindlin::DAMPING_FACTOR * beta * (2.0 * young).sqrt(),
            tangential_ratio: (4.0 * shear / young).sqrt(),
            friction: or_mixed(|pair| pair.friction, coulomb_friction::mixed(a.friction, b.friction)),
            rolling: or_mixed(
                |pair| pair.rolling_friction,
                rolling_friction::mixed(a.rolling_friction, b.rolling_friction),
            ),
        }
    }

    /// Whether there is more than one pair.
    #[inline(always)]
    pub(crate) fn is_mixed(&self) -> bool {
        self.materials > 1
    }

    /// Constants of materials `a` and `b`.
    #[inline(always)]
    pub(crate) fn get(&self, a: u16, b: u16) -> &PairConstants<f64> {
        &self.constants[a as usize * self.materials + b as usize]
    }

    /// Work of adhesion [J/m²] of materials `a` and `b`, in a scene with cohesion; 0 in others.
    #[inline(always)]
    pub(crate) fn work(&self, a: u16, b: u16) -> f64 {
        self.work.get(a as usize * self.materials + b as usize).copied().unwrap_or(0.0)
    }

    /// Units of JKR's contact of materials `a` and `b` with an effective radius [m]; `None` where nothing
    /// stretches.
    pub(crate) fn jkr(&self, a: u16, b: u16, radius: f64) -> Option<jkr::Scale<f64>> {
        let work = self.work(a, b);
        (self.cohesion == Cohesion::Jkr && work > 0.0)
            .then(|| jkr::Scale::new(work, radius, 0.5 * self.get(a, b).normal))
    }

    /// Longest stretch [m] of a contact that was made, of materials `a` and `b` and an effective radius [m].
    pub(crate) fn stretch(&self, a: u16, b: u16, radius: f64) -> f64 {
        self.jkr(a, b, radius).map_or(0.0, |scale| scale.longest_stretch())
    }

    /// Bound on the stretch of any contact [m], for a largest effective radius [m].
    pub(crate) fn longest_stretch(&self, radius: f64) -> f64 {
        let all = (0..self.materials).flat_map(|a| (0..self.materials).map(move |b| (a as u16, b as u16)));
        all.map(|(a, b)| self.stretch(a, b, radius)).fold(0.0, f64::max)
    }

    /// Largest Y* [Pa] of a material with any other.
    pub(crate) fn stiffest(&self, material: MaterialId) -> f64 {
        (0..self.materials).map(|b| self.get(material.0, b as u16).normal / 2.0).fold(0.0, f64::max)
    }

    /// Contact terms that any pair needs.
    pub(crate) fn features(&self) -> Features {
        let sticks = self.cohesion != Cohesion::None;
        Features {
            friction: sticks || self.constants.iter().any(|c| c.friction > 0.0),
            rolling: self.constants.iter().any(|c| c.rolling > 0.0),
            damping: sticks || self.constants.iter().any(|c| c.damping > 0.0),
            cohesion: self.cohesion,
            charging: false,
            rolling_model: RollingModel::default(),
        }
    }
}

/// Contact terms that a scene needs; what it does not need is compiled out of its loops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Features {
    /// Whether contacts have a tangential force; cohesive ones always have what it takes.
    pub(crate) friction: bool,
    pub(crate) rolling: bool,
    pub(crate) damping: bool,
    /// Model of cohesion.
    pub(crate) cohesion: Cohesion,
    /// Whether contacts move charge; materials do not know.
    pub(crate) charging: bool,
    /// Model of rolling friction; materials do not know.
    pub(crate) rolling_model: RollingModel,
}

impl Features {
    /// Whether a contact that is made lasts beyond zero overlap.
    pub(crate) fn stretches(self) -> bool {
        self.cohesion == Cohesion::Jkr
    }

    /// Whether grains can start to spin.
    pub(crate) fn rotation(self) -> bool {
        self.friction || self.rolling
    }
}
