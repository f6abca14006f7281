//! Tools that know nothing of fields: the processor's vectors, polynomials, Bessel functions, memory of
//! threads, a stopwatch.

pub(crate) mod bessel;
pub(crate) mod chebyshev;
pub(crate) mod gmres;
pub(crate) mod processor;
pub(crate) mod scratch;
pub(crate) mod stopwatch;
