//! Potentials of the box's faces beside those of a solver's case, which count.

use crate::failure::Failure;
use amberfield_core::{Axis, Boundary, Domain, Side};
use amberfield_field::far::{BoundaryFace, Condition, FarMesh};
use amberfield_scene::SolverLoss;

/// Share of the box's length up to which a face of the mesh lies on one of the box.
const ON_FACE: f64 = 1e-6;
/// Difference of two potentials that are one, over their size.
const SAME: f64 = 1e-9;

/// Refuses potentials that change with time, which count on the internal grid alone, and warns of others that
/// the case does not have there.
///
/// # Errors
/// Potentials of faces that change, unless the internal grid goes on with them where the solver is lost.
pub(super) fn compare(domain: &Domain, mesh: &FarMesh, loss: SolverLoss) -> Result<Option<String>, Failure> {
    if loss == SolverLoss::Fallback {
        return Ok(None);
    }
    if let Some(face) = domain.courses().first() {
        return Err(Failure::bad_input(format!(
            "domain.boundary.{} has a potential that changes with time, which the field over OpenFOAM does \
             not follow: there the potentials of 0/phiE count; give its patch uniformFixedValue with a \
             function of time there and leave this one out, or leave [solver] out",
            face.axis.face_name(face.side)
        )));
    }
    let sides = Axis::ALL.into_iter().flat_map(|axis| [(axis, Side::Min), (axis, Side::Max)]);
    Ok(sides.filter_map(|(axis, side)| difference(domain, mesh, axis, side)).next())
}

/// Warning where a face has a potential that the mesh does not have on it; `None` where the mesh ends
/// elsewhere.
fn difference(domain: &Domain, mesh: &FarMesh, axis: Axis, side: Side) -> Option<String> {
    let Boundary::Potential(ours) = domain.face(axis, side) else { return None };
    let k = axis.index();
    let plane = [domain.min(), domain.max()][side as usize][k];
    let far = ON_FACE * domain.extent()[k];
    let on_face =
        |face: &&BoundaryFace| (face.centre[k] - plane).abs() < far && face.normal[k].abs() > 1.0 - ON_FACE;
    let theirs = mesh.boundary().iter().filter(on_face).find_map(|face| match face.condition {
        _ if mesh.changing().contains(&face.patch) => Some("one that changes with time".to_owned()),
        Condition::Potential(volts) if (volts - ours).abs() <= SAME * (volts.abs() + ours.abs()) => None,
        Condition::Potential(volts) => Some(format!("{volts} V")),
        Condition::Slope(_) => Some("no potential".to_owned()),
    })?;
    Some(format!(
        "domain.boundary.{} = {{ potential_V = {ours} }}, but the case has {theirs} there, which counts: \
         over OpenFOAM potentials stand in 0/phiE",
        axis.face_name(side)
    ))
}
