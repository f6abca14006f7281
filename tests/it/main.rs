//! Tests of the commands: exit codes, messages, files.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

mod any_bytes;
mod bad_input;
mod convert;
mod errors_page;
mod explain_and_doctor;
mod faults;
mod feeds;
mod field;
mod files;
mod filled;
mod host_library;
mod interrupt;
mod moving_walls;
mod openfoam;
mod outlets;
mod potentials;
mod run;
mod scenes;
mod start;
mod study;
mod wall_fields;
mod what_must_not_matter;
