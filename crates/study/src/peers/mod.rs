//! Programs of others that compute the same, in a Python environment of their own. The scripts that drive
//! them stand in `peers/` of this crate.

mod environment;
mod field;
#[cfg(feature = "speed")]
mod install;
mod settings;

pub use environment::{Environment, Script, read_numbers, write_numbers};
pub use field::{PeerProblem, measure_field};
#[cfg(feature = "speed")]
pub use install::{PACKAGES, Peers};
pub use settings::{SHARES, fastest, pppm_sweep};
