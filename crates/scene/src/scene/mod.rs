//! Validation of a scene file, one source file for each section.

mod command;
mod description;
mod domain;
mod electric_field;
mod gas;
mod input;
mod others;
mod particles;
mod physics;
mod read;
mod time;
mod together;
mod unusual;
mod walls;

pub use description::{
    ChargeTransferSettings, ElectricFieldSettings, OpenFoamSettings, OutputSettings, Purpose, Scene,
    SolverLoss,
};
pub use input::SceneInput;
pub use physics::Physics;
pub(crate) use physics::told;
<<<<<<< HEAD
pub use input::SceneInput;
pub use read::{parse_field_settings, parse_scene, read_material_names, read_scene};
=======
pub use read::{parse_field_settings, parse_scene, read_scene};
>>>>>>> 0223fae (A Python package: fields, runs and snapshots as numpy arrays, with the command in its wheel)
