//! Places that walls keep grains from.

use crate::contacts::walls::{ContactWalls, Sticking};
use crate::error::DemError;
use amberfield_core::{Vector3, Wall};

/// Walls of a scene, for those who ask where they stand.
#[derive(Debug)]
pub struct WallCover(ContactWalls);

impl WallCover {
    /// Takes the walls of a scene.
    ///
    /// # Errors
    /// The first wall without a shape.
    pub fn new(walls: &[Wall]) -> Result<Self, DemError> {
        // Places are looked at where they are, without periodic images.
        ContactWalls::new(walls, [[0.0; 3]; 32], false, Sticking::default())
            .map(Self)
            .map_err(DemError::Setup)
    }

    /// Whether a wall stands within a distance [m] of a place [m], or a plane between the place and the
    /// grains.
    #[must_use]
    pub fn covers(&self, place: Vector3<f64>, distance: f64) -> bool {
        self.0.covers(place, distance)
    }
}
