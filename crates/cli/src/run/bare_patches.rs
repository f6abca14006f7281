//! Patches of the solver's mesh at which nothing holds the grains.

use amberfield_core::Vector3;
use amberfield_dem::WallCover;
use amberfield_field::far::{Condition, FarMesh};
use amberfield_scene::Scene;

/// Share of a patch's area without a wall up to which the patch counts as one.
const SMALL_SHARE: f64 = 0.1;
/// Distance from a wall within which a face's centre counts as covered, over the face's size: less than that
/// of a floor from the lowest faces of the walls around it.
const CLOSE: f64 = 0.25;

/// Area of a patch [m²].
#[derive(Clone, Copy, Default)]
struct Area {
    /// Area of the faces that are solid matter.
    solid: f64,
    /// Area of those of them at which no wall stands.
    bare: f64,
}

/// Warning about the solid patches of the mesh at which the scene has no wall, where grains move.
///
/// The mesh bounds the field and the gas. Grains meet only what stands under `[[walls]]`. A wall that names
/// a patch and stands elsewhere leaves the patch bare, too.
pub(super) fn warning_of_bare_patches(scene: &Scene, mesh: &FarMesh) -> Option<String> {
    if scene.time.is_none() || scene.particles.is_empty() {
        return None;
    }
    // Walls that make no sense are refused when the run starts.
    let cover = WallCover::new(&scene.walls).ok()?;
    let mut areas = vec![Area::default(); mesh.patches().len()];
    for face in mesh.boundary() {
        let patch = face.patch as usize;
        let close = CLOSE * face.area.sqrt();
        let is_solid = is_solid(scene, &mesh.patches()[patch].kind, face.condition);
        if is_solid && is_within_reach(scene, face.centre, close) {
            areas[patch].solid += face.area;
            if !cover.covers(face.centre, close) {
                areas[patch].bare += face.area;
            }
        }
    }
    let bare = mesh.patches().iter().zip(&areas).filter(|(_, area)| area.bare > SMALL_SHARE * area.solid);
    let names: Vec<&str> = bare.map(|(patch, _)| patch.name.as_str()).collect();
    let first = names.first()?;
    Some(format!(
        "no wall of the scene stands at these patches of the mesh, and grains pass through them: {}; add \
         [[walls]] with patch = \"{first}\" and a material, and so on for each that shall hold them",
        names.join(", ")
    ))
}

/// Whether a face is solid matter: a wall, or an electrode where no gas flows through patches.
fn is_solid(scene: &Scene, kind: &str, condition: Condition) -> bool {
    let flows = scene.gas.is_some_and(|gas| gas.flow.is_some())
        || scene.solver.as_ref().is_some_and(|solver| solver.application.is_some());
    match kind {
        "patch" => !flows && matches!(condition, Condition::Potential(_)),
        _ => kind.to_lowercase().ends_with("wall"),
    }
}

/// Whether a place [m] is in the box in which grains move, or within a distance [m] of it.
fn is_within_reach(scene: &Scene, place: Vector3<f64>, distance: f64) -> bool {
    scene.domain.as_ref().is_none_or(|domain| {
        let (low, high) = (domain.min().add_scalar(-distance), domain.max().add_scalar(distance));
        (0..3).all(|axis| (low[axis]..=high[axis]).contains(&place[axis]))
    })
}
