//! What is measured: one section, one file, with its rows and its part of the page.

pub(crate) mod charging;
pub(crate) mod coupling;
pub(crate) mod dem;
pub(crate) mod field;
pub(crate) mod gas;
pub(crate) mod kernel;
pub(crate) mod open;
mod peak;
pub(crate) mod rates;
pub(crate) mod scaling;
