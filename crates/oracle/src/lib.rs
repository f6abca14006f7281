//! Exact and manufactured solutions, norms, observed order; shares no code with what it judges.
