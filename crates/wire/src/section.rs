//! The sections that a message may have.

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
    /// Cell of each charge (`u64`), empty unless charges are spread over their cells: in a question the
    /// number among all ranks' cells, in an answer that among the rank's, `u64::MAX` where it is another's.
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
    /// Place of each boundary face's first corner (`u64`), one more than there are boundary faces.
    FirstCorner = 33,
    /// Corners of the boundary faces, in order around each, right-handed about its normal [m].
    Corners = 34,
    /// Patches of the mesh, UTF-8: lines of a name, a blank and a type; the same for all ranks.
    Patches = 35,
    /// Density of the far field's source by cell of all ranks, besides the charges' clouds [C/m³]; absent:
    /// none.
    SourceDensity = 36,
    /// Corners of this rank's faces, each once [m]; empty unless a gas flows between grains.
    Points = 37,
    /// Place of the first corner of each entry of the arrays by face (`u64`), and at last the number of
    /// corners; empty unless a gas flows between grains.
    FirstFaceCorner = 38,
    /// Corners of the faces in order around each, either way, as places among the points (`u32`).
    FaceCorners = 39,
    /// Patches whose potential changes with time, by their places among all (`u64`); the same for all ranks.
    ChangingPatches = 40,
    /// Times at which the potentials of these patches are asked for [s].
    Times = 41,
    /// Potentials of these patches at the times [V]: patch by patch, all times of each; no number where it is
    /// not known.
    PatchPotentials = 42,
}
