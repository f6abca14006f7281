//! Settings of charge transfer on contact.

use serde::{Deserialize, Serialize};

/// Charge transfer on contact; each refinement is off unless asked for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChargeTransfer {
    /// Cut-off distance δ of the transfer [m].
    pub cutoff_m: f64,
    /// Whether charge moves only beyond the contact's previous largest area.
    pub beyond_previous_maximum: bool,
    /// Breakdown field [V/m].
    pub breakdown_field_v_m: Option<f64>,
    /// `v_real/v_soft` in the area factor, where areas are scaled towards the real stiffness.
    pub stiffness_correction: Option<f64>,
}

impl ChargeTransfer {
    /// Plain transfer with a cut-off distance [m].
    #[must_use]
    pub fn new(cutoff_m: f64) -> Self {
        Self {
            cutoff_m,
            beyond_previous_maximum: false,
            breakdown_field_v_m: None,
            stiffness_correction: None,
        }
    }
}
