//! Commands of `amberfield`, one file for each.

mod convert;
mod doctor;
mod explain;
mod field;
mod keys;
mod new;
mod run;
#[cfg(feature = "plots")]
mod study;
mod tune;

pub(crate) use convert::convert;
pub(crate) use doctor::doctor;
pub(crate) use explain::explain;
pub(crate) use field::field;
pub(crate) use keys::keys;
pub(crate) use new::new;
pub(crate) use run::run;
#[cfg(feature = "plots")]
pub(crate) use study::study;
pub(crate) use tune::tune;
