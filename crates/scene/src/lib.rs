//! Scene file to validated description; reads particles and STL, writes VTK, CSV and checkpoints.
