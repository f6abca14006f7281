//! Result files. A complete file is written under a temporary name in the same folder and then renamed.

mod atomic;
mod checkpoint;
mod field_csv;
mod history;
mod lammps;
mod particles_csv;
mod pvd;
mod snapshot;
mod vtu;

pub use atomic::{read_table, write_atomically, write_json, write_rows, write_table, write_text};
pub use checkpoint::{read_checkpoint, read_checkpoint_of_any, write_checkpoint};
pub use field_csv::{FieldColumns, FieldComponents, FieldReport, FieldReportSeconds, write_field_csv};
pub use history::{HistoryFile, HistoryValue};
pub use particles_csv::write_particles_csv;
pub use pvd::PvdSeries;
pub use snapshot::write_snapshot;
pub use vtu::{ChargedSquare, WallFace, write_charge_vtu, write_vtu, write_walls_vtu};
