//! Section `[domain]`.

use super::course::{Given, read_potential};
use crate::SceneError;
use crate::source::SceneSource;
use crate::table::SceneTable;
use crate::tree::Value;
use amberfield_core::{Axis, Boundary, Domain, DomainError, FaceCourse, PotentialCourse, Side};

/// Forms that the value of a face may have, for messages.
const FACE_FORMS: &str = "one of \"grounded\", \"insulating\", \"periodic\", \"open\", \
                          { potential_V = 1000.0 }, { normal_field_V_m = 0.0 }";

/// Condition of a face, and its potential over time where that changes.
type Face = (Boundary, Option<PotentialCourse>);

/// Reads `[domain]`.
pub(super) fn read_domain(
    document: &SceneTable<'_>,
    source: &mut SceneSource,
) -> Result<Option<Domain>, SceneError> {
    let Some(table) = document.table("domain")? else { return Ok(None) };
    let min = table.need_vector("min_m")?;
    let max = table.need_vector("max_m")?;
    let boundary = table.table("boundary")?;
    let boundary =
        table.need(boundary, "boundary", "add [domain.boundary] with x, y and z (or x_min, x_max, …)")?;
    let mut faces = [[Boundary::Open; 2]; 3];
    let mut courses = Vec::new();
    for axis in Axis::ALL {
        let read = read_axis(&boundary, axis, source)?;
        for (side, (condition, course)) in [Side::Min, Side::Max].into_iter().zip(read) {
            faces[axis.index()][side as usize] = condition;
            courses.extend(course.map(|course| FaceCourse { axis, side, course }));
        }
    }
    let domain = Domain::new(min, max, faces).map(|domain| domain.with_courses(courses));
    domain.map(Some).map_err(|error| match error {
        DomainError::Extent { .. } => table.bad("max_m", error.to_string()),
        DomainError::HalfPeriodic(axis) => half_periodic(&boundary, axis, &error),
        _ => table.bad("boundary", error.to_string()),
    })
}

/// Error about an axis of which one face only is periodic.
fn half_periodic(boundary: &SceneTable<'_>, axis: Axis, error: &DomainError) -> SceneError {
    let key = [Side::Min, Side::Max]
        .map(|side| face_key(axis, side))
        .into_iter()
        .find(|key| boundary.get(key).is_some_and(|node| node.value == Value::Text("periodic".into())))
        .unwrap_or_else(|| face_key(axis, Side::Min));
    boundary.bad(&key, error.to_string())
}

fn face_key(axis: Axis, side: Side) -> String {
    format!("{axis}_{}", if side == Side::Min { "min" } else { "max" })
}

/// Reads the lower and the upper face of an axis.
fn read_axis(
    boundary: &SceneTable<'_>,
    axis: Axis,
    source: &mut SceneSource,
) -> Result<[Face; 2], SceneError> {
    let both = axis.to_string();
    let (low, high) = (face_key(axis, Side::Min), face_key(axis, Side::Max));
    if boundary.has(&both) {
        for face in [&low, &high] {
            if boundary.has(face) {
                return Err(boundary.bad(
                    face,
                    format!("{} gives both faces already; remove one of the two", boundary.key(&both)),
                ));
            }
        }
        let face = read_face(boundary, &both, source)?;
        return Ok([face.clone(), face]);
    }
    let mut face = |key: &String| {
        if !boundary.has(key) {
            return Err(boundary.missing(key, format!("give {key} (or {both} for both faces), {FACE_FORMS}")));
        }
        read_face(boundary, key, source)
    };
    Ok([face(&low)?, face(&high)?])
}

fn read_face(boundary: &SceneTable<'_>, key: &str, source: &mut SceneSource) -> Result<Face, SceneError> {
    let Some(node) = boundary.get(key) else {
        return Err(boundary.missing(key, format!("give {FACE_FORMS}")));
    };
    match &node.value {
        Value::Table(_) => {
            let table = boundary.table(key)?.expect("it is a table");
            let potential = read_potential(&table, "potential_V", source)?;
            match (potential, table.number("normal_field_V_m")?) {
                (Some(Given::Constant(volts)), None) => Ok((Boundary::Potential(volts), None)),
                (Some(Given::Changing(course)), None) => {
                    Ok((Boundary::Potential(course.at(0.0)), Some(course)))
                }
                (None, Some(normal_field_v_m)) => Ok((Boundary::Insulating { normal_field_v_m }, None)),
                _ => Err(boundary.bad(key, format!("give exactly one key; {FACE_FORMS}"))),
            }
        }
        _ => {
            let words = [
                ("grounded", Boundary::Grounded),
                ("insulating", Boundary::Insulating { normal_field_v_m: 0.0 }),
                ("periodic", Boundary::Periodic),
                ("open", Boundary::Open),
            ];
            let face = boundary.word(key, &words)?;
            boundary.need(face, key, FACE_FORMS).map(|face| (face, None))
        }
    }
}
