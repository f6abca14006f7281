//! Constants of every pair of materials, mixed once.
//!
//! Y*, G* as in Hertz–Mindlin; restitution: geometric mean; friction and rolling friction: the smaller one
//! (sources with the laws).

use amberfield_core::{Material, MaterialId, RollingModel};
use amberfield_laws::{coulomb_friction, hertz_mindlin, restitution, rolling_friction};

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
}

impl PairTable {
    pub(crate) fn new(materials: &[Material]) -> Self {
        let constants =
            materials.iter().flat_map(|a| materials.iter().map(move |b| Self::mix(a, b))).collect();
        Self { materials: materials.len(), constants }
    }

    fn mix(a: &Material, b: &Material) -> PairConstants<f64> {
        let young = hertz_mindlin::effective_young(a.young_pa, a.poisson, b.young_pa, b.poisson);
        let shear = hertz_mindlin::effective_shear(a.young_pa, a.poisson, b.young_pa, b.poisson);
        let beta = restitution::damping_ratio(restitution::mixed(a.restitution, b.restitution));
        PairConstants {
            hertz: 4.0 / 3.0 * young,
            normal: 2.0 * young,
            tangential: 8.0 * shear,
            damping: hertz_mindlin::DAMPING_FACTOR * beta * (2.0 * young).sqrt(),
            tangential_ratio: (4.0 * shear / young).sqrt(),
            friction: coulomb_friction::mixed(a.friction, b.friction),
            rolling: rolling_friction::mixed(a.rolling_friction, b.rolling_friction),
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

    /// Largest Y* [Pa] of a material with any other.
    pub(crate) fn stiffest(&self, material: MaterialId) -> f64 {
        (0..self.materials).map(|b| self.get(material.0, b as u16).normal / 2.0).fold(0.0, f64::max)
    }

    /// Contact terms that any pair needs.
    pub(crate) fn features(&self) -> Features {
        Features {
            friction: self.constants.iter().any(|c| c.friction > 0.0),
            rolling: self.constants.iter().any(|c| c.rolling > 0.0),
            damping: self.constants.iter().any(|c| c.damping > 0.0),
            charging: false,
            rolling_model: RollingModel::default(),
        }
    }
}

/// Contact terms that a scene needs; what it does not need is compiled out of its loops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Features {
    pub(crate) friction: bool,
    pub(crate) rolling: bool,
    pub(crate) damping: bool,
    /// Whether contacts move charge; materials do not know.
    pub(crate) charging: bool,
    /// Model of rolling friction; materials do not know.
    pub(crate) rolling_model: RollingModel,
}

impl Features {
    /// Whether grains can start to spin.
    pub(crate) fn rotation(self) -> bool {
        self.friction || self.rolling
    }
}
