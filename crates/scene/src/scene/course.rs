//! Potentials and fields that change with time: sines, and tables.

use super::time_table::TimeTable;
use crate::SceneError;
use crate::limits::ELECTRIC;
use crate::source::SceneSource;
use crate::table::SceneTable;
use amberfield_core::{Course, CourseRow, FieldCourse, PotentialCourse, Vector3};

/// Table of a potential.
const POTENTIALS: TimeTable<2> = TimeTable {
    columns: ["t_s", "potential_V"],
    may_lack: false,
    values: ELECTRIC,
    of: "a potential over time",
};
/// Table of a field.
const FIELDS: TimeTable<4> = TimeTable {
    columns: ["t_s", "ex_V_per_m", "ey_V_per_m", "ez_V_per_m"],
    may_lack: false,
    values: ELECTRIC,
    of: "a field over time",
};

/// Quantity that a key gives.
pub(super) enum Given<T> {
    /// One that stays as it is.
    Constant(T),
    /// One that changes.
    Changing(Course<T>),
}

/// Reads a potential [V], as a number or over time.
pub(super) fn read_potential(
    table: &SceneTable<'_>,
    key: &str,
    source: &mut SceneSource,
) -> Result<Option<Given<f64>>, SceneError> {
    let Some(below) = table.table(key)? else { return Ok(table.number(key)?.map(Given::Constant)) };
    if let Some((name, bytes)) = read_table(&below, source)? {
        let row = |[time_s, value]: [f64; 2]| CourseRow { time_s, value };
        let rows = POTENTIALS.read(&name, &bytes)?.into_iter().map(row).collect();
        return Ok(Some(Given::Changing(PotentialCourse::Table { name, rows })));
    }
    let [amplitude, offset] = [below.need_number("amplitude")?, below.number("offset")?.unwrap_or(0.0)];
    sine(&below, amplitude, offset, amplitude == 0.0).map(Some)
}

/// Reads a uniform field [V/m], as a vector or over time.
pub(super) fn read_field(
    table: &SceneTable<'_>,
    key: &str,
    source: &mut SceneSource,
) -> Result<Option<Given<Vector3<f64>>>, SceneError> {
    let Some(below) = table.table(key)? else { return Ok(table.vector(key)?.map(Given::Constant)) };
    if let Some((name, bytes)) = read_table(&below, source)? {
        let row = |[time_s, x, y, z]: [f64; 4]| CourseRow { time_s, value: Vector3::new(x, y, z) };
        let rows = FIELDS.read(&name, &bytes)?.into_iter().map(row).collect();
        return Ok(Some(Given::Changing(FieldCourse::Table { name, rows })));
    }
    let amplitude = below.need_vector("amplitude")?;
    let offset = below.vector("offset")?.unwrap_or_default();
    sine(&below, amplitude, offset, amplitude == Vector3::zeros()).map(Some)
}

/// Name and content of the file of a course, if it has one; nothing else stands beside it.
fn read_table(
    course: &SceneTable<'_>,
    source: &mut SceneSource,
) -> Result<Option<(String, Vec<u8>)>, SceneError> {
    let Some(name) = course.text("table")? else {
        if !course.has("amplitude") {
            let advice = "give amplitude and frequency_Hz, or table = \"…\" with the name of a file";
            return Err(course.missing("amplitude", advice));
        }
        return Ok(None);
    };
    if let Some(other) = course.keys().find(|key| *key != "table") {
        return Err(course.bad(other, "there is a table already; remove one of the two"));
    }
    let bytes = source.read_file(course, "table", name)?;
    Ok(Some((name.to_owned(), bytes)))
}

/// Sine of an amplitude, or the offset alone where that is zero.
fn sine<T>(table: &SceneTable<'_>, amplitude: T, offset: T, is_zero: bool) -> Result<Given<T>, SceneError> {
    let frequency_hz = table.need_number("frequency_Hz")?;
    let phase = table.number("phase_rad")?.unwrap_or(0.0);
    if is_zero {
        return Ok(Given::Constant(offset));
    }
    Ok(Given::Changing(Course::Sine { amplitude, frequency_hz, phase, offset }))
}
