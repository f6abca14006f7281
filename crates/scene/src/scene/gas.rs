//! Section `[gas]`.

use crate::SceneError;
use crate::table::SceneTable;
use crate::tree::Range;
use amberfield_core::{DragLaw, Gas, GasFlow, GasModel};

/// Density of dry air at 20 °C and 101325 Pa [kg/m³] (CRC Handbook of Chemistry and Physics).
const AIR_DENSITY: f64 = 1.204;
/// Viscosity of dry air at 20 °C and 101325 Pa [Pa·s] (CRC Handbook of Chemistry and Physics).
const AIR_VISCOSITY: f64 = 1.82e-5;
/// Keys that only a gas with a computed flow has.
const FLOW_KEYS: [&str; 6] =
    ["model", "interval_s", "smoothing_length_m", "viscous_force", "saffman_lift", "overlap"];

/// Reads `[gas]`; the defaults are those of air at 20 °C at rest.
pub(super) fn read_gas(document: &SceneTable<'_>) -> Result<Option<Gas>, SceneError> {
    let Some(table) = document.table("gas")? else { return Ok(None) };
    let laws = DragLaw::ALL.map(|law| (law.name(), law));
    let flows = table.word("flow", &[("uniform", false), ("solver", true)])?.unwrap_or(false);
    let flow = if flows { Some(read_flow(document, &table)?) } else { None };
    if let Some(key) = FLOW_KEYS.iter().find(|key| !flows && table.has(key)) {
        return Err(table.bad(key, "needs a flow that is computed; set flow = \"solver\", or leave it out"));
    }
    // A flow solver divides by the density; a uniform gas without density has no inertial drag.
    let densities = if flows { Range::positive(1e6) } else { Range::closed(0.0, 1e6) };
    Ok(Some(Gas {
        drag: table.word("drag", &laws)?.unwrap_or_default(),
        density_kg_m3: table.number_in("density_kg_m3", densities)?.unwrap_or(AIR_DENSITY),
        viscosity_pa_s: table.number("viscosity_Pa_s")?.unwrap_or(AIR_VISCOSITY),
        velocity_m_s: table.vector("velocity_m_s")?.unwrap_or_default(),
        magnus_lift: table.boolean("magnus_lift")?.unwrap_or(false),
        flow,
    }))
}

/// Reads the keys of a gas whose flow is computed by the scene's solver.
fn read_flow(document: &SceneTable<'_>, table: &SceneTable<'_>) -> Result<GasFlow, SceneError> {
    if !document.has("solver") {
        return Err(table.bad("flow", "a solver must compute the flow; add [solver] with openfoam_case"));
    }
    if table.has("velocity_m_s") {
        return Err(table
            .bad("velocity_m_s", "the flow is computed; leave it out, and set 0/U of the case of [solver]"));
    }
    let flow = GasFlow {
        model: table.word("model", &[("A", GasModel::A), ("B", GasModel::B)])?.unwrap_or_default(),
        interval_s: table.need_number("interval_s")?,
        smoothing_length_m: table.number("smoothing_length_m")?,
        viscous_force: table.boolean("viscous_force")?.unwrap_or(false),
        saffman_lift: table.boolean("saffman_lift")?.unwrap_or(false),
        overlap: table.boolean("overlap")?.unwrap_or(false),
    };
    if flow.viscous_force && flow.model == GasModel::B {
        return Err(table.bad(
            "viscous_force",
            "in model B the viscous stress acts on the gas alone; leave it out, or set model = \"A\"",
        ));
    }
    Ok(flow)
}
