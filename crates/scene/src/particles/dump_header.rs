//! Header of a frame of a dump: box, units, and what its columns mean.

use super::columns::{Column, Columns};
use super::grains::Period;
use super::units::{Factors, Units};
use crate::SceneError;
use crate::error::shorten;

/// Box of a frame, in the file's units.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrameBox {
    pub(super) min: [f64; 3],
    pub(super) max: [f64; 3],
    /// Whether both faces of an axis are joined; `None` in files that do not say so.
    pub(super) is_periodic: [Option<bool>; 3],
}

/// Header of a frame.
#[derive(Clone, Debug, Default)]
pub(super) struct FrameHeader {
    pub(super) step: Option<u64>,
    pub(super) time: Option<f64>,
    pub(super) count: Option<u64>,
    pub(super) bounds: Option<FrameBox>,
    /// Names of the columns.
    pub(super) columns: Vec<String>,
    /// Line of the names of the columns.
    pub(super) line: u64,
}

/// Units of a file: those that it names, or those that the user does.
pub(super) fn units(file: &str, named: Option<Units>, given: Option<Units>) -> Result<Units, SceneError> {
    match (named, given) {
        (Some(named), Some(given)) if named != given => Err(SceneError::file(
            file,
            format!(
                "it says units {}, but units = \"{}\" was given; leave that out",
                named.name(),
                given.name()
            ),
        )),
        (Some(units), _) | (None, Some(units)) => Ok(units),
        (None, None) => Err(SceneError::file(
            file,
            format!(
                "the file does not say its units; give units, one of {} (what the command units of its \
                 program says; LIGGGHTS takes si where it says nothing, LAMMPS takes lj)",
                Units::NAMES.map(|name| format!("\"{name}\"")).join(", ")
            ),
        )),
    }
}

/// Kind of a coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct CoordinateKind {
    /// Ending of its name.
    ending: &'static str,
    /// Whether it is a fraction of the box.
    is_scaled: bool,
}

/// Kinds of coordinates, the best first: places in the box before unwrapped ones, lengths before fractions.
const KINDS: [CoordinateKind; 4] = [
    CoordinateKind { ending: "", is_scaled: false },
    CoordinateKind { ending: "s", is_scaled: true },
    CoordinateKind { ending: "u", is_scaled: false },
    CoordinateKind { ending: "su", is_scaled: true },
];

impl FrameHeader {
    /// Columns with their meanings and factors.
    pub(super) fn known_columns(&self, file: &str, factors: &Factors) -> Result<Columns, SceneError> {
        let refuse = |problem: String| SceneError::data(file, self.line, problem);
        let has = |name: &str| self.columns.iter().any(|column| column == name);
        let mut list: Vec<Column> = Vec::new();
        let mut places = Vec::new();
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let Some(kind) = KINDS.into_iter().find(|kind| has(&format!("{name}{}", kind.ending))) else {
                return Err(refuse(format!(
                    "no column {name}, {name}s, {name}u or {name}su among \"{}\"; dump id type x y z radius",
                    shorten(&self.columns.join(" "))
                )));
            };
            let mut column =
                Column::new(&format!("{name}{}", kind.ending), ["x_m", "y_m", "z_m"][axis], factors.length);
            if kind.is_scaled {
                let Some(bounds) = self.bounds else {
                    return Err(refuse(format!(
                        "{} is a fraction of a box that the dump does not have",
                        column.name
                    )));
                };
                column.offset = bounds.min[axis] * factors.length;
                column.factor = (bounds.max[axis] - bounds.min[axis]) * factors.length;
            }
            places.push(column);
        }
        for name in &self.columns {
            let place = places.iter().find(|column| column.name == *name).cloned();
            let column = place.unwrap_or_else(|| quantity(name, factors));
            // LIGGGHTS' examples have id and type twice, and a diameter may stand beside the radius.
            let is_there = list.iter().any(|before| !before.known.is_empty() && before.known == column.known);
            list.push(if is_there { Column::unused(name) } else { column });
        }
        Ok(Columns::of(file, list))
    }

    /// Axes along which places are taken back into the box: unwrapped ones, and those of grains that left it
    /// since their program last sorted them.
    pub(super) fn periods(&self, factors: &Factors) -> Vec<Period> {
        let Some(bounds) = self.bounds else { return Vec::new() };
        let axes = (0..3)
            .filter(|axis| bounds.is_periodic[*axis] == Some(true) && bounds.max[*axis] > bounds.min[*axis]);
        axes.map(|axis| Period {
            axis,
            low: bounds.min[axis] * factors.length,
            high: bounds.max[axis] * factors.length,
        })
        .collect()
    }
}

/// Column of a name in dumps.
pub(super) fn quantity(name: &str, factors: &Factors) -> Column {
    let (known, factor) = match name {
        "id" => ("id", 1.0),
        "type" => ("type", 1.0),
        "radius" => ("radius_m", factors.length),
        "diameter" => ("radius_m", 0.5 * factors.length),
        "q" => ("charge_C", factors.charge),
        "mass" => ("mass_kg", factors.mass),
        "density" => ("density_kg_m3", factors.density),
        "vx" => ("vx_m_s", factors.velocity),
        "vy" => ("vy_m_s", factors.velocity),
        "vz" => ("vz_m_s", factors.velocity),
        "omegax" => ("wx_rad_s", 1.0 / factors.time),
        "omegay" => ("wy_rad_s", 1.0 / factors.time),
        "omegaz" => ("wz_rad_s", 1.0 / factors.time),
        _ => return Column::unused(name),
    };
    Column::new(name, known, factor)
}
