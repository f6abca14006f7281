//! Sections `[[pairs]]`.

use crate::SceneError;
use crate::error::Problems;
use crate::materials::Materials;
use crate::table::SceneTable;
use amberfield_core::{MaterialId, MaterialPair};

/// Reads `[[pairs]]`.
pub(super) fn read_pairs(
    document: &SceneTable<'_>,
    materials: &Materials,
) -> Result<Vec<MaterialPair>, SceneError> {
    let mut pairs: Vec<MaterialPair> = Vec::new();
    let mut problems = Problems::default();
    for table in document.tables("pairs")?.into_iter().flatten() {
        let read = table.and_then(|table| {
            let pair = read_pair(&table, materials)?;
            let [a, b] = pair.between;
            if pairs.iter().any(|other| other.is_between(a, b)) {
                return Err(table.bad("between", "another entry has the same two materials; merge them"));
            }
            Ok(pair)
        });
        pairs.extend(problems.keep(read));
    }
    problems.finish().map(|()| pairs)
}

fn read_pair(table: &SceneTable<'_>, materials: &Materials) -> Result<MaterialPair, SceneError> {
    let pair = MaterialPair {
        between: read_between(table, materials)?,
        restitution: table.number("restitution")?,
        friction: table.number("friction")?,
        rolling_friction: table.number("rolling_friction")?,
        surface_energy_j_m2: table.number("surface_energy_J_m2")?,
    };
    if pair == (MaterialPair { between: pair.between, ..MaterialPair::default() }) {
        return Err(table.missing(
            "friction",
            "the entry changes nothing; give friction, restitution, rolling_friction or surface_energy_J_m2",
        ));
    }
    Ok(pair)
}

/// Reads the two materials.
fn read_between(table: &SceneTable<'_>, materials: &Materials) -> Result<[MaterialId; 2], SceneError> {
    let names = table.words("between")?;
    let names =
        table.need(names, "between", "name the two materials, as in between = [\"glass\", \"steel\"]")?;
    let [one, other] = names[..] else {
        return Err(
            table.bad("between", "takes two names; name a material twice for its contacts with itself")
        );
    };
    let find = |name: &str| {
        materials.find(name).map_err(|problem| table.bad("between", format!("\"{name}\": {problem}")))
    };
    Ok([find(one)?, find(other)?])
}
