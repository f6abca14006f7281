//! Radii of a far level, which are chosen for the cells and the grains.

use serde::{Deserialize, Serialize};

/// Radii of the far level over a field solver's mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FarRadii {
    /// Radius of the clouds [m].
    pub cloud_m: f64,
    /// Factor of the radii up to which ghosts are felt, which are so many cells: ghosts stand for charges
    /// near walls that hide places of the mesh.
    pub of_ghosts: f64,
}

impl FarRadii {
    /// Radii that are larger, or smaller.
    pub(crate) fn times(self, factor: f64) -> Self {
        Self { cloud_m: factor * self.cloud_m, of_ghosts: factor * self.of_ghosts }
    }
}
