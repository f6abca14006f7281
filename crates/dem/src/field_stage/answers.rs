//! Answers of the field stage to charge transfer and the guards, and what they tell it.

use super::FieldStage;
use crate::motion::grains::Original;
use amberfield_core::{CouplingInterval, Vector3};

impl FieldStage {
    /// Permittivity of the medium [F/m].
    pub(crate) fn permittivity(&self) -> f64 {
        self.settings.permittivity.absolute()
    }

    /// E at the last evaluation at what was beside the grains [V/m].
    pub(crate) fn beside(&self) -> &[Vector3<f64>] {
        &self.values.e[self.members.index.len()..]
    }

    /// E at a grain now, on its line [V/m].
    pub(crate) fn at(&self, grain: usize) -> Vector3<f64> {
        self.forecast.at(grain, self.control.age as f64)
    }

    /// Takes the new charges of grains; `charge` is by the set-up's order [C].
    pub(crate) fn recharge(
        &mut self,
        grains: impl Iterator<Item = usize>,
        original: &[Original],
        charge: &[f64],
    ) {
        for grain in grains {
            let of = original[grain].index();
            if self.member[of] {
                self.forecast.recharge(grain, charge[of]);
            }
        }
    }

    /// Whether E is evaluated as often as its error asks.
    pub(crate) fn is_automatic(&self) -> bool {
        self.settings.coupling_interval == CouplingInterval::Auto
    }
}
