//! Moves grains: neighbours, contacts with history, walls, integrator, step, checkpoint state.
