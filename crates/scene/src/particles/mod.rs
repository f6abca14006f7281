//! Grains from files: tables in text, and snapshots of other programs.

mod columns;
mod dump;
mod dump_header;
mod grains;
mod names;
mod open;
mod quantity;
mod row;
mod snapshot;
mod text_table;
mod units;
mod vtk_blocks;
mod vtk_legacy;
mod vtk_numbers;
mod vtk_points;
mod vtk_xml;
mod words;
mod xml_tags;

pub(crate) use grains::GrainContext;
pub(crate) use names::MaterialNames;
pub(crate) use open::{read_charges, read_grains};
pub(crate) use snapshot::{FileChoices, ReadParticles};
pub use snapshot::{Given, Snapshot, SnapshotBox, SnapshotOptions};
pub(crate) use units::Factors;
pub use units::Units;
