//! Text of a plan.

use amberfield_core::Plan;

/// Lines of a plan: the stages that run, then those that are left out.
pub(crate) fn lines(plan: &Plan) -> Vec<String> {
    let width = plan.stages().iter().chain(plan.left_out()).map(|entry| entry.stage.len()).max().unwrap_or(0);
    let mut lines = vec!["runs:".to_owned()];
    lines.extend(plan.stages().iter().map(|entry| format!("  {:width$}  {}", entry.stage, entry.reason)));
    lines.push("left out:".to_owned());
    lines.extend(plan.left_out().iter().map(|entry| format!("  {:width$}  {}", entry.stage, entry.reason)));
    lines
}
