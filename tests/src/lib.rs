//! Helpers of tests that run the `amberfield` binary in a folder of their own.

pub mod any_bytes;
pub mod foam_beds;
mod foam_box;
pub mod foam_case;
pub mod foam_refinement;
mod gas_box;
pub mod packing;
mod workbench;

pub use foam_box::{DEADLINE, FoamBox};
pub use gas_box::{GAS_SCENE, gas_box};
pub use workbench::{Answer, CsvTable, Workbench};
