//! Section `[electric_field]`, as keys or as one command line.

use super::command::command_entries;
use super::course::{Given, read_field};
use super::description::ElectricFieldSettings;
use crate::SceneError;
use crate::source::SceneSource;
use crate::table::SceneTable;
use crate::tree::{Entries, Node, Value};
use amberfield_core::{CouplingInterval, ForceLimit, Method, Permittivity, Tuning};

/// Reads `[electric_field]`.
pub(super) fn read_electric_field(
    document: &SceneTable<'_>,
    source: &mut SceneSource,
) -> Result<Option<ElectricFieldSettings>, SceneError> {
    let Some(table) = document.table("electric_field")? else { return Ok(None) };
    let Some(command) = table.text("command")? else { return read_keys(&table, source).map(Some) };
    if let Some(key) = table.keys().find(|key| !["command", "method", "tolerance"].contains(key)) {
        return Err(table.bad(
            key,
            "command excludes every other key but method and tolerance; \
             move it into the command or write keys only",
        ));
    }
    let node = table.get("command").expect("it was just read");
    let mut entries: Entries = command_entries(command, node)?;
    for key in ["method", "tolerance"] {
        entries.extend(table.get(key).map(|node| (key.to_owned(), node.clone())));
    }
    let inner = Node { value: Value::Table(entries), place: node.place.clone() };
    let table = SceneTable::new(&inner, "electric_field", document.entry("electric_field"))?;
    read_keys(&table, source).map(Some)
}

fn read_keys(table: &SceneTable<'_>, source: &mut SceneSource) -> Result<ElectricFieldSettings, SceneError> {
    let mut read = ElectricFieldSettings::default();
    read_common(table, &mut read)?;
    let field = &mut read.field;
    let methods = Method::ALL.map(|method| (method.name(), method));
    field.method = table.word("method", &methods)?.unwrap_or(field.method);
    field.tolerance = table.number("tolerance")?.unwrap_or(field.tolerance);
    match read_field(table, "external_field_V_m", source)? {
        Some(Given::Constant(external)) => field.external_field_v_m = external,
        Some(Given::Changing(course)) => {
            field.external_field_v_m = course.at(0.0);
            field.external_course = Some(course);
        }
        None => {}
    }
    field.coupling_interval = read_interval(table)?;
    let tunings = [("timed", Tuning::Timed), ("model", Tuning::Model)];
    field.tuning = table.word("tuning", &tunings)?.unwrap_or_default();
    field.neutralising_background = table.boolean("neutralising_background")?.unwrap_or(false);
    field.grid_cells = read_grid(table)?;
    read.field.overlap = table.boolean("overlap")?.unwrap_or(false);
    read.far_tolerance = table.number_or_auto("far_tolerance")?.flatten();
    let needs_cutoff = matches!(read.field.method, Method::Kolehmainen | Method::Cutoff);
    if needs_cutoff && read.field.cutoff_radius_m.is_none() {
        return Err(table.missing(
            "field_cutoff_radius",
            format!("method {} needs a cut-off radius in metres", read.field.method),
        ));
    }
    Ok(read)
}

/// Reads the keys that the command line has too.
fn read_common(table: &SceneTable<'_>, read: &mut ElectricFieldSettings) -> Result<(), SceneError> {
    if let Some(id) = table.text("id")? {
        id.clone_into(&mut read.id);
    }
    if let Some(group) = table.text("particle_group")? {
        group.clone_into(&mut read.particle_group);
    }
    for (key, flag) in [
        ("use_without_cfd_coupling", &mut read.use_without_cfd_coupling),
        ("enable_collision_charge_transfer", &mut read.enable_collision_charge_transfer),
        ("limit_field_force", &mut read.limit_field_force),
    ] {
        *flag = table.boolean(key)?.unwrap_or(*flag);
    }
    let mut relative_permittivity = read.field.permittivity.relative();
    for (key, number) in [
        ("charge_transfer_cutoff", &mut read.charge_transfer_cutoff_m),
        ("field_force_limit_factor", &mut read.field_force_limit_factor),
        ("relative_permittivity", &mut relative_permittivity),
    ] {
        *number = table.number(key)?.unwrap_or(*number);
    }
    read.field.permittivity = Permittivity::from_relative(relative_permittivity);
    read.field.cutoff_radius_m = table.number("field_cutoff_radius")?;
    read.field.force_limit =
        read.limit_field_force.then_some(ForceLimit { factor: read.field_force_limit_factor });
    Ok(())
}

fn read_interval(table: &SceneTable<'_>) -> Result<CouplingInterval, SceneError> {
    Ok(match table.integer("coupling_interval")? {
        Some(steps) => CouplingInterval::Steps(u32::try_from(steps).expect("the range ends at u32::MAX")),
        None => CouplingInterval::Auto,
    })
}

fn read_grid(table: &SceneTable<'_>) -> Result<Option<[usize; 3]>, SceneError> {
    let Some(grid) = table.table("grid")? else { return Ok(None) };
    let cells = grid.integers("cells")?;
    if !grid.has("cells") {
        return Err(grid.missing("cells", "give \"auto\" or three whole numbers, as [64, 64, 128]"));
    }
    Ok(cells.map(|cells| cells.map(|count| usize::try_from(count).expect("the range is positive"))))
}
