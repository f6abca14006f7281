//! Sections `[[outlets]]`.

use crate::SceneError;
use crate::error::Problems;
use crate::files::in_heading;
use crate::generate::read_volume;
use crate::table::SceneTable;
use amberfield_core::{Axis, Outlet, OutletRegion, Side};

/// Largest number of outlets.
const MOST: usize = 1000;

/// Reads `[[outlets]]`, sorted by name: the order of the file does not matter.
pub(super) fn read_outlets(document: &SceneTable<'_>) -> Result<Vec<Outlet>, SceneError> {
    let mut problems = Problems::default();
    let mut list: Vec<Outlet> = Vec::new();
    for table in document.tables("outlets")?.into_iter().flatten() {
        let read = table.and_then(|table| {
            let outlet = read_outlet(&table)?;
            if list.iter().any(|other| in_heading(&other.name) == in_heading(&outlet.name)) {
                return Err(table.bad(
                    "name",
                    "another outlet has this name, or one that gives the same columns; rename one",
                ));
            }
            if list.len() == MOST {
                return Err(table.bad("name", format!("more than {MOST} outlets; merge some")));
            }
            Ok(outlet)
        });
        list.extend(problems.keep(read));
    }
    problems.finish()?;
    list.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(list)
}

fn read_outlet(table: &SceneTable<'_>) -> Result<Outlet, SceneError> {
    let name = table.text("name")?;
    let name = table.need(name, "name", "give the outlet a name, as name = \"left bin\"")?.to_owned();
    let ends = Axis::ALL.into_iter().flat_map(|axis| [(axis, Side::Min), (axis, Side::Max)]);
    let faces: Vec<_> = ends.map(|(axis, side)| (axis.face_name(side), (axis, side))).collect();
    let region = match (table.table("region")?, table.word("face", &faces)?) {
        (Some(region), None) => OutletRegion::Volume(read_volume(table, &region, "box, cylinder")?),
        (None, Some((axis, side))) => OutletRegion::Face(axis, side),
        (Some(_), Some(_)) => {
            return Err(table.bad("face", "region is given too; give exactly one of them"));
        }
        (None, None) => {
            return Err(table.missing(
                "region",
                "give region = { box = { min_m, max_m } }, { cylinder = { base_m, top_m, radius_m } }, or \
                 face = \"z_min\"",
            ));
        }
    };
    Ok(Outlet { name, region, each: table.boolean("each")?.unwrap_or(false) })
}
