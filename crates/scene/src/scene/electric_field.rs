//! Section `[electric_field]`, as keys or as one command line.

use super::command::{COMMAND_KEYS, command_entries};
use super::description::ElectricFieldSettings;
use crate::SceneError;
use crate::limits::{ELECTRIC, FRACTION, LENGTH, TOLERANCE};
use crate::tree::{Entries, Node, Range, SceneTable, Value};
use amberfield_core::{CouplingInterval, ForceLimit, Method, Permittivity, Tuning};

/// Keys of `[electric_field]` that the command line does not have.
const FURTHER_KEYS: [&str; 10] = [
    "method",
    "tolerance",
    "external_field_V_m",
    "coupling_interval",
    "overlap",
    "tuning",
    "far_tolerance",
    "neutralising_background",
    "grid",
    "command",
];
/// Largest number of cells of the internal grid per axis.
const MOST_CELLS: i64 = 1 << 16;

/// Reads `[electric_field]`.
pub(super) fn read_electric_field(
    document: &SceneTable<'_>,
) -> Result<Option<ElectricFieldSettings>, SceneError> {
    let keys: Vec<&str> = COMMAND_KEYS.iter().map(|(key, _)| *key).chain(FURTHER_KEYS).collect();
    let Some(table) = document.table("electric_field", &keys)? else { return Ok(None) };
    let Some(command) = table.text("command")? else { return read_keys(&table).map(Some) };
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
    read_keys(&SceneTable::new(&inner, "electric_field", &keys)?).map(Some)
}

fn read_keys(table: &SceneTable<'_>) -> Result<ElectricFieldSettings, SceneError> {
    let mut read = ElectricFieldSettings::default();
    read_common(table, &mut read)?;
    let field = &mut read.field;
    let methods = Method::ALL.map(|method| (method.name(), method));
    field.method = table.word("method", &methods)?.unwrap_or(field.method);
    field.tolerance = table.number("tolerance", TOLERANCE)?.unwrap_or(field.tolerance);
    field.external_field_v_m =
        table.vector("external_field_V_m", ELECTRIC)?.unwrap_or(field.external_field_v_m);
    field.coupling_interval = read_interval(table)?;
    let tunings = [("timed", Tuning::Timed), ("model", Tuning::Model)];
    field.tuning = table.word("tuning", &tunings)?.unwrap_or_default();
    field.neutralising_background = table.boolean("neutralising_background")?.unwrap_or(false);
    field.grid_cells = read_grid(table)?;
    read.field.overlap = table.boolean("overlap")?.unwrap_or(false);
    read.far_tolerance = table.number_or_auto("far_tolerance", TOLERANCE)?.flatten();
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
    for (key, range, number) in [
        ("charge_transfer_cutoff", LENGTH, &mut read.charge_transfer_cutoff_m),
        ("field_force_limit_factor", FRACTION, &mut read.field_force_limit_factor),
        // A medium thinner than vacuum does not exist; metals are boundaries, not media.
        ("relative_permittivity", Range::closed(1.0, 1e6), &mut relative_permittivity),
    ] {
        *number = table.number(key, range)?.unwrap_or(*number);
    }
    read.field.permittivity = Permittivity::from_relative(relative_permittivity);
    read.field.cutoff_radius_m = table.number("field_cutoff_radius", LENGTH)?;
    read.field.force_limit =
        read.limit_field_force.then_some(ForceLimit { factor: read.field_force_limit_factor });
    Ok(())
}

fn read_interval(table: &SceneTable<'_>) -> Result<CouplingInterval, SceneError> {
    match table.get("coupling_interval").map(|node| &node.value) {
        None => Ok(CouplingInterval::Auto),
        Some(Value::Text(word)) if word == "auto" => Ok(CouplingInterval::Auto),
        Some(Value::Integer(_)) => {
            let steps =
                table.integer("coupling_interval", 1, i64::from(u32::MAX))?.expect("the key is there");
            Ok(CouplingInterval::Steps(u32::try_from(steps).expect("the range ends at u32::MAX")))
        }
        Some(_) => {
            Err(table.bad("coupling_interval", "give \"auto\" or a whole number of steps, at least 1"))
        }
    }
}

fn read_grid(table: &SceneTable<'_>) -> Result<Option<[usize; 3]>, SceneError> {
    let Some(grid) = table.table("grid", &["cells"])? else { return Ok(None) };
    let advice = format!("give \"auto\" or three whole numbers from 1 to {MOST_CELLS}, as [64, 64, 128]");
    let Some(node) = grid.get("cells") else { return Err(grid.missing("cells", advice)) };
    let items = match &node.value {
        Value::Text(word) if word == "auto" => return Ok(None),
        Value::Array(items) if items.len() == 3 => items,
        _ => return Err(grid.bad("cells", advice)),
    };
    let mut cells = [0; 3];
    for (count, item) in cells.iter_mut().zip(items) {
        *count = match item.value {
            Value::Integer(number) if (1..=MOST_CELLS).contains(&number) => {
                usize::try_from(number).expect("the range is positive")
            }
            _ => return Err(grid.bad("cells", advice)),
        };
    }
    Ok(Some(cells))
}
