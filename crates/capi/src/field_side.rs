//! The field side: open the run, send the mesh, wait, take density and boundary data, answer, close.

use crate::field_question::AmberfieldRequest;
use crate::foreign::{close, guarded, slice, slice_mut};
use crate::status::AmberfieldStatus;
use amberfield_coupling::{CouplingError, FieldSide, MeshPart, Question, Reply};
use amberfield_wire::Letter;
use amberfield_wire::payloads::{BoundaryFace, MeshOutline};
use std::ffi::{CStr, CString, c_char};

/// One rank of a field process.
#[derive(Debug)]
pub struct AmberfieldField {
    side: Option<FieldSide>,
    /// Name of the run.
    pub(crate) run: CString,
    /// Letter that was handed out last.
    pub(crate) letter: Option<Letter>,
    error: CString,
}

impl AmberfieldField {
    /// A handle of a side, or of the reason why there is none.
    pub(crate) fn opened(open: impl FnOnce() -> Result<FieldSide, CouplingError>) -> *mut Self {
        let empty = CString::default();
        let mut field = Box::new(Self { side: None, run: empty.clone(), letter: None, error: empty });
        let Self { side, run, error, .. } = &mut *field;
        guarded(error, || {
            let opened = open().map_err(|error| error.to_string())?;
            *run = CString::new(opened.run()).unwrap_or_default();
            *side = Some(opened);
            Ok(AmberfieldStatus::Ok)
        });
        Box::into_raw(field)
    }
}

/// Mesh of one rank of a field process. Vectors are three doubles each; lengths in m.
#[repr(C)]
#[derive(Debug)]
pub struct AmberfieldMesh {
    /// Box of all ranks' cells, periodic axes, and where this rank's cells are among all.
    pub outline: MeshOutline,
    /// Boundary faces of lower ranks.
    pub first_boundary: u64,
    /// Cells of this rank.
    pub cells: u64,
    /// Entries of the arrays by face: every inner face once for each of its cells.
    pub faces: u64,
    /// Boundary faces of this rank.
    pub boundary: u64,
    /// Corners of this rank's boundary faces; one that faces share counts once for each.
    pub corners: u64,
    /// Cell centres.
    pub centres: *const f64,
    /// Cell volumes.
    pub volumes: *const f64,
    /// Place of each cell's first face in the arrays by face, and at last the number of their entries.
    pub first_face: *const u64,
    /// Unit normals out of the cell.
    pub face_normals: *const f64,
    /// Scalar products of normals and face centres.
    pub face_offsets: *const f64,
    /// Neighbours beyond the faces: cell c of all ranks as c, boundary face b of this rank as -1 - b.
    pub face_neighbours: *const i64,
    /// Vectors to add to the neighbours' coordinates; 0 unless the face is cyclic.
    pub face_shifts: *const f64,
    /// Boundary faces of this rank, with the conditions there.
    pub boundary_faces: *const BoundaryFace,
    /// Place of each boundary face's first corner, and at last the number of corners.
    pub first_corner: *const u64,
    /// Corners of the boundary faces, in order around each, right-handed about its normal.
    pub corner_points: *const f64,
    /// Patches of the mesh: lines of a name, a blank and a type; the same for all ranks.
    pub patches: *const c_char,
    /// Patches whose potential changes with time, by their lines among the patches; the same for all ranks.
    /// The conditions of their faces say 0 V.
    pub changing_patches: *const u64,
    /// Number of these patches.
    pub changing_count: u64,
    /// Corners of this rank's faces, each once; NULL unless a gas flows between grains.
    pub points: *const f64,
    /// Number of these points, or 0.
    pub point_count: u64,
    /// Place of the first corner of each entry of the arrays by face, and at last the number of corners; NULL
    /// without points.
    pub first_face_corner: *const u64,
    /// Corners of the faces in order around each, either way, as places among the points; NULL without any.
    pub face_corners: *const u32,
}

/// The far field at this rank's cell centres, and how it was found.
#[repr(C)]
#[derive(Debug)]
pub struct AmberfieldFar {
    /// Number of this rank's cells.
    pub cells: u64,
    /// Potential [V].
    pub potential: *const f64,
    /// Electric field [V/m], three doubles each.
    pub e: *const f64,
    /// Iterations of the linear solver.
    pub iterations: u64,
    /// Final residual of the linear solver, relative.
    pub residual: f64,
    /// Time that the linear solver took [s].
    pub seconds: f64,
}

