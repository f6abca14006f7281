//! Motion, contacts, charge and field of whole runs.

#[path = "../common/mod.rs"]
mod common;

mod automatic_step;
mod beds;
mod boxes;
mod charge_of_moving_walls;
mod charged_gas;
mod charging;
mod cohesion;
mod collisions;
mod determinism;
mod feeds;
mod few_steps;
mod field;
mod filled;
mod fixed_grains;
mod forecasts;
mod gas;
mod guards;
mod loose_grains;
mod mesh_motion;
mod moving_walls;
mod oblique;
mod outlets;
mod overlaps;
mod potentials;
mod rolling;
mod start;
mod wall_loads;
mod walls;
