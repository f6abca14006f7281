//! Cells of OpenFOAM cases that are cut into smaller ones.

use crate::Workbench;
use crate::foam_case::{foam_command_on, foam_program, write_file};

/// Cuts the cells of a mesh whose centres are in a box \[m\] into eight each.
pub fn refine(bench: &Workbench, low: [f64; 3], high: [f64; 3]) {
    let corner = |[x, y, z]: [f64; 3]| format!("({x} {y} {z})");
    let (low, high) = (corner(low), corner(high));
    write_file(
        bench,
        "system/topoSetDict",
        "dictionary",
        &format!(
            "actions ({{ name fine; type cellSet; action new; source boxToCell; box {low} {high}; }});\n"
        ),
    );
    write_file(
        bench,
        "system/refineMeshDict",
        "dictionary",
        "set fine; coordinateSystem global; globalCoeffs { tan1 (1 0 0); tan2 (0 1 0); } directions (tan1 \
         tan2 normal); useHexTopology yes; geometricCut no; writeMesh no;\n",
    );
    foam_program(bench, "topoSet", &[]);
    foam_command_on(bench, "refineMesh", &["-overwrite", "-dict", "system/refineMeshDict"]);
}
