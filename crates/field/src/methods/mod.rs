//! Combinations of levels: each method computes the field of the charges in its own way, behind one trait.

pub(crate) mod cutoff;
pub(crate) mod direct;
pub(crate) mod kolehmainen;
pub(crate) mod method;
pub(crate) mod over_surfaces;
pub(crate) mod p3m;
pub(crate) mod p3m_over_ranks;
pub(crate) mod p3m_parameters;
