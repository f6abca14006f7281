//! Particles from CSV files: one row per grain.

mod columns;
mod csv_reader;
mod quantity;

pub(crate) use csv_reader::{CsvContext, ReadParticles, read_charges, read_particles};
