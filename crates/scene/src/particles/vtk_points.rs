//! Points of a VTK file as grains: which array is what, and in which unit.

use super::columns::{Column, Columns};
use super::dump_header::{quantity, units};
use super::grains::{Gathering, GrainContext};
use super::quantity::Quantity;
use super::row::{Row, RowPlace};
use super::snapshot::{FileChoices, Snapshot};
use super::units::Factors;
use crate::SceneError;
use std::borrow::Cow;

/// Numbers of an array.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum VtkValues {
    /// Floating-point numbers.
    Floats(Vec<f64>),
    /// Whole numbers.
    Signed(Vec<i64>),
    /// Whole numbers from 0.
    Unsigned(Vec<u64>),
}

impl VtkValues {
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Floats(list) => list.len(),
            Self::Signed(list) => list.len(),
            Self::Unsigned(list) => list.len(),
        }
    }

    fn number(&self, index: usize) -> f64 {
        match self {
            Self::Floats(list) => list[index],
            Self::Signed(list) => list[index] as f64,
            Self::Unsigned(list) => list[index] as f64,
        }
    }

    fn text(&self, index: usize) -> String {
        match self {
            Self::Floats(list) => list[index].to_string(),
            Self::Signed(list) => list[index].to_string(),
            Self::Unsigned(list) => list[index].to_string(),
        }
    }
}

/// Array with its name.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct VtkArray {
    /// Name.
    pub(super) name: String,
    /// Numbers of each point.
    pub(super) components: usize,
    /// Numbers, point by point.
    pub(super) values: VtkValues,
}

/// Points of a file with their arrays.
#[derive(Clone, Debug)]
pub(super) struct VtkPoints {
    /// Places.
    pub(super) places: VtkArray,
    /// Further arrays.
    pub(super) arrays: Vec<VtkArray>,
    /// Names of materials, where the file has them.
    pub(super) materials: Vec<String>,
    /// Names of groups, where the file has them.
    pub(super) groups: Vec<String>,
}

/// Name of the places in files of this project, which are in metres.
const OWN_PLACES: &str = "points_m";

/// Vectors of this project, and the columns that they stand for.
const OWN_VECTORS: [(&str, [&str; 3]); 2] = [
    ("velocity_m_s", ["vx_m_s", "vy_m_s", "vz_m_s"]),
    ("angular_velocity_rad_s", ["wx_rad_s", "wy_rad_s", "wz_rad_s"]),
];

/// Vectors of LAMMPS, LIGGGHTS and converters of their dumps, and the columns of dumps that they stand for.
const VECTORS: [(&str, [&str; 3]); 4] = [
    ("v", ["vx", "vy", "vz"]),
    ("velocity", ["vx", "vy", "vz"]),
    ("omega", ["omegax", "omegay", "omegaz"]),
    ("angular_velocity", ["omegax", "omegay", "omegaz"]),
];

/// Cells of a column: a component of an array.
#[derive(Clone, Copy, Debug)]
struct Cells<'a> {
    array: &'a VtkArray,
    component: usize,
    /// Names that the numbers stand for.
    names: Option<&'a [String]>,
    /// Text before a number that has no name.
    nameless: &'static str,
}

/// Point of a file.
struct PointRow<'a> {
    cells: &'a [Cells<'a>],
    point: usize,
}

impl Row for PointRow<'_> {
    fn number(&self, column: usize) -> Result<f64, &'static str> {
        let Cells { array, component, .. } = self.cells[column];
        Ok(array.values.number(self.point * array.components + component))
    }

    fn text(&self, column: usize) -> Cow<'_, str> {
        let Cells { array, component, names, nameless } = self.cells[column];
        let text = array.values.text(self.point * array.components + component);
        let Some(names) = names else { return Cow::Owned(text) };
        match text.parse::<usize>().ok().and_then(|index| names.get(index)) {
            Some(name) => Cow::Borrowed(name),
            // Group 0 is that of grains without a group.
            None if nameless == "group" && text == "0" => Cow::Borrowed(""),
            None => Cow::Owned(format!("{nameless}{text}")),
        }
    }

    fn place(&self) -> RowPlace {
        RowPlace::Point(self.point as u64)
    }
}

impl VtkPoints {
    /// Reads the points as grains.
    ///
    /// # Errors
    /// Units that nobody names, arrays of other lengths, and bad values with their point.
    pub(super) fn grains(
        &self,
        file: &str,
        choices: &FileChoices,
        context: &GrainContext<'_>,
    ) -> Result<Snapshot, SceneError> {
        let is_own = self.places.name == OWN_PLACES;
        if is_own && choices.units.is_some() {
            let problem = "units is for files of other programs; this one is in SI units; leave it out";
            return Err(SceneError::file(file, problem));
        }
        let factors = if is_own { None } else { Some(units(file, None, choices.units)?.factors()) };
        let count = self.places.values.len() / 3;
        if count == 0 {
            return Err(SceneError::file(file, "the file has no points; check that it was written"));
        }
        let (mut columns, mut cells) = (Vec::new(), Vec::new());
        let length = factors.map_or(1.0, |factors| factors.length);
        for (component, known) in ["x_m", "y_m", "z_m"].into_iter().enumerate() {
            columns.push(Column::new(&known[..1], known, length));
            cells.push(Cells { array: &self.places, component, names: None, nameless: "" });
        }
        for array in &self.arrays {
            if array.components == 0 || array.values.len() != count * array.components {
                let problem = format!(
                    "array {} has {} numbers, not {} for each of {count} points; check the file",
                    array.name,
                    array.values.len(),
                    array.components
                );
                return Err(SceneError::file(file, problem));
            }
            for (component, column) in self.columns_of(array, factors.as_ref()).into_iter().enumerate() {
                let is_there = |before: &Column| !before.known.is_empty() && before.known == column.known;
                let (names, nameless) = match column.known {
                    "material" => (Some(&self.materials[..]), "material"),
                    "group" => (Some(&self.groups[..]), "group"),
                    _ => (None, ""),
                };
                let is_second = columns.iter().any(is_there);
                columns.push(if is_second { Column::unused(&array.name) } else { column });
                cells.push(Cells { array, component, names, nameless });
            }
        }
        let mut grains = Gathering::new(Columns::of(file, columns), context, u64::from(!is_own))?;
        for point in 0..count {
            grains.add(&PointRow { cells: &cells, point })?;
        }
        grains.finish()
    }

    /// Columns of an array; one that is not read where it is none of a grain's.
    fn columns_of(&self, array: &VtkArray, factors: Option<&Factors>) -> Vec<Column> {
        let name = &array.name[..];
        match (array.components, factors) {
            (3, Some(factors)) => match VECTORS.iter().find(|(vector, _)| *vector == name) {
                Some((_, parts)) => parts.iter().map(|part| quantity(part, factors)).collect(),
                None => vec![Column::unused(name)],
            },
            (3, None) => match OWN_VECTORS.iter().find(|(vector, _)| *vector == name) {
                Some((_, parts)) => parts.iter().map(|part| Column::new(part, part, 1.0)).collect(),
                None => vec![Column::unused(name)],
            },
            (1, Some(factors)) => vec![quantity(name, factors)],
            (1, None) => match name {
                "material" if self.materials.is_empty() => vec![Column::new(name, "type", 1.0)],
                _ => match Quantity::named(name) {
                    Some(Quantity { name: known, factor }) => vec![Column::new(name, known, factor)],
                    None => vec![Column::unused(name)],
                },
            },
            _ => vec![Column::unused(name)],
        }
    }
}
