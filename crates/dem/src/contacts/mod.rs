//! Contacts of grains with each other and with walls: who is near whom, the law, the histories.

pub(crate) mod batch;
pub(crate) mod cells;
pub(crate) mod law;
pub(crate) mod material_pairs;
pub(crate) mod memory;
pub(crate) mod neighbours;
pub(crate) mod pairs;
pub(crate) mod walls;
