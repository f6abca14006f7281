//! Scene file to validated description, one file per section.

mod command;
mod description;
mod domain;
mod electric_field;
mod gas;
pub(crate) mod limits;
pub(crate) mod materials;
mod others;
mod particles;
mod read;
pub(crate) mod source;
mod time;
mod together;
mod walls;

pub use description::{
    ChargeTransferSettings, ElectricFieldSettings, OutputSettings, Purpose, Scene, SolverLoss, SolverSettings,
};
pub use read::{parse_scene, read_scene};
