//! Validation of a scene file, one source file for each section.

mod command;
mod course;
mod description;
mod domain;
mod electric_field;
mod feeds;
mod filled;
mod fixed;
mod gas;
mod input;
mod key_places;
mod others;
mod outlets;
mod pairs;
mod particles;
mod physics;
mod read;
mod remesh;
mod time;
mod time_table;
mod together;
mod unusual;
mod wall_field;
mod wall_motion;
mod walls;

pub use description::{
    ChargeTransferSettings, ElectricFieldSettings, Filled, OpenFoamSettings, OutputSettings, Purpose, Scene,
    SolverLoss,
};
pub use input::SceneInput;
pub use physics::Physics;
pub(crate) use physics::told;
pub use read::{SceneOutline, parse_field_settings, parse_scene, read_outline, read_scene};
