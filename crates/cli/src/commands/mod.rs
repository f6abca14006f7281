//! One command, one file.

mod doctor;
mod explain;
mod field;
mod run;

pub(crate) use doctor::doctor;
pub(crate) use explain::explain;
pub(crate) use field::field;
pub(crate) use run::run;