/// Opens a run by its name, for one rank of so many; an empty name is the one run of this user that waits for
/// a solver. The result is never NULL; amberfield_field_error is empty when it worked.
///
/// # Safety
/// `run` is a C string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_open(
    run: *const c_char,
    rank: u32,
    ranks: u32,
) -> *mut AmberfieldField {
    // SAFETY: the caller's promise.
    let run = unsafe { CStr::from_ptr(run) }.to_string_lossy();
    AmberfieldField::opened(|| FieldSide::open(&run, rank, ranks))
}

/// Returns the reason why the last call on a handle failed; empty if it did not. The text is valid until the
/// next call.
///
/// # Safety
/// `field` comes from amberfield_field_open and is not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_error(field: *const AmberfieldField) -> *const c_char {
    // SAFETY: the caller's promise.
    unsafe { &*field }.error.as_ptr()
}

/// Sends this rank's part of the mesh, once, before anything is waited for.
///
/// # Safety
/// `field` comes from amberfield_field_open and is not closed; the mesh's arrays have the lengths that it
/// says, and its patches are a C string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_send_mesh(
    field: *mut AmberfieldField,
    mesh: *const AmberfieldMesh,
) -> AmberfieldStatus {
    // SAFETY: the caller's promise.
    let mesh = unsafe { &*mesh };
    let (cells, faces, boundary) = (mesh.cells as usize, mesh.faces as usize, mesh.boundary as usize);
    let first_count = if mesh.point_count == 0 { 0 } else { faces + 1 };
    // SAFETY: the caller's promise.
    let first_face_corner = unsafe { slice(mesh.first_face_corner, first_count) };
    let face_corners = first_face_corner.last().map_or(0, |&count| count as usize);
    // SAFETY: the caller's promise; three doubles have the layout of an array of three.
    let part = unsafe {
        MeshPart {
            outline: mesh.outline,
            centres: slice(mesh.centres.cast(), cells),
            volumes: slice(mesh.volumes, cells),
            first_face: slice(mesh.first_face, cells + 1),
            face_normals: slice(mesh.face_normals.cast(), faces),
            face_offsets: slice(mesh.face_offsets, faces),
            face_neighbours: slice(mesh.face_neighbours, faces),
            face_shifts: slice(mesh.face_shifts.cast(), faces),
            boundary_faces: slice(mesh.boundary_faces, boundary),
            first_corner: slice(mesh.first_corner, boundary + 1),
            corners: slice(mesh.corner_points.cast(), mesh.corners as usize),
            patches: CStr::from_ptr(mesh.patches).to_bytes(),
            changing: slice(mesh.changing_patches, mesh.changing_count as usize),
            points: slice(mesh.points.cast(), mesh.point_count as usize),
            first_face_corner,
            face_corners: slice(mesh.face_corners, face_corners),
        }
    };
    // SAFETY: the caller's promise.
    unsafe {
        with(field, |side| side.send_mesh(&part, mesh.first_boundary as usize).map(|()| AmberfieldStatus::Ok))
    }
}

/// Waits for the next question; AmberfieldStatus_Over when there will be none.
///
/// # Safety
/// `field` comes from amberfield_field_open and is not closed; `request` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_wait(
    field: *mut AmberfieldField,
    request: *mut AmberfieldRequest,
) -> AmberfieldStatus {
    // SAFETY: the caller's promise.
    unsafe {
        with(field, |side| {
            Ok(match side.wait()? {
                None => AmberfieldStatus::Over,
                Some(question) => {
                    let times = if question == Question::Potentials { side.times()?.len() } else { 0 };
                    *request = AmberfieldRequest::of(question, side.solve(), times as u64);
                    AmberfieldStatus::Ok
                }
            })
        })
    }
}

