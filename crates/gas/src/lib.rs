//! Grains and a gas whose flow another program computes on cells, a [`FlowSolver`].
//!
//! [`Mapping`] says which share of a grain each cell near it has. [`Exchange`] says what grains and gas
//! give each other through these shares.
#![forbid(unsafe_code)]

mod error;
mod exchange;
mod flow_solver;
mod mapping;
mod shapes;

pub use error::GasError;
pub use exchange::{Exchange, ExchangeExtremes, ExchangeSeconds, ExchangeState, GrainsView};
pub use flow_solver::{ConnectFlow, FlowRequest, FlowSolver, FlowValues};
pub use mapping::Mapping;
pub use shapes::CellShapes;
