//! Reader of scene files, and reader and writer of all other files: particles, STL, VTK, CSV, checkpoints.
//!
//! A scene file becomes a validated [`Scene`]. A bad value is refused with its place, its key, the value and
//! what to do: see [`SceneError`].
#![forbid(unsafe_code)]

mod checkpoint;
mod error;
pub mod files;
mod generate;
pub mod keys;
mod limits;
mod materials;
mod particles;
mod poly_mesh;
mod scene;
mod source;
mod stl;
mod table;
mod tree;
mod weld;
mod write;

pub use checkpoint::{SavedGrains, checkpoints};
pub use error::SceneError;
pub use particles::{Given, Snapshot, SnapshotBox, SnapshotOptions, Units};
pub use scene::{
    ChargeTransferSettings, ElectricFieldSettings, Filled, OpenFoamSettings, OutputSettings, Physics,
    Purpose, Scene, SceneInput, SceneOutline, SolverLoss, parse_field_settings, parse_scene, read_outline,
    read_scene,
};
pub use table::check_keys;
pub use write::{
    ChargedSquare, FieldColumns, FieldComponents, FieldReport, FieldReportSeconds, HistoryFile, HistoryValue,
    PvdSeries, WallFace, read_checkpoint, read_checkpoint_of_any, read_table, write_atomically,
    write_charge_vtu, write_checkpoint, write_field_csv, write_json, write_particles_csv, write_rows,
    write_snapshot, write_table, write_text, write_vtu, write_walls_vtu,
};
