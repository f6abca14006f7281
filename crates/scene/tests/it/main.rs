//! Tests of the scene crate through its public functions.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

mod any_input;
mod bad_scenes;
mod common;
mod dialects;
mod dumps;
mod feeds;
mod filled;
mod generators;
mod good_scenes;
mod keys;
mod lists;
mod outputs;
mod potentials;
mod round_trips;
mod vtk_files;
mod wall_fields;
