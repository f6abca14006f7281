//! The header of every message, and the unit of its payload.

use crate::error::WireError;
use iceoryx2::prelude::ZeroCopySend;
use std::mem::{align_of, offset_of, size_of};

/// Raised with every change of a message.
pub const PROTOCOL_VERSION: u32 = 9;
/// Largest number of sections of a message.
pub(crate) const MOST_SECTIONS: usize = 20;

/// Unit of payloads: a cache line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ZeroCopySend)]
#[repr(C)]
#[repr(align(64))]
#[type_name("amberfield Block64 1")]
pub struct Block64 {
    /// Words, whose meaning the sections give.
    pub words: [u64; 8],
}

/// Subject of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum MessageKind {
    /// Field to DEM, once per rank: the rank's part of the mesh.
    Mesh = 1,
    /// DEM to field: the question for the far field, with charges and boundary data.
    Charges = 2,
    /// Field to DEM: the far field.
    Fields = 3,
    /// DEM to field: send the state of the flow.
    Checkpoint = 4,
    /// Field to DEM: the state of a rank's part of the flow; empty after one was taken in.
    State = 5,
    /// Either way: this was the last message; a text says why.
    End = 6,
    /// DEM to field: the question for the flow after an interval, with void fraction and exchange of
    /// momentum.
    Grains = 7,
    /// Field to DEM: the flow at the end of the interval.
    Flow = 8,
    /// DEM to field: take in the state of the flow.
    Restore = 9,
    /// Field to DEM: this was the last message, because the case or the scene is wrong; a text says how.
    Refusal = 10,
    /// DEM to field: the question for potentials that change, at some times.
    Times = 11,
    /// Field to DEM: the potentials at these times.
    Potentials = 12,
}

impl MessageKind {
    fn of(number: u32) -> Result<Self, WireError> {
        use MessageKind::{Charges, Checkpoint, End, Fields, Flow, Grains};
        use MessageKind::{Mesh, Potentials, Refusal, Restore, State, Times};
        let questions = [Charges, Checkpoint, Grains, Restore, Times];
        let answers = [Mesh, Fields, State, Flow, Potentials];
        [&questions[..], &answers, &[End, Refusal]]
            .concat()
            .into_iter()
            .find(|kind| *kind as u32 == number)
            .ok_or(WireError::Kind(number))
    }
}

/// Entry of a header that says where a section lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ZeroCopySend)]
#[repr(C)]
#[type_name("amberfield SectionEntry 1")]
pub struct SectionEntry {
    /// A [`Section`].
    pub section: u32,
    /// Size of an element [bytes].
    pub element: u32,
    /// Number of elements.
    pub count: u64,
    /// Block in which it begins.
    pub first_block: u64,
}

/// Header that stands before every payload.
#[derive(Clone, Copy, Debug, Default, PartialEq, ZeroCopySend)]
#[repr(C)]
#[type_name("amberfield Header 1")]
pub struct Header {
    /// [`PROTOCOL_VERSION`] of the sender.
    pub version: u32,
    /// A [`MessageKind`].
    pub kind: u32,
    /// Number of the run.
    pub run: u64,
    /// Number of the solve that a message asks for or answers.
    pub solve: u64,
    /// Rank of the sender among the field processes.
    pub rank: u32,
    /// Number of field processes.
    pub ranks: u32,
    /// Number of sections used.
    pub section_count: u64,
    /// Entries of the sections, of which the first `section_count` are used.
    pub sections: [SectionEntry; MOST_SECTIONS],
}

impl Header {
    /// Makes a header without sections.
    #[must_use]
    pub fn new(kind: MessageKind, run: u64, solve: u64) -> Self {
        Self {
            version: PROTOCOL_VERSION,
            kind: kind as u32,
            run,
            solve,
            rank: 0,
            ranks: 1,
            section_count: 0,
            sections: [SectionEntry::default(); MOST_SECTIONS],
        }
    }

    /// Returns the kind of message, once version and run are those expected.
    ///
    /// # Errors
    /// Another version, another run, an unknown kind.
    pub fn check(&self, run: u64) -> Result<MessageKind, WireError> {
        check_version(self.version)?;
        if self.run != run {
            return Err(WireError::Run { theirs: self.run, ours: run });
        }
        MessageKind::of(self.kind)
    }
}

/// Refuses a peer of another version.
///
/// # Errors
/// Another version than [`PROTOCOL_VERSION`].
pub fn check_version(theirs: u32) -> Result<(), WireError> {
    if theirs == PROTOCOL_VERSION {
        Ok(())
    } else {
        Err(WireError::Version { theirs, ours: PROTOCOL_VERSION })
    }
}

const _: () = {
    assert!(size_of::<Block64>() == 64 && align_of::<Block64>() == 64);
    assert!(size_of::<SectionEntry>() == 24);
    assert!(size_of::<Header>() == 40 + 24 * MOST_SECTIONS && align_of::<Header>() == 8);
    assert!(
        offset_of!(Header, run) == 8 && offset_of!(Header, rank) == 24 && offset_of!(Header, sections) == 40
    );
};
