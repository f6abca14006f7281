//! Tools that know nothing of fields: the processor's vectors, polynomials, memory of threads, a stopwatch.

pub(crate) mod chebyshev;
pub(crate) mod processor;
pub(crate) mod scratch;
pub(crate) mod stopwatch;
