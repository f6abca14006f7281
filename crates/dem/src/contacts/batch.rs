//! Contacts of grains side by side: the law of `crate::contacts::law` on vectors of numbers, so that no
//! contact waits for the roots of another.

use crate::contacts::law::{Contact, History, respond};
use crate::contacts::material_pairs::PairConstants;
use crate::contacts::normal::NormalLaw;
use amberfield_core::{RollingModel, Vector3};
use amberfield_laws::contact_area;
use nalgebra::{SimdPartialOrd, SimdValue};
use simba::simd::WideF64x4;
use std::f64::consts::PI;

/// Contacts in a batch.
pub(crate) const BATCH: usize = WideF64x4::LANES;

/// A number for every contact.
type Lanes = [f64; BATCH];

/// A vector for every contact.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Vectors([Lanes; 3]);

impl Vectors {
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, vector: Vector3<f64>) {
        (self.0[0][lane], self.0[1][lane], self.0[2][lane]) = (vector.x, vector.y, vector.z);
    }

    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> Vector3<f64> {
        Vector3::new(self.0[0][lane], self.0[1][lane], self.0[2][lane])
    }

    #[inline(always)]
    fn load(&self) -> Vector3<WideF64x4> {
        let [x, y, z] = self.0;
        Vector3::new(x.into(), y.into(), z.into())
    }

    #[inline(always)]
    fn store(vectors: Vector3<WideF64x4>) -> Self {
        Self([vectors.x.into_arr(), vectors.y.into_arr(), vectors.z.into_arr()])
    }
}

/// The two grains of every contact, its history, and what it does.
#[derive(Clone, Debug)]
pub(crate) struct Batch {
    /// Offset from the centre of i to that of j [m].
    pub(crate) offset: Vectors,
    /// v_i − v_j of the centres in the middle of the step [m/s].
    pub(crate) velocity: Vectors,
    /// v_i − v_j of the centres as forecast for the end of the step [m/s].
    pub(crate) forecast: Vectors,
    /// Radii of i and j [m].
    pub(crate) radius: [Lanes; 2],
    /// 1/m of i and j [1/kg].
    pub(crate) inverse_mass: [Lanes; 2],
    /// Γ_i + Γ_j: rates at which all contacts of i and j slowed them in the last step [1/s].
    pub(crate) slowing: Lanes,
    /// ω of i and j [rad/s].
    pub(crate) angular: [Vectors; 2],
    /// Tangential spring [N].
    pub(crate) spring: Vectors,
    /// Contact radius of the last step [m].
    pub(crate) contact_radius: Lanes,
    /// Rolling spring [N·m].
    pub(crate) rolling: Vectors,
    /// Work of adhesion [J/m²]; of cohesive laws only.
    pub(crate) work: Lanes,
    /// Constants of the materials.
    pub(crate) pair: PairConstants<Lanes>,
    /// Force on i [N].
    pub(crate) force: Vectors,
    /// Torques on i and j [N·m].
    pub(crate) torque: [Vectors; 2],
    /// Largest damping coefficient in any direction [N·s/m].
    pub(crate) damping: Lanes,
    /// Overlap over the smaller radius.
    pub(crate) depth: Lanes,
}

impl Batch {
    /// A batch of contacts of one pair of materials, unless told otherwise.
    pub(crate) fn new(pair: PairConstants<f64>) -> Self {
        let (none, zero) = (Vectors::default(), [0.0; BATCH]);
        Self {
            offset: none,
            velocity: none,
            forecast: none,
            radius: [zero; 2],
            inverse_mass: [zero; 2],
            slowing: zero,
            angular: [none; 2],
            spring: none,
            contact_radius: zero,
            rolling: none,
            work: zero,
            pair: pair.map(|number| [number; BATCH]),
            force: none,
            torque: [none; 2],
            damping: zero,
            depth: zero,
        }
    }

    /// Area of a contact [m²], after [`Self::respond`].
    #[inline(always)]
    pub(crate) fn area<const FRICTION: bool>(&self, lane: usize) -> f64 {
        if FRICTION {
            return PI * self.contact_radius[lane] * self.contact_radius[lane];
        }
        let (a, b) = (self.radius[0][lane], self.radius[1][lane]);
        contact_area::hertz(a * b / (a + b), a + b - self.offset.get(lane).norm())
    }

    /// Forces and torques of every contact by a law, with a model of rolling; springs advance by `step` [s].
    #[inline(always)]
    pub(crate) fn respond<L: NormalLaw, const FRICTION: bool, const ROLLING: bool, const DAMPING: bool>(
        &mut self,
        model: RollingModel,
        step: f64,
    ) {
        let [a, b] = self.radius.map(WideF64x4::from);
        let [inverse_i, inverse_j] = self.inverse_mass.map(WideF64x4::from);
        let offset = self.offset.load();
        let distance = offset.norm();
        let overlap = a + b - distance;
        let half = WideF64x4::splat(0.5) * overlap;
        let (arm_i, arm_j) = (a - half, b - half);
        let mut contact = Contact {
            normal: offset * (WideF64x4::ONE / distance),
            velocity: self.velocity.load(),
            forecast: self.forecast.load(),
            spin: Vector3::zeros(),
            turning: Vector3::zeros(),
            radius: a * b / (a + b),
            inverse_mass: inverse_i + inverse_j,
            inverse_moment: WideF64x4::ZERO,
            slowing: self.slowing.into(),
        };
        if FRICTION || ROLLING {
            let (angular_i, angular_j) = (self.angular[0].load(), self.angular[1].load());
            contact.spin = angular_i * arm_i + angular_j * arm_j;
            contact.turning = angular_i - angular_j;
            contact.inverse_moment = inverse_i / (a * a) + inverse_j / (b * b);
        }
        let mut history = History {
            spring: self.spring.load(),
            contact_radius: self.contact_radius.into(),
            rolling: self.rolling.load(),
        };
        let pair = self.pair.map(WideF64x4::from);
        let step = WideF64x4::splat(step);
        let elastic = L::elastic(overlap, contact.radius, &pair, self.work.into());
        let response =
            respond::<_, L, FRICTION, ROLLING, DAMPING>(&contact, &elastic, &pair, model, step, &mut history);
        self.force = Vectors::store(response.force);
        self.depth = (overlap / a.simd_min(b)).into_arr();
        if DAMPING || ROLLING {
            self.damping = response.damping.into_arr();
        }
        if FRICTION {
            self.spring = Vectors::store(history.spring);
            self.contact_radius = history.contact_radius.into_arr();
        }
        if ROLLING {
            self.rolling = Vectors::store(history.rolling);
        }
        if FRICTION || ROLLING {
            self.torque[0] = Vectors::store(response.twist * arm_i + response.rolling);
            self.torque[1] = Vectors::store(response.twist * arm_j - response.rolling);
        }
    }
}
