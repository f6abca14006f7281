//! Names of materials and groups in a file of grains, or the numbers that stand for them.

use super::columns::Columns;
use super::row::Row;
use crate::SceneError;
use crate::materials::Materials;
use amberfield_core::{GroupId, MaterialId};

/// Names of materials that a file may use.
#[derive(Debug)]
pub(crate) enum MaterialNames<'a> {
    /// Names of a scene.
    Scene {
        /// Materials.
        materials: &'a Materials,
        /// Materials of the file's types in order; `None` where they are not named.
        by_type: Option<Vec<MaterialId>>,
    },
    /// Names that the file has.
    File {
        /// Names of the file's types in order; empty where they are not named.
        by_type: &'a [String],
    },
}

impl MaterialNames<'_> {
    /// Density of a material [kg/m³]; 0 where it is not known.
    pub(super) fn density(&self, material: MaterialId) -> f64 {
        match self {
            Self::Scene { materials, .. } => materials.density(material),
            Self::File { .. } => 0.0,
        }
    }

    /// Number of types that were named.
    fn named_types(&self) -> usize {
        match self {
            Self::Scene { by_type, .. } => by_type.as_ref().map_or(0, Vec::len),
            Self::File { by_type } => by_type.len(),
        }
    }
}

/// Column from which a grain's material comes.
#[derive(Clone, Copy, Debug)]
enum MaterialColumn {
    /// Column of names.
    Names(usize),
    /// Column of numbers from a first one.
    Types { column: usize, first: u64 },
    /// No column: all grains are of one material.
    None,
}

/// Names that were met in a file.
pub(super) struct Names<'a> {
    known: &'a MaterialNames<'a>,
    material: MaterialColumn,
    group: Option<usize>,
    /// Names of materials, where they are the file's.
    materials: Vec<String>,
    /// Names of groups, `all` first.
    groups: Vec<String>,
}

impl<'a> Names<'a> {
    /// Looks for the columns of names.
    ///
    /// # Errors
    /// Names for types in a file that has none.
    pub(super) fn new(
        known: &'a MaterialNames<'a>,
        columns: &Columns,
        first_type: u64,
    ) -> Result<Self, SceneError> {
        let material = match (columns.find("material"), columns.find("type")) {
            (Some(column), _) => MaterialColumn::Names(column),
            (None, Some(column)) => MaterialColumn::Types { column, first: first_type },
            (None, None) => MaterialColumn::None,
        };
        if known.named_types() > 0 && !matches!(material, MaterialColumn::Types { .. }) {
            let problem = match material {
                MaterialColumn::Names(_) => "names materials itself",
                _ => "has no column of types",
            };
            let problem = format!(
                "materials_by_type is for files with numbered types, but this one {problem}; \
                                   leave it out"
            );
            return Err(SceneError::file(&columns.file, problem));
        }
        let materials = match known {
            MaterialNames::File { by_type } => by_type.to_vec(),
            MaterialNames::Scene { .. } => Vec::new(),
        };
        Ok(Self { known, material, group: columns.find("group"), materials, groups: vec!["all".to_owned()] })
    }

    /// Material and group of a row.
    ///
    /// # Errors
    /// Names and numbers that cannot be used.
    pub(super) fn of(
        &mut self,
        columns: &Columns,
        row: &impl Row,
    ) -> Result<(MaterialId, GroupId), SceneError> {
        Ok((self.material(columns, row)?, self.group(columns, row)?))
    }

    fn material(&mut self, columns: &Columns, row: &impl Row) -> Result<MaterialId, SceneError> {
        match self.material {
            MaterialColumn::Names(column) => {
                let name = row.text(column);
                self.named(&name).map_err(|problem| columns.bad(row, column, &problem))
            }
            MaterialColumn::Types { column, first } => {
                let text = row.text(column);
                let found = match text.parse::<u64>() {
                    Ok(number) => self.of_type(number, first),
                    // LAMMPS writes the types' labels where it is asked to.
                    Err(_) => self.named(&text),
                };
                found.map_err(|problem| columns.bad(row, column, &problem))
            }
            MaterialColumn::None => self.default_material().map_err(|problem| match columns.find("id") {
                Some(column) => columns.bad(row, column, &problem),
                None => row.error(&columns.file, problem),
            }),
        }
    }

    /// Material of a name.
    fn named(&mut self, name: &str) -> Result<MaterialId, String> {
        match self.known {
            MaterialNames::Scene { materials, .. } => materials.find(name),
            MaterialNames::File { .. } => index_of(name, &mut self.materials)
                .map(MaterialId)
                .ok_or_else(|| "more than 65536 materials; merge some".to_owned()),
        }
    }

    /// Material of a type's number; the smallest is `first`.
    fn of_type(&mut self, number: u64, first: u64) -> Result<MaterialId, String> {
        let too_large = || format!("types are numbers from {first} to {}", u64::from(u16::MAX) + first);
        let index =
            number.checked_sub(first).and_then(|index| u16::try_from(index).ok()).ok_or_else(too_large)?;
        let unnamed = |count: usize| {
            format!("materials_by_type names {count} materials, from type {first} on; name one for each type")
        };
        match self.known {
            MaterialNames::Scene { by_type: Some(list), .. } => {
                list.get(usize::from(index)).copied().ok_or_else(|| unnamed(list.len()))
            }
            MaterialNames::Scene { materials, by_type: None } => materials.default_id().ok_or_else(|| {
                format!(
                    "the scene has {} materials; name those of types {first}, {}, … by materials_by_type",
                    materials.list.len(),
                    first + 1
                )
            }),
            MaterialNames::File { by_type } => {
                if !by_type.is_empty() && usize::from(index) >= by_type.len() {
                    return Err(unnamed(by_type.len()));
                }
                for new in self.materials.len() as u64..=u64::from(index) {
                    self.materials.push(format!("type{}", new + first));
                }
                Ok(MaterialId(index))
            }
        }
    }

    /// Material of a file that names none.
    fn default_material(&self) -> Result<MaterialId, String> {
        match self.known {
            MaterialNames::Scene { materials, .. } => materials.default_id().ok_or_else(|| {
                let count = materials.list.len();
                format!("the scene has {count} materials and the file has no column material; add it")
            }),
            MaterialNames::File { .. } => Ok(MaterialId(0)),
        }
    }

    fn group(&mut self, columns: &Columns, row: &impl Row) -> Result<GroupId, SceneError> {
        let Some(column) = self.group else { return Ok(GroupId(0)) };
        let name = row.text(column);
        if name.is_empty() {
            return Ok(GroupId(0));
        }
        index_of(&name, &mut self.groups)
            .map(GroupId)
            .ok_or_else(|| columns.bad(row, column, "more than 65536 groups; merge some"))
    }

    /// Tells whether the file says of which material its grains are.
    pub(super) fn has_materials(&self) -> bool {
        !matches!(self.material, MaterialColumn::None)
    }

    /// Names of materials, where they are the file's, and of groups.
    pub(super) fn finish(self) -> (Vec<String>, Vec<String>) {
        (self.materials, self.groups)
    }
}

/// Index of a name in a list, to which new ones are added; `None` where the list is full.
fn index_of(name: &str, list: &mut Vec<String>) -> Option<u16> {
    let index = list.iter().position(|known| known == name).unwrap_or(list.len());
    let found = u16::try_from(index).ok()?;
    if index == list.len() {
        list.push(name.to_owned());
    }
    Some(found)
}
