//! What a scene may ask for and this version does not have: refused by name, never ignored.

use crate::failure::Failure;
use amberfield_scene::Scene;

/// Refuses a scene that asks for what is not built. Without motion nothing touches.
pub(crate) fn refuse(scene: &Scene, motion: bool) -> Result<(), Failure> {
    let field = scene.electric_field.as_ref();
    let asked = [
        (scene.gas, "coupled gas flow", "remove [gas]"),
        (
            motion && field.is_some_and(|field| field.enable_collision_charge_transfer),
            "charge transfer on contact",
            "set electric_field.enable_collision_charge_transfer = false",
        ),
    ];
    let lines: Vec<String> = asked
        .into_iter()
        .filter(|(asked, _, _)| *asked)
        .map(|(_, what, advice)| format!("this version has no {what}; {advice}"))
        .collect();
    if lines.is_empty() { Ok(()) } else { Err(Failure::bad_input(lines.join("\n"))) }
}
