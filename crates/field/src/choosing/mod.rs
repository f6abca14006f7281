//! The choice of p3m's parameters from a tolerance and the charges, by an error model, timing and a
//! measurement.

pub(crate) mod candidates;
pub(crate) mod charge_statistics;
pub(crate) mod choice;
mod cost;
pub(crate) mod error_model;
pub(crate) mod over_mesh;
pub(crate) mod over_ranks;
pub(crate) mod splittings;
pub(crate) mod trials;
pub(crate) mod tuner;
