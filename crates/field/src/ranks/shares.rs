//! Even shares of things that are numbered.

use std::ops::Range;

/// The share of a rank in `things`, when `count` ranks share them in order. Shares differ by one thing at
/// most; with more ranks than things some have none.
pub(crate) fn share(things: usize, rank: usize, count: usize) -> Range<usize> {
    things * rank / count..things * (rank + 1) / count
}
