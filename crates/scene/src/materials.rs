//! Sections `[[materials]]`.

use crate::SceneError;
use crate::error::Problems;
use crate::table::SceneTable;
use crate::tree::nearest;
use amberfield_core::{Material, MaterialId};

/// Reads `[[materials]]`.
pub(super) fn read_materials(document: &SceneTable<'_>) -> Result<Vec<Material>, SceneError> {
    let mut materials: Vec<Material> = Vec::new();
    let mut problems = Problems::default();
    for table in document.tables("materials")?.into_iter().flatten() {
        if materials.len() > usize::from(u16::MAX) {
            return Err(document.bad("materials", "more than 65536 materials; merge some"));
        }
        let read = table.and_then(|table| {
            let material = read_material(&table)?;
            if materials.iter().any(|other| other.name == material.name) {
                return Err(table.bad("name", "another material has this name; rename one"));
            }
            Ok(material)
        });
        materials.extend(problems.keep(read));
    }
    problems.finish().map(|()| materials)
}

fn read_material(table: &SceneTable<'_>) -> Result<Material, SceneError> {
    let name = table.text("name")?;
    Ok(Material {
        name: table.need(name, "name", "give the material a name")?.to_owned(),
        density_kg_m3: table.need_number("density_kg_m3")?,
        young_pa: table.need_number("young_Pa")?,
        young_real_pa: table.number("young_real_Pa")?,
        poisson: table.need_number("poisson")?,
        restitution: table.need_number("restitution")?,
        friction: table.need_number("friction")?,
        rolling_friction: table.number("rolling_friction")?.unwrap_or(0.0),
        surface_energy_j_m2: table.number("surface_energy_J_m2")?.unwrap_or(0.0),
        work_function_ev: table.number("work_function_eV")?,
    })
}

/// Materials of the scene, found by name.
#[derive(Debug)]
pub(crate) struct Materials {
    /// Materials in the order of the scene.
    pub(crate) list: Vec<Material>,
    /// Flag of a scene without motion and without materials, in which names of materials have no meaning.
    pub(crate) ignored: bool,
}

impl Materials {
    /// Id of the material with a name, or the text of a message when no material has it.
    pub(crate) fn find(&self, name: &str) -> Result<MaterialId, String> {
        if self.ignored {
            return Ok(MaterialId(0));
        }
        if let Some(index) = self.list.iter().position(|material| material.name == name) {
            return Ok(MaterialId(u16::try_from(index).expect("materials are at most 65536")));
        }
        let names: Vec<&str> = self.list.iter().map(|material| material.name.as_str()).collect();
        Err(nearest(name, &names).map_or_else(
            || "no material of this name; add it under [[materials]]".to_owned(),
            |near| format!("no material of this name; the nearest is \"{near}\""),
        ))
    }

    /// Default material: the only one of the scene, if there is only one.
    pub(crate) fn default_id(&self) -> Option<MaterialId> {
        (self.ignored || self.list.len() == 1).then_some(MaterialId(0))
    }

    /// Density of a material [kg/m³]; 0 where there are no materials and no motion.
    pub(crate) fn density(&self, id: MaterialId) -> f64 {
        self.list.get(usize::from(id.0)).map_or(0.0, |material| material.density_kg_m3)
    }

    /// Id of the material that a table's key names, or of the default.
    pub(crate) fn named_by(&self, table: &SceneTable<'_>, key: &str) -> Result<MaterialId, SceneError> {
        match table.text(key)? {
            Some(name) => self.find(name).map_err(|problem| table.bad(key, problem)),
            None => self.default_id().ok_or_else(|| {
                table.missing(key, format!("name one of the {} [[materials]] of the scene", self.list.len()))
            }),
        }
    }
}
