//! Tree of a scene's text, in which each value knows its place.

mod nearest;
mod node;
mod overrides;
mod parse;
mod range;

pub(crate) use nearest::nearest;
pub(crate) use node::{Entries, Node, Origin, Place, Value};
pub(crate) use overrides::apply_overrides;
pub(crate) use parse::parse_document;
pub(crate) use range::Range;
