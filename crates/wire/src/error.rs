//! Faults of messages.

use crate::section::Section;

/// Fault of a message.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WireError {
    /// The peer speaks another version.
    #[error(
        "the peer speaks version {theirs} of the protocol, this program {ours}; build both from the same \
         source"
    )]
    Version {
        /// Version in the message.
        theirs: u32,
        /// Version of this program.
        ours: u32,
    },
    /// The message belongs to another run.
    #[error("a message of run {theirs:016x} arrived in run {ours:016x}; give every run a name of its own")]
    Run {
        /// Run in the message.
        theirs: u64,
        /// Run that the message is expected of.
        ours: u64,
    },
    /// A kind of message that this version does not know.
    #[error("message of the unknown kind {0}")]
    Kind(u32),
    /// A message that was not expected now.
    #[error("unexpected message of kind {kind} about solve {solve} from rank {rank} of {ranks}")]
    Unexpected {
        /// Kind in the message.
        kind: u32,
        /// Solve in the message.
        solve: u64,
        /// Rank in the message.
        rank: u32,
        /// Ranks in the message.
        ranks: u32,
    },
    /// A section is missing.
    #[error("the message has no section {0:?}")]
    Missing(Section),
    /// A section has elements of another size.
    #[error("section {section:?} has elements of {theirs} bytes, expected {ours}")]
    Element {
        /// The section.
        section: Section,
        /// Size in the message.
        theirs: u32,
        /// Size expected.
        ours: usize,
    },
    /// A section has another number of elements.
    #[error("section {section:?} has {theirs} elements, expected {ours}")]
    Count {
        /// The section.
        section: Section,
        /// Number in the message.
        theirs: usize,
        /// Number expected.
        ours: usize,
    },
    /// A section reaches beyond the payload.
    #[error(
        "section {section:?} of {count} elements from block {first_block} on reaches beyond the payload of \
         {blocks} blocks"
    )]
    Bounds {
        /// The section.
        section: Section,
        /// Number of elements.
        count: u64,
        /// Block in which the section begins.
        first_block: u64,
        /// Blocks of the payload.
        blocks: usize,
    },
    /// A number that cannot be used.
    #[error("element {place} of section {section:?} is {value}: not a number that can be used")]
    Number {
        /// The section.
        section: Section,
        /// Number of the element.
        place: usize,
        /// Value in the message.
        value: f64,
    },
    /// A field of a structure that cannot be used.
    #[error("{name} of section {section:?} is {value}: not a number that can be used")]
    Field {
        /// Section that holds the structure.
        section: Section,
        /// Name of the field.
        name: &'static str,
        /// Value in the message.
        value: f64,
    },
    /// A number that names nothing.
    #[error("element {place} of section {section:?} is {value}, which is not below {count}")]
    Index {
        /// The section.
        section: Section,
        /// Number of the element.
        place: usize,
        /// Value in the message.
        value: u64,
        /// Count that it must be below.
        count: usize,
    },
    /// Bytes that hold no message.
    #[error("{0} bytes arrived, which are no message")]
    Letter(usize),
}
