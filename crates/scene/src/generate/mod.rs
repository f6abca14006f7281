//! Grains from a rule: a random fill without overlaps, sizes and charges from distributions, one seed.

mod distribution;
mod fill;
mod grid;
mod region;
mod relax;
mod spec;

pub(crate) use spec::{GenerateContext, generate};
