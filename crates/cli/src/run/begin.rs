//! Begin of a run, with or without the contacts of another one.

use super::session::Saved;
use crate::failure::Failure;
use amberfield_dem::{Earlier, Setup, Simulation};
use amberfield_scene::{Filled, Scene, read_checkpoint_of_any};

/// Begins a run of a scene's set-up, with the contacts of the run from whose checkpoint its grains are.
pub(crate) fn begin(scene: &Scene, setup: Setup) -> Result<Simulation, Failure> {
    let simulation = match &scene.filled {
        None => Simulation::new(setup),
        Some(Filled { checkpoint, rules, is_same, .. }) => {
            let Saved { state, .. } = read_checkpoint_of_any(checkpoint)?;
            Simulation::filled(setup, Earlier { state, rules: rules.clone(), is_same: *is_same })
        }
    };
    simulation.map_err(|error| Failure::of_scene(scene, &error))
}
