//! What a scene may ask for and this version does not have: refused by name, never ignored.

use crate::failure::Failure;
use amberfield_scene::Scene;

/// Refuses a scene that asks for what is not built.
pub(crate) fn refuse(scene: &Scene) -> Result<(), Failure> {
    if scene.gas {
        return Err(Failure::bad_input("this version has no coupled gas flow; remove [gas]"));
    }
    Ok(())
}
