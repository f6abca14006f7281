//! The field stages that a scene has, with the reason for each.

use crate::choosing::choice::Choice;
use amberfield_core::{Conductor, ConductorState, Domain, FieldSettings, Plan};

/// Course of the faces' potentials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Potentials {
    /// Potentials that stay as they are.
    Stay,
    /// Potentials that change, and make a uniform field.
    Uniform,
    /// Potentials that change, and make a field that differs from place to place.
    Varied,
    /// Potentials of a field solver's patches that change.
    OfPatches,
}

/// Stages of a scene's field and what it leaves out; over a solver's mesh of so many cells, if there is one.
pub(crate) fn plan(
    domain: &Domain,
    settings: &FieldSettings,
    choice: &Choice,
    mesh_cells: Option<usize>,
    potentials: Potentials,
) -> Plan {
    let mut plan = Plan::new();
    match choice {
        Choice::Cutoff { cutoff_m } => {
            plan.build("near", format!("method cutoff: pairs within r_c = {cutoff_m:.4e} m, nothing beyond"));
            plan.leave_out("grid", "method cutoff has no far level");
        }
        Choice::Direct => plan.build("pairs", "method direct: every pair and every image"),
        Choice::Kolehmainen { cutoff_m } => {
            plan.build("mesh", "method kolehmainen: nearest-cell charge, field constant in a cell");
            plan.build("pairs", format!("near sum and correction within r_c = {cutoff_m:.4e} m"));
        }
        Choice::AllPairs => {
            plan.build("near", "open space and few grains: every pair costs less than a grid");
            plan.leave_out("grid", "the near level covers the domain");
        }
        Choice::P3m(parameters) => {
            plan.build(
                "near",
                format!(
                    "pairs and images within r_c = {:.4e} m, for tolerance {:e}",
                    parameters.cutoff_m, settings.tolerance
                ),
            );
            let stage = if mesh_cells.is_some() { "middle" } else { "grid" };
            plan.build(
                stage,
                format!(
                    "smooth part, on nodes {:.4e} m apart, window of order {}",
                    parameters.spacing_m, parameters.order
                ),
            );
        }
    }
    match mesh_cells {
        Some(cells) => {
            plan.build(
                "far",
                format!("what is smooth on {cells} cells of the field solver, with its boundary conditions"),
            );
            plan.leave_out("grid", "the field solver's mesh carries the far level");
        }
        None => {
            plan.leave_out(
                "middle",
                "no external field solver: the internal grid carries middle and far level",
            );
        }
    }
    plan_surfaces(&mut plan, settings);
    plan_given(&mut plan, settings, potentials);
    let images = domain.faces().iter().flatten().any(|face| face.is_conductor() || face.is_insulating());
    if !images && settings.conductors.is_empty() {
        plan.leave_out("images", "no conducting or insulating face");
    }
    plan
}

/// Plans the surfaces of conductors, if there are any.
fn plan_surfaces(plan: &mut Plan, settings: &FieldSettings) {
    if settings.conductors.is_empty() {
        plan.leave_out("surfaces", "no wall has a field");
        return;
    }
    let of = |conductor: &Conductor| {
        let facets = conductor.surface.triangles.len();
        let state = match conductor.state {
            ConductorState::Potential(volts) => format!("at {volts} V"),
            ConductorState::Charge(charge) => format!("floating with {charge:e} C"),
        };
        (facets, format!("{} {state}, {facets} facets", conductor.name))
    };
    let (facets, names): (Vec<usize>, Vec<String>) = settings.conductors.iter().map(of).unzip();
    let facets: usize = facets.iter().sum();
    let megabytes = 4e-6 * (facets as f64).powi(2);
    plan.build("surfaces", format!("{}; their matrix has {megabytes:.1} MB", names.join("; ")));
}

/// Plans what the scene gives: the external field, and potentials that change.
fn plan_given(plan: &mut Plan, settings: &FieldSettings, potentials: Potentials) {
    if settings.external_course.is_some() {
        plan.build("external", "external_field_V_m is given, and changes with time: exact in every step");
    } else if settings.external_field_v_m == nalgebra::Vector3::zeros() {
        plan.leave_out("external", "external_field_V_m is zero");
    } else {
        plan.build("external", "external_field_V_m is given");
    }
    match potentials {
        Potentials::Stay => {}
        Potentials::Uniform => plan.build(
            "potentials",
            "potentials of faces change with time, and their field is uniform: exact in every step",
        ),
        Potentials::Varied => plan.build(
            "potentials",
            "potentials of faces change with time, and their field is not uniform: at least 20 evaluations \
             in a period, or along a line of a table",
        ),
        Potentials::OfPatches => plan.build(
            "potentials",
            "potentials of the case's patches change with time: the field solver tells them, and evaluations \
             follow where a straight line does not",
        ),
    }
}
