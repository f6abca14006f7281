//! Pictures of a run's grains.

use amberfield_dem::Simulation;
use amberfield_scene::Scene;
use std::path::Path;

/// Draws the grains; a picture that fails is a warning, the results stand.
#[cfg(feature = "plots")]
pub(crate) fn draw(path: &Path, scene: &Scene, simulation: &Simulation) {
    use amberfield_draw::{PictureScene, write_picture};
    let Some(mut domain) = scene.domain.clone() else { return };
    domain.set_time(simulation.time_s());
    let picture = PictureScene {
        title: &scene.title,
        time_s: Some(simulation.time_s()),
        domain: &domain,
        walls: &super::walls::now(scene, simulation),
        feeds: &scene.feeds.list,
        outlets: &scene.outlets,
        particles: &simulation.particles(),
    };
    if let Err(error) = write_picture(path, &picture) {
        tracing::warn!("no picture: {error}");
    }
}

/// Draws nothing: a program without the feature has no pictures.
#[cfg(not(feature = "plots"))]
pub(crate) fn draw(_: &Path, _: &Scene, _: &Simulation) {}
