//! Stages that a scene has, and why.

use crate::contacts::material_pairs::Features;
use crate::feeding::Feeding;
use crate::field_stage::FieldStage;
use crate::gas_stage::GasStage;
use amberfield_core::{ChargeTransfer, Cohesion, Plan};

/// Properties of a scene that decide which stages are built.
pub(super) struct Planned<'a> {
    pub(super) features: Features,
    /// Whether an axis is periodic.
    pub(super) periodic: bool,
    /// Number of walls.
    pub(super) walls: usize,
    /// Whether a wall moves.
    pub(super) moving: bool,
    /// Levels of size of the neighbour search.
    pub(super) levels: usize,
    /// Number of grains that never move.
    pub(super) fixed: usize,
    pub(super) feeding: Option<&'a Feeding>,
    /// Number of outlets.
    pub(super) outlets: usize,
    pub(super) gas: Option<&'a GasStage>,
    pub(super) transfer: Option<&'a ChargeTransfer>,
    /// Whether the scene asks for a field, which is left out where nothing is charged.
    pub(super) field_asked: bool,
    pub(super) field: Option<&'a FieldStage>,
}

/// The plan of a run, with the field's own plan at its end.
pub(super) fn plan(planned: &Planned<'_>) -> Plan {
    let &Planned { features, periodic, walls, moving, levels, fixed, feeding, outlets, .. } = planned;
    let &Planned { gas, transfer, field_asked, field, .. } = planned;
    let tangential = match features.cohesion {
        Cohesion::None => "a pair of materials has friction",
        _ => "contacts that stick have a memory",
    };
    let mut plan = Plan::new();
    plan.decide(true, "integrate", "velocity Verlet, every step".to_owned(), "");
    let grids = format!("linked cells on {levels} level(s) of size, Verlet lists rebuilt by displacement");
    plan.decide(true, "neighbours", grids, "");
    plan.decide(true, "contacts", "Hertz contacts of grains".to_owned(), "");
    plan.decide(
        features.cohesion != Cohesion::None,
        "cohesion",
        format!("{}: contacts stick by their surface energies", features.cohesion.name()),
        "no contacts.cohesion",
    );
    plan.decide(walls > 0, "walls", format!("{walls} wall(s)"), "no wall");
    plan.decide(moving, "moving walls", "a wall has a motion".to_owned(), "no wall has a motion");
    plan.decide(
        features.damping,
        "contact damping",
        "a restitution is below 1".to_owned(),
        "every restitution is 1",
    );
    plan.decide(
        features.friction,
        "tangential history",
        tangential.to_owned(),
        "no pair of materials has friction",
    );
    plan.decide(
        features.rolling,
        "rolling friction",
        format!("{}: a pair of materials has rolling friction", features.rolling_model.name()),
        "no pair of materials has rolling friction",
    );
    plan.decide(
        features.rotation(),
        "rotation",
        "friction can turn grains".to_owned(),
        "nothing can turn a grain",
    );
    plan.decide(periodic, "periodic images", "an axis is periodic".to_owned(), "no axis is periodic");
    plan.decide(
        fixed > 0,
        "fixed grains",
        format!("{fixed} grain(s) of particles.fixed_groups never move"),
        "no particles.fixed_groups",
    );
    let [feeds, fed] = feeding.map_or([0; 2], Feeding::size);
    plan.decide(feeds > 0, "feeds", format!("{feeds} feed(s) with {fed} grains"), "no [[feeds]]");
    plan.decide(outlets > 0, "outlets", format!("{outlets} outlet(s)"), "no [[outlets]]");
    plan.decide(gas.is_some(), "gas", gas.map_or(String::new(), GasStage::about), "no [gas]");
    plan_charging(&mut plan, transfer);
    let reason = if field_asked {
        "every charge in the particle group is zero and nothing makes one"
    } else {
        "no [electric_field]"
    };
    let charged = if transfer.is_some() { "charges, or what makes them" } else { "charged grains" };
    if field.is_some() {
        plan.build("field", charged)
    } else {
        plan.leave_out("field", reason)
    }
    if let Some(field) = field {
        plan.extend(field.source.field.plan());
    }
    plan
}

/// Charge transfer and its refinements.
fn plan_charging(plan: &mut Plan, transfer: Option<&ChargeTransfer>) {
    plan.decide(
        transfer.is_some(),
        "charging",
        "enable_collision_charge_transfer: charge moves where contacts grow".to_owned(),
        "no enable_collision_charge_transfer",
    );
    let Some(transfer) = transfer else { return };
    plan.decide(
        transfer.beyond_previous_maximum,
        "largest contact areas",
        "beyond_previous_maximum: only what grows beyond moves charge".to_owned(),
        "no beyond_previous_maximum",
    );
    let breakdown = transfer.breakdown_field_v_m;
    let limit = format!("breakdown_field_V_m = {:e}", breakdown.unwrap_or_default());
    plan.decide(breakdown.is_some(), "dielectric breakdown", limit, "no breakdown_field_V_m");
    plan.decide(
        transfer.stiffness_correction.is_some(),
        "contact-area correction",
        "stiffness_correction: areas scaled towards young_real_Pa".to_owned(),
        "no stiffness_correction",
    );
}
