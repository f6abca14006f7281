//! Constants of charging of every pair of materials.

use amberfield_core::{ChargeTransfer, Material};
use amberfield_laws::{charge_transfer, contact_area, hertz_mindlin};

/// Constants of one pair of materials.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairCharging {
    /// ε(W_i − W_j)/(δe) [C/m²].
    pub(super) work: f64,
    /// σ_A, 1 without a correction.
    pub(super) area_factor: f64,
}

/// Constants of all pairs.
#[derive(Debug)]
pub(super) struct ChargingTable {
    materials: usize,
    pairs: Vec<PairCharging>,
}

impl ChargingTable {
    /// Mixes the constants of all pairs in a medium of a permittivity [F/m].
    pub(super) fn new(materials: &[Material], settings: &ChargeTransfer, permittivity: f64) -> Self {
        let mix = |a: &Material, b: &Material| {
            let work_functions = [a, b].map(|material| material.work_function_ev.unwrap_or(0.0));
            let star = |young: fn(&Material) -> f64| {
                hertz_mindlin::effective_young(young(a), a.poisson, young(b), b.poisson)
            };
            let (soft, real) = (star(|m| m.young_pa), star(|m| m.young_real_pa.unwrap_or(m.young_pa)));
            PairCharging {
                work: charge_transfer::work_term(permittivity, work_functions, settings.cutoff_m),
                area_factor: settings
                    .stiffness_correction
                    .map_or(1.0, |velocity_ratio| contact_area::correction(soft, real, velocity_ratio)),
            }
        };
        let pairs = materials.iter().flat_map(|a| materials.iter().map(move |b| mix(a, b))).collect();
        Self { materials: materials.len(), pairs }
    }

    /// Constants of materials `a` and `b`, in this order.
    pub(super) fn get(&self, a: u16, b: u16) -> PairCharging {
        self.pairs[usize::from(a) * self.materials + usize::from(b)]
    }
}