/// Writes the charge density [C/m^3] at this rank's cell centres. Of charges that are spread over their cells
/// it takes the cells down too, which the reply then names.
///
/// # Safety
/// `field` comes from amberfield_field_open and is not closed; `density` has room for `cells` numbers, this
/// rank's cells.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_density(
    field: *mut AmberfieldField,
    density: *mut f64,
    cells: u64,
) -> AmberfieldStatus {
    // SAFETY: the caller's promise.
    unsafe {
        let density = slice_mut(density, cells as usize);
        with(field, |side| side.density(density).map(|()| AmberfieldStatus::Ok))
    }
}

/// Copies the boundary data of this rank's faces: potentials [V] or outward slopes [V/m], by the face's kind.
///
/// # Safety
/// `field` comes from amberfield_field_open and is not closed; `values` has room for `faces` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_boundary(
    field: *mut AmberfieldField,
    values: *mut f64,
    faces: u64,
) -> AmberfieldStatus {
    // SAFETY: the caller's promise.
    unsafe {
        let values = slice_mut(values, faces as usize);
        with(field, |side| {
            values.copy_from_slice(side.boundary(values.len())?);
            Ok(AmberfieldStatus::Ok)
        })
    }
}

/// Copies the potential [V] to start from to this rank's cells. Where the question has none, which is the
/// usual case, the array stays as it is.
///
/// # Safety
/// `field` comes from amberfield_field_open and is not closed; `potential` has room for `cells` numbers, this
/// rank's cells.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_guess(
    field: *mut AmberfieldField,
    potential: *mut f64,
    cells: u64,
) -> AmberfieldStatus {
    // SAFETY: the caller's promise.
    unsafe {
        let potential = slice_mut(potential, cells as usize);
        with(field, |side| {
            if let Some(guess) = side.guess()? {
                potential.copy_from_slice(guess);
            }
            Ok(AmberfieldStatus::Ok)
        })
    }
}

/// Answers the question for the far field.
///
/// # Safety
/// `field` comes from amberfield_field_open and is not closed; the arrays of `far` have as many entries as it
/// has cells.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_reply(
    field: *mut AmberfieldField,
    far: *const AmberfieldFar,
) -> AmberfieldStatus {
    // SAFETY: the caller's promise.
    unsafe {
        let far = &*far;
        let reply = Reply {
            potential: slice(far.potential, far.cells as usize),
            e: slice(far.e.cast(), far.cells as usize),
            iterations: far.iterations,
            residual: far.residual,
            seconds: far.seconds,
        };
        with(field, |side| side.reply(&reply).map(|()| AmberfieldStatus::Ok))
    }
}

/// Tells the DEM process why this one cannot go on.
///
/// # Safety
/// `field` comes from amberfield_field_open and is not closed; `reason` is a C string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_fail(field: *mut AmberfieldField, reason: *const c_char) {
    // SAFETY: the caller's promise.
    unsafe {
        let reason = CStr::from_ptr(reason).to_string_lossy();
        with(field, |side| {
            side.fail(&reason);
            Ok(AmberfieldStatus::Ok)
        });
    }
}

/// Tells the DEM process what is wrong with the case or the scene: its run ends as with any bad input.
///
/// # Safety
/// `field` comes from amberfield_field_open and is not closed; `reason` is a C string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_refuse(field: *mut AmberfieldField, reason: *const c_char) {
    // SAFETY: the caller's promise.
    unsafe {
        let reason = CStr::from_ptr(reason).to_string_lossy();
        with(field, |side| {
            side.refuse(&reason);
            Ok(AmberfieldStatus::Ok)
        });
    }
}

/// Closes a handle of the field side. NULL is allowed.
///
/// # Safety
/// `field` comes from amberfield_field_open and is not closed; the handle is gone afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_close(field: *mut AmberfieldField) {
    // SAFETY: the caller's promise.
    unsafe { close(field) };
}

/// Runs a call on an open handle; errors and panics become its text.
///
/// # Safety
/// `field` comes from amberfield_field_open and is not closed.
pub(crate) unsafe fn with(
    field: *mut AmberfieldField,
    call: impl FnOnce(&mut FieldSide) -> Result<AmberfieldStatus, CouplingError>,
) -> AmberfieldStatus {
    // SAFETY: the caller's promise.
    let AmberfieldField { side, error, .. } = unsafe { &mut *field };
    guarded(error, || match side {
        None => Err("the run is not open".to_owned()),
        Some(side) => call(side).map_err(|error| error.to_string()),
    })
}
