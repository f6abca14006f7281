//! Grains that come while a run goes on.

use crate::particles::Particles;
use crate::triangle_mesh::TriangleMesh;
use crate::volume::Volume;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Region in which grains of a feed appear; lengths in [m].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FeedRegion {
    /// Volume in which grains lie as a whole.
    Volume(Volume),
    /// Face through which grains come, as a whole and with their velocity.
    Face(TriangleMesh),
}

impl FeedRegion {
    /// Lower and upper corner of the box around the region [m]; `None` for a face without triangles.
    #[must_use]
    pub fn bounds(&self) -> Option<[Vector3<f64>; 2]> {
        match self {
            Self::Volume(volume) => Some(volume.bounds()),
            Self::Face(mesh) => mesh.bounds(),
        }
    }
}

/// Behaviour of a feed that finds no place for a grain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OnBlocked {
    /// The grain waits, and is owed.
    #[default]
    Wait,
    /// The run ends.
    Stop,
}

/// Feed of grains.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Feed {
    /// Name, which no other feed has.
    pub name: String,
    /// Region in which its grains appear.
    pub region: FeedRegion,
    /// Mean velocity of its grains [m/s].
    pub velocity: Vector3<f64>,
    /// Behaviour where there is no place for a grain.
    pub on_blocked: OnBlocked,
    /// Seed of the places at which grains appear.
    pub seed: u64,
}

/// Feeds of a scene, and all the grains that they bring.
///
/// The order of the grains does not depend on when a run ends: one that ends later has the same grains and
/// more of them at the end of the arrays.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Feeds {
    /// Feeds, sorted by name.
    pub list: Vec<Feed>,
    /// Grains in the order in which they are due; their positions mean nothing yet.
    pub grains: Particles,
    /// Time at which each grain is due [s], ascending.
    pub due_s: Vec<f64>,
    /// Number of each grain's feed.
    pub feed: Vec<u16>,
}

impl Feeds {
    /// Whether there is no feed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }
}
