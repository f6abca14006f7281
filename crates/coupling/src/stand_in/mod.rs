//! A field solver in this process: a stand-in for the other process in tests and comparisons.

mod box_solver;

pub use box_solver::BoxSolver;
