//! Cost of the pieces of an evaluation, in nanoseconds on a reference machine; only ratios matter.

/// A pair within the cut-off in single and in double precision, the neighbours beyond it that are
/// looked at included.
pub(super) const PAIR: [f64; 2] = [1.5, 2.8];
/// A pair of the direct sum.
pub(super) const ALL_PAIRS: f64 = 0.9;
/// Spreading and gathering, per node of a window.
pub(super) const NODE: f64 = 0.2;
/// Transforms there and back, per padded node and factor log₂(nodes).
pub(super) const TRANSFORM: f64 = 0.9;
/// Sorting, looking for partners, polynomials of the window and summing, per particle.
pub(super) const PARTICLE: f64 = 160.0;
