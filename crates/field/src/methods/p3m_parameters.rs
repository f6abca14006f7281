//! Parameters of p3m.

use crate::levels::far::FarRadii;
use crate::levels::grid::level::GridParameters;
use crate::levels::near::NearParameters;
use amberfield_laws::kaiser_bessel_cloud::Cloud;
use serde::{Deserialize, Serialize};

/// Parameters of the splitting.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct P3mParameters {
    /// Near cut-off radius r_c, where the clouds end [m].
    pub cutoff_m: f64,
    /// Shape β of the clouds.
    pub cloud_shape: f64,
    /// Largest node spacing of the grid [m].
    pub spacing_m: f64,
    /// Order of the window between charges and nodes, 4 to 8.
    pub order: usize,
    /// Shape β of the window.
    pub window_shape: f64,
    /// Error of the near kernel's polynomials over the cloud's value at its centre.
    pub kernel_accuracy: f64,
    /// Radii of the far level over a field solver's mesh; `None` without one.
    #[serde(default)]
    pub far: Option<FarRadii>,
}

impl P3mParameters {
    pub(crate) fn near(&self) -> NearParameters {
        NearParameters {
            cutoff_m: self.cutoff_m,
            cloud_shape: self.cloud_shape,
            kernel_accuracy: self.kernel_accuracy,
        }
    }

    pub(crate) fn grid(&self) -> GridParameters {
        GridParameters {
            spacing_m: self.spacing_m,
            order: self.order,
            window_shape: self.window_shape,
            cloud: self.cloud(),
        }
    }

    pub(crate) fn cloud(&self) -> Cloud {
        Cloud { radius: self.cutoff_m, shape: self.cloud_shape }
    }
}
