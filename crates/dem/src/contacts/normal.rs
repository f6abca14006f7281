//! Laws of the elastic normal force of a contact: Hertz, and with adhesion DMT and JKR.
//!
//! Adhesion changes the force along the normal, the contact radius of which stiffnesses and dampings are
//! made, and the load that friction and rolling friction see: F_n + F_c for DMT, F_n + 2F_c for JKR
//! (Thornton, J. Phys. D 24, 1942 (1991)). Everything else of a contact is `crate::contacts::law`, for all
//! of them.

use crate::contacts::material_pairs::PairConstants;
use amberfield_core::Cohesion;
use amberfield_laws::{dmt, hertz_mindlin, jkr};
use nalgebra::SimdRealField;

/// Elastic state of a contact in the normal direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Elastic<T> {
    /// Contact radius [m].
    pub(crate) contact_radius: T,
    /// Force that pushes the bodies apart [N].
    pub(crate) load: T,
    /// Part of what friction sees that is beside the load [N]; of cohesive laws only.
    pub(crate) grip: T,
}

/// Law of the elastic normal force.
pub(crate) trait NormalLaw {
    /// Whether bodies stick to each other.
    const COHESIVE: bool;
    /// Whether a contact that is made lasts beyond zero overlap.
    const STRETCHES: bool;

    /// Elastic state at an overlap [m] of bodies with an effective radius [m] and a work of adhesion [J/m²],
    /// which Hertz does not read.
    fn elastic<T>(overlap: T, radius: T, pair: &PairConstants<T>, work: T) -> Elastic<T>
    where
        T: SimdRealField<Element = f64> + Copy;

    /// Load that friction sees [N].
    #[inline(always)]
    fn held<T: SimdRealField<Element = f64> + Copy>(load: T, grip: T) -> T {
        if Self::COHESIVE { load + grip } else { load }
    }
}

/// F = (4/3) Y*√R* δ^{3/2}.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hertz;

impl NormalLaw for Hertz {
    const COHESIVE: bool = false;
    const STRETCHES: bool = false;

    #[inline(always)]
    fn elastic<T>(overlap: T, radius: T, pair: &PairConstants<T>, _work: T) -> Elastic<T>
    where
        T: SimdRealField<Element = f64> + Copy,
    {
        let contact_radius = (overlap * radius).simd_sqrt();
        Elastic { contact_radius, load: pair.hertz * contact_radius * overlap, grip: T::zero() }
    }
}

/// Hertz less the pull-off force.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dmt;

impl NormalLaw for Dmt {
    const COHESIVE: bool = true;
    const STRETCHES: bool = false;

    #[inline(always)]
    fn elastic<T>(overlap: T, radius: T, pair: &PairConstants<T>, work: T) -> Elastic<T>
    where
        T: SimdRealField<Element = f64> + Copy,
    {
        let pull = dmt::pull_off(work, radius);
        let hertz = Hertz::elastic(overlap, radius, pair, work);
        Elastic { load: hertz.load - pull, grip: pull, ..hertz }
    }
}

/// Johnson, Kendall and Roberts; pairs without adhesion have Hertz's contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jkr;

impl NormalLaw for Jkr {
    const COHESIVE: bool = true;
    const STRETCHES: bool = true;

    #[inline(always)]
    fn elastic<T>(overlap: T, radius: T, pair: &PairConstants<T>, work: T) -> Elastic<T>
    where
        T: SimdRealField<Element = f64> + Copy,
    {
        let sticks = work.simd_gt(T::zero());
        let hertz = Hertz::elastic(overlap, radius, pair, work);
        let scale = jkr::Scale::new(work, radius, pair.normal * T::splat(0.5));
        let root = scale.root(overlap);
        Elastic {
            contact_radius: scale.radius(root).select(sticks, hertz.contact_radius),
            load: scale.force(root).select(sticks, hertz.load),
            grip: (scale.pull_off * T::splat(2.0)).select(sticks, T::zero()),
        }
    }
}

/// Elastic state of a contact by the law of a model.
pub(crate) fn elastic_by(
    cohesion: Cohesion,
    overlap: f64,
    radius: f64,
    pair: &PairConstants<f64>,
    work: f64,
) -> Elastic<f64> {
    match cohesion {
        Cohesion::None => Hertz::elastic(overlap, radius, pair, work),
        Cohesion::Dmt => Dmt::elastic(overlap, radius, pair, work),
        Cohesion::Jkr => Jkr::elastic(overlap, radius, pair, work),
    }
}

/// Energy [J] of a contact, from zero where it is made: elastic, less what adhesion gained.
pub(crate) fn energy_by(
    cohesion: Cohesion,
    overlap: f64,
    radius: f64,
    pair: &PairConstants<f64>,
    work: f64,
) -> f64 {
    let young = 0.5 * pair.normal;
    match cohesion {
        Cohesion::Jkr if work > 0.0 => {
            let scale = jkr::Scale::new(work, radius, young);
            scale.energy(scale.root(overlap)) - scale.energy(scale.root(0.0))
        }
        Cohesion::Dmt => {
            hertz_mindlin::normal_energy(young, radius, overlap) - dmt::pull_off(work, radius) * overlap
        }
        _ => hertz_mindlin::normal_energy(young, radius, overlap),
    }
}
