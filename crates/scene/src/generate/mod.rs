//! Generator of particles: a random fill without overlaps, with sizes and charges from distributions and one
//! seed.

mod distribution;
mod fill;
mod grid;
mod region;
mod relax;
mod spec;
mod surfaces;

pub(crate) use distribution::{
    ChargeDistribution, ChargeStream, RadiusDistribution, RadiusStream, read_charges_of_feed, read_radii,
};
pub(crate) use region::read_volume;
pub(crate) use spec::{GenerateContext, generate};
