//! Grains from files.

mod columns;
mod csv_reader;

pub(crate) use csv_reader::{CsvContext, ReadParticles, read_charges, read_particles};
