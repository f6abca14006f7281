//! The header of every message, and the unit of its payload.

use crate::WireError;
use iceoryx2::prelude::ZeroCopySend;
use std::mem::{align_of, offset_of, size_of};

/// Raised with every change of a message.
pub const PROTOCOL_VERSION: u32 = 4;
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
}

impl MessageKind {
    fn of(number: u32) -> Result<Self, WireError> {
        use MessageKind::{Charges, Checkpoint, End, Fields, Flow, Grains, Mesh, Restore, State};
        [Mesh, Charges, Fields, Checkpoint, State, End, Grains, Flow, Restore]
            .into_iter()
            .find(|kind| *kind as u32 == number)
            .ok_or(WireError::Kind(number))
    }
}

/// Content of a section; vectors are three `f64`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Section {
    /// Text, UTF-8.
    Text = 1,
    /// Positions of the charges [m].
    Positions = 2,
    /// Charges [C].
    Charges = 3,
    /// Positions of the image charges [m].
    ImagePositions = 4,
    /// Image charges [C].
    ImageCharges = 5,
    /// Potentials [V] or outward slopes [V/m], by boundary face.
    Boundary = 6,
    /// Scalars of the question for the far field: one [`crate::payloads::FarQuestion`].
    FarQuestion = 7,
    /// Potential at the cells' centres [V].
    Potential = 8,
    /// E at the cells' centres [V/m].
    Field = 9,
    /// Cell of each charge (`u64`), `u64::MAX` where it is another rank's; empty unless the source is by
    /// cell.
    Cells = 10,
    /// Scalars of the answer with the far field: one [`crate::payloads::FarAnswer`].
    FarAnswer = 11,
    /// Cell centres [m].
    Centres = 12,
    /// Cell volumes [m³].
    Volumes = 13,
    /// Place of each cell's first face (`u64`), one more than there are cells.
    FirstFace = 14,
    /// Outward unit normal of each cell's faces.
    FaceNormals = 15,
    /// Scalar products of normals and face centres [m].
    FaceOffsets = 16,
    /// Neighbour beyond each face (`i64`): cell c of all ranks as c, boundary face b of this rank as −1 − b.
    FaceNeighbours = 17,
    /// Vectors to add to the neighbours' coordinates [m].
    FaceShifts = 18,
    /// Faces on the boundary: a [`crate::payloads::BoundaryFace`] each.
    BoundaryFaces = 19,
    /// Outline of the mesh: one [`crate::payloads::MeshOutline`].
    MeshOutline = 20,
    /// Potential at the cells' centres of all ranks to start the linear solver from [V]; absent: it starts
    /// where it is.
    Guess = 21,
    /// Scalars of the question for the flow: one [`crate::payloads::FlowQuestion`].
    FlowQuestion = 22,
    /// Void fraction by cell of all ranks.
    VoidFraction = 23,
    /// Drag coefficient K by cell of all ranks [kg/(m³ s)]: the gas feels S − K u.
    DragCoefficient = 24,
    /// Source S of momentum by cell of all ranks [N/m³].
    MomentumSource = 25,
    /// Velocity u at the cells' centres [m/s].
    Velocity = 26,
    /// Pressure gradient ∇p at the cells' centres [Pa/m], without the gas's own weight.
    PressureGradient = 27,
    /// Divergence ∇·τ of the viscous stress at the cells' centres [N/m³]; empty unless wanted.
    ViscousForce = 28,
    /// Vorticity ∇ × u at the cells' centres [1/s]; empty unless wanted.
    Vorticity = 29,
    /// Scalars of the answer with the flow: one [`crate::payloads::FlowAnswer`].
    FlowAnswer = 30,
    /// State of the flow, numbers whose meaning is the solver's own. Sent back they are those of all ranks,
    /// one after the other.
    FlowState = 31,
    /// Number of each rank's numbers in the state of the flow (`u64`).
    FlowStateSizes = 32,
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
