//! Tree of a scene's text, in which each value knows its place.

mod node;
mod overrides;
mod parse;
mod range;
mod table;

pub(crate) use node::{Entries, Node, Place, Value};
pub(crate) use overrides::apply_overrides;
pub(crate) use parse::parse_document;
pub(crate) use range::Range;
pub(crate) use table::{SceneTable, nearest};
