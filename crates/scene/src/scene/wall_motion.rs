//! Key `motion` of `[[walls]]`.

use super::time_table::TimeTable;
use crate::SceneError;
use crate::error::Problems;
use crate::limits::COORDINATE;
use crate::source::SceneSource;
use crate::table::SceneTable;
use amberfield_core::{MotionKind, MotionRow, Vector3, WallMotion};

/// Seconds of a minute.
const MINUTE: f64 = 60.0;
/// Length below which a vector has no direction.
const SHORTEST: f64 = 1e-100;
/// Kinds of motion, by their keys.
const KINDS: [&str; 6] = ["rotate", "velocity_m_s", "vibrate", "surface_velocity_m_s", "table", "servo"];
/// Table of poses.
const POSES: TimeTable<7> = TimeTable {
    columns: ["t_s", "x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad"],
    may_lack: true,
    values: COORDINATE,
    of: "a motion",
};

/// Reads the motions of a wall.
pub(super) fn read_motion(
    wall: &SceneTable<'_>,
    source: &mut SceneSource,
) -> Result<Vec<WallMotion>, SceneError> {
    let mut motions = Vec::new();
    let mut problems = Problems::default();
    for table in wall.tables("motion")?.into_iter().flatten() {
        let motion = table.and_then(|table| read_one(&table, source));
        motions.extend(problems.keep(motion));
    }
    problems.finish()?;
    let servos = motions.iter().filter(|motion| matches!(motion.kind, MotionKind::Servo { .. })).count();
    if servos > 1 {
        return Err(wall.bad("motion", "it has two servos, of which neither would know the other; give one"));
    }
    Ok(motions)
}

fn read_one(table: &SceneTable<'_>, source: &mut SceneSource) -> Result<WallMotion, SceneError> {
    let given: Vec<&str> = KINDS.into_iter().filter(|kind| table.has(kind)).collect();
    let kind = match given[..] {
        [kind] => read_kind(kind, table, source)?,
        [] => return Err(table.missing("rotate", format!("give one of {}", KINDS.join(", ")))),
        [first, second, ..] => {
            let problem =
                format!("there is {first} already; give each motion a table of its own, in their order");
            return Err(table.bad(second, problem));
        }
    };
    if table.has("origin_m") && !matches!(kind, MotionKind::Table { .. }) {
        return Err(table.bad("origin_m", "only a table turns about it; a rotation has its own; remove it"));
    }
    let start_s = table.number("start_s")?.unwrap_or(0.0);
    let end_s = table.number("end_s")?.unwrap_or(f64::INFINITY);
    if end_s <= start_s {
        let problem = format!("not after start_s = {start_s} s; give a later end, or leave it out");
        return Err(table.bad("end_s", problem));
    }
    Ok(WallMotion { kind, start_s, end_s })
}

fn read_kind(kind: &str, table: &SceneTable<'_>, source: &mut SceneSource) -> Result<MotionKind, SceneError> {
    let below = || table.table(kind).and_then(|below| table.need(below, kind, "give a table"));
    Ok(match kind {
        "rotate" => {
            let rotate = below()?;
            MotionKind::Rotate {
                origin: rotate.vector("origin_m")?.unwrap_or_default(),
                axis: read_axis(&rotate)?,
                turns_per_s: rotate.need_number("rpm")? / MINUTE,
            }
        }
        "velocity_m_s" => MotionKind::Translate(table.need_vector(kind)?),
        "surface_velocity_m_s" => MotionKind::Slide(table.need_vector(kind)?),
        "vibrate" => {
            let vibrate = below()?;
            MotionKind::Vibrate {
                amplitude: vibrate.need_vector("amplitude_m")?,
                frequency_hz: vibrate.need_number("frequency_Hz")?,
                phase: vibrate.number("phase_rad")?.unwrap_or(0.0),
            }
        }
        "servo" => {
            let servo = below()?;
            MotionKind::Servo {
                force_n: servo.need_number("force_N")?,
                direction: direction(&servo, "direction", servo.need_vector("direction")?)?,
                most_m_s: servo.need_number("most_m_s")?,
            }
        }
        _ => {
            let name = table.text(kind)?;
            let name = table.need(name, kind, "give the name of a file")?;
            let bytes = source.read_file(table, kind, name)?;
            let rows = read_rows(name, &bytes)?;
            MotionKind::Table { origin: table.vector("origin_m")?.unwrap_or_default(), rows }
        }
    })
}

/// Axis of a rotation, as a unit vector.
fn read_axis(rotate: &SceneTable<'_>) -> Result<Vector3<f64>, SceneError> {
    match rotate.text("axis")? {
        Some("x") => Ok(Vector3::x()),
        Some("y") => Ok(Vector3::y()),
        Some(_) => Ok(Vector3::z()),
        None => direction(rotate, "axis", rotate.need_vector("axis")?),
    }
}

/// Direction of a vector.
fn direction(table: &SceneTable<'_>, key: &str, vector: Vector3<f64>) -> Result<Vector3<f64>, SceneError> {
    if vector.norm() < SHORTEST {
        return Err(table.bad(key, "the vector has no direction; give it a length, as [0, 0, 1]"));
    }
    Ok(vector.normalize())
}

/// Reads a table of poses.
fn read_rows(file: &str, bytes: &[u8]) -> Result<Vec<MotionRow>, SceneError> {
    let pose = |[time_s, x, y, z, rx, ry, rz]: [f64; 7]| MotionRow {
        time_s,
        displacement: Vector3::new(x, y, z),
        rotation: Vector3::new(rx, ry, rz),
    };
    Ok(POSES.read(file, bytes)?.into_iter().map(pose).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_read_in_any_order_of_columns() {
        let text = "# a comment\nz_m, t_s, rx_rad\n0.1, 0.0, 1\n0.2, 0.5, 2\n";
        let rows = read_rows("m.csv", text.as_bytes()).expect("a good table");
        assert_eq!(rows[1].time_s, 0.5);
        assert_eq!(rows[1].displacement, Vector3::new(0.0, 0.0, 0.2));
        assert_eq!(rows[1].rotation, Vector3::new(2.0, 0.0, 0.0));
        assert_eq!(read_rows("m.csv", b"t_s x_m\n0 1\n1 2\n").expect("blanks").len(), 2);
    }

    #[test]
    fn mistakes_are_named_with_their_line() {
        for (text, words) in [
            ("t_s,x_m\n0,0\n0,1\n", "m.csv:3: t_s = 0 follows"),
            ("t_s,x_m\n0,0\n", "1 row(s)"),
            ("t_s,x\n0,0\n", "unknown column \"x\""),
            ("x_m\n0\n", "needs t_s"),
            ("t_s,x_m\n0,0\n1,a\n", "x_m = \"a\""),
            ("t_s,x_m\n0,0\n1,inf\n", "x_m = \"inf\""),
            ("t_s,x_m\n0,0\n1\n", "1 cells"),
            ("\n", "no header row"),
        ] {
            let said = read_rows("m.csv", text.as_bytes()).expect_err(text).to_string();
            assert!(said.contains(words), "{text}: {said}");
        }
    }
}
