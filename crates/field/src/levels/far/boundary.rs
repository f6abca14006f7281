//! Faces at the end of a mesh as polygons, and the patches that they belong to.

use super::{Condition, FarMeshParts};
use crate::error::FieldError;
use std::fmt::Display;

/// Fewest corners of a face.
const FEWEST_CORNERS: usize = 3;

/// A part of the mesh's end that has a name of its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshPatch {
    /// Name, as the mesh's author gave it.
    pub name: String,
    /// Type in the words of the mesh's program: `wall`, `patch`, `symmetry` and so on.
    pub kind: String,
}

/// Refuses boundary faces without corners of their own or of a patch that is not there.
pub(super) fn check_boundary(parts: &FarMeshParts) -> Result<(), FieldError> {
    let bad = |what: &str, place: usize, value: &dyn Display| {
        Err(FieldError::Settings(format!("the mesh's {what} {place} is {value}; the mesh is broken")))
    };
    let faces = parts.boundary.len();
    let (first, count) = (&parts.first_corner, parts.corners.len());
    if first.len() != faces + 1 || first[0] != 0 || first[faces] as usize != count {
        return Err(FieldError::Settings(format!(
            "the mesh has {faces} boundary faces, {} counts of their corners and {count} corners; the mesh \
             is broken",
            first.len().saturating_sub(1)
        )));
    }
    for (face, ends) in first.windows(2).enumerate() {
        if (ends[1] as usize) < ends[0] as usize + FEWEST_CORNERS {
            let corners = i64::from(ends[1]) - i64::from(ends[0]);
            return bad("number of corners of boundary face", face, &corners);
        }
    }
    if let Some(corner) = parts.corners.iter().position(|corner| !corner.iter().all(|x| x.is_finite())) {
        return bad("corner", corner, &parts.corners[corner]);
    }
    let patches = parts.patches.len();
    match parts.boundary.iter().position(|face| face.patch as usize >= patches) {
        Some(face) => {
            let patch = format!("{} of {patches}", parts.boundary[face].patch);
            bad("patch of boundary face", face, &patch)
        }
        None => check_changing(parts),
    }
}

/// Refuses potentials that change of patches that are not there, or that have none.
fn check_changing(parts: &FarMeshParts) -> Result<(), FieldError> {
    let bad = |patch: u32, what: &str| {
        Err(FieldError::Settings(format!(
            "the mesh's patch {patch}, whose potential changes, {what}; the mesh is broken"
        )))
    };
    for &patch in &parts.changing {
        if patch as usize >= parts.patches.len() {
            return bad(patch, "is not there");
        }
        if parts
            .boundary
            .iter()
            .any(|face| face.patch == patch && face.condition != Condition::Potential(0.0))
        {
            return bad(patch, "has faces without one");
        }
    }
    Ok(())
}
