//! Messages between the DEM process and the field process, with their layout asserted on both sides.
//!
//! A message is a [`Header`] and a payload of [`Block64`]s. The header says what kind of message it is and
//! where its [`Section`]s lie: flat arrays of numbers, of vectors or of the structures in [`payloads`], each
//! beginning on a block. A new quantity is a new section, or a new field of such a structure. Whoever changes
//! anything here raises [`PROTOCOL_VERSION`].

mod error;
mod header;
mod layout;
mod letter;
pub mod payloads;
mod section;

pub use error::WireError;
pub use header::{Block64, Header, MessageKind, PROTOCOL_VERSION, SectionEntry, check_version};
pub use layout::{Element, Layout, Sections};
pub use letter::Letter;
pub use section::Section;
