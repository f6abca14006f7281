//! What travels between the DEM process and the field process, with its layout asserted on both sides.
//!
//! A message is a [`Header`] and a payload of [`Block64`]s. The header says what kind of message it is and
//! where its [`Section`]s lie: flat arrays of numbers, of vectors or of the structures in [`payloads`], each
//! beginning on a block. A new quantity is a new section, or a new field of such a structure. Whoever changes
//! anything here raises [`PROTOCOL_VERSION`].

mod error;
mod header;
pub mod payloads;
mod sections;

pub use error::WireError;
pub use header::{Block64, Header, MessageKind, PROTOCOL_VERSION, Section, SectionEntry, check_version};
pub use sections::{Element, Layout, Sections};
