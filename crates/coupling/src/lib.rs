//! Who waits for whom: the far field in another process, or a stand-in for it in this one.

mod box_solver;

pub use box_solver::BoxSolver;
