//! Places of charges and of their images: the images that a domain's faces make, lists of cells, checks of
//! the input.

pub(crate) mod image_cells;
pub(crate) mod images;
pub(crate) mod inputs;
pub(crate) mod uncut;
