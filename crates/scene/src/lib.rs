//! Scene file to validated description; reads particles and STL, writes VTK, CSV and checkpoints.
//!
//! Every bad value is refused with its place, its key, itself and what to do: see [`SceneError`].
#![forbid(unsafe_code)]

mod error;
mod generate;
mod particles;
mod scene;
mod stl;
mod tree;
mod write;

pub use error::SceneError;
pub use scene::{
    ChargeTransferSettings, ElectricFieldSettings, OutputSettings, Purpose, Scene, SolverLoss,
    SolverSettings, parse_scene, read_scene,
};
pub use write::{
    Cell, FacetCell, FieldColumns, FieldComponents, FieldReport, FieldReportSeconds, History, PvdSeries,
    read_checkpoint, read_table, write_atomically, write_checkpoint, write_facets_vtu, write_field_csv,
    write_json, write_particles_csv, write_table, write_text, write_vtu,
};
