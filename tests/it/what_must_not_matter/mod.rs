//! Changes of a scene that physics does not see, after which the same answer is demanded.
//!
//! One line of a list is one change: another frame, other units, another order, a wall far away. Whoever adds
//! a feature adds its line. [`field`] has the lines of the electric field over a mesh, by the stand-in for a
//! field solver, which takes no other process; [`field_over_openfoam`] has those that OpenFOAM's files and
//! processes make; [`flange`] has OpenFOAM's own example; [`walls`] has contacts, [`charge_on_walls`] what
//! they charge, [`moving`] walls that move, [`runs`] whole runs by the binary, [`rest`] charges that start
//! from rest, and [`leaving`] grains that leave through faces.

mod boxes;
mod charge_on_walls;
mod field;
mod field_over_openfoam;
mod flange;
mod foam_boxes;
mod leaving;
mod lines;
mod moving;
mod rest;
mod runs;
mod scene;
mod walls;
