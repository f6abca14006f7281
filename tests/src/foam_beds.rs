//! Meshes of many kinds for beds that a gas flows through, from `inlet` to `outlet` along z between `walls`.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use crate::Workbench;
use crate::foam_case::{Random, foam_command_on, foam_program, write_gas_case};
use crate::foam_refinement::refine;
use std::fmt::Write as _;

/// Edge of the boxes, and length of the pipe \[mm\].
pub const EDGE_MM: f64 = 20.0;
/// Radius of the pipe \[mm\].
pub const RADIUS_MM: f64 = 10.0;

/// Kind of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BedMesh {
    /// Cubes.
    Cubes,
    /// Cuboids whose length grows eightfold along the flow.
    GradedAlong,
    /// Cuboids whose width grows eightfold across the flow.
    GradedAcross,
    /// Cubes of two sizes, with a face of one against four of the other.
    Hanging,
    /// Hexahedra with corners moved at random.
    Perturbed,
    /// Prisms on triangles, wedge-shaped around the box's edge.
    Wedges,
    /// Thin layers at the walls.
    Layers,
    /// Tetrahedra.
    Tetrahedra,
    /// Polyhedra, the duals of tetrahedra.
    Polyhedra,
    /// Hexahedra around a square in a pipe.
    Pipe,
    /// Cuboids that shrink towards the middle, to 0.12 mm.
    FineInside,
    /// Hexahedra around a square in a pipe of 27.6 mm: the geometry of CFDEMcoupling's ErgunTestMPI.
    ErgunTest,
}

impl BedMesh {
    /// All kinds whose cells are 2 to 3 mm wide.
    pub const ALL: [Self; 10] = [
        Self::Cubes,
        Self::GradedAlong,
        Self::GradedAcross,
        Self::Hanging,
        Self::Perturbed,
        Self::Wedges,
        Self::Layers,
        Self::Tetrahedra,
        Self::Polyhedra,
        Self::Pipe,
    ];

    /// Places [m] of grains that fill this mesh evenly: a cubic lattice of a spacing [m], which is to divide
    /// the edge, or as many around an axis.
    #[must_use]
    pub fn fill(self, spacing: f64) -> Vec<[f64; 3]> {
        let edge = 1e-3 * EDGE_MM;
        let count = (edge / spacing).round() as usize;
        let at = |i: usize| (i as f64 + 0.5) * spacing;
        match self {
            Self::Pipe => spirals(spacing),
            Self::Wedges => rings(spacing),
            _ => {
                let all = 0..count.pow(3);
                all.map(|i| [at(i % count), at(i / count % count), at(i / count / count)]).collect()
            }
        }
    }

    /// Writes a case of a gas of viscosity `nu` [m²/s] over this mesh, with conditions of U and p at `inlet`
    /// and `outlet`; walls let it slip.
    pub fn write(self, bench: &Workbench, inlet: [&str; 2], outlet: [&str; 2], nu: f64) {
        let conditions = |k: usize, walls: &str| {
            format!("inlet {{ {} }} outlet {{ {} }} walls {{ {walls} }}", inlet[k], outlet[k])
        };
        let recipe = match self {
            Self::GradedAlong => block([8, 8, 12], "1 1 8"),
            Self::GradedAcross => block([12, 8, 8], "8 1 1"),
            Self::Layers => {
                let layers = "((0.1 0.25 6) (0.8 0.5 1) (0.1 0.25 0.1666667))";
                block([16, 16, 8], &format!("{layers} {layers} 1"))
            }
            Self::FineInside => {
                let shrink = "((0.5 0.5 0.038462) (0.5 0.5 26))";
                block([20; 3], &format!("{shrink} {shrink} {shrink}"))
            }
            Self::Wedges => wedge(),
            Self::Pipe => pipe(RADIUS_MM, EDGE_MM, 0.42, [12, 5, 8]),
            Self::ErgunTest => pipe(13.8, 55.3, 0.5, [8, 4, 24]),
            _ => block([8; 3], "1 1 1"),
        };
        write_gas_case(
            bench,
            &recipe,
            &conditions(0, "type slip;"),
            &conditions(1, "type zeroGradient;"),
            nu,
        );
        match self {
            // One half along a diagonal of the box.
            Self::Hanging => {
                foam_program(bench, "blockMesh", &[]);
                refine(bench, [-1.0; 3], [1.0, 0.0101, 0.0101]);
            }
            Self::Perturbed => perturb(bench),
            Self::Tetrahedra => tetrahedra(bench, 7, false),
            Self::Polyhedra => tetrahedra(bench, 7, true),
            _ => {}
        }
    }
}

/// Places [m] in the pipe: in each layer a spiral whose steps turn by the golden angle and have equal areas.
fn spirals(spacing: f64) -> Vec<[f64; 3]> {
    const GOLDEN: f64 = 2.399_963_229_728_653;
    let radius = 1e-3 * RADIUS_MM;
    let of_layer = (std::f64::consts::PI * (radius / spacing).powi(2)).round() as usize;
    let layers = (1e-3 * EDGE_MM / spacing).round() as usize;
    let place = |i: usize| {
        let (layer, step) = ((i / of_layer) as f64, (i % of_layer) as f64);
        let r = radius * ((step + 0.5) / of_layer as f64).sqrt();
        let (sin, cos) = (GOLDEN * step + layer).sin_cos();
        [radius + r * cos, radius + r * sin, (layer + 0.5) * spacing]
    };
    (0..layers * of_layer).map(place).collect()
}

/// Places [m] in the quarter of a cylinder, in rings around its axis.
fn rings(spacing: f64) -> Vec<[f64; 3]> {
    let edge = 1e-3 * EDGE_MM;
    let count = (edge / spacing).round() as usize;
    let quarter = 0.5 * std::f64::consts::PI;
    let mut places = Vec::new();
    for layer in 0..count {
        for ring in 0..count {
            // As many as the area asks for, on the mean over the layers.
            let exact = quarter * (ring as f64 + 0.5);
            let whole = |layer: usize| (exact * layer as f64 + 0.5).floor();
            let of_ring = whole(layer + 1) - whole(layer);
            for place in 0..of_ring as usize {
                let (sin, cos) = (quarter * (place as f64 + 0.5) / of_ring).sin_cos();
                let r = (ring as f64 + 0.5) * spacing;
                places.push([r * cos, r * sin, (layer as f64 + 0.5) * spacing]);
            }
        }
    }
    places
}

/// Recipe of a box of so many cells.
fn block(cells: [usize; 3], grading: &str) -> String {
    let e = EDGE_MM;
    let [x, y, z] = cells;
    format!(
        "scale 1e-3;\nvertices ((0 0 0) ({e} 0 0) ({e} {e} 0) (0 {e} 0) (0 0 {e}) ({e} 0 {e}) ({e} {e} {e}) \
         (0 {e} {e}));\nblocks (hex (0 1 2 3 4 5 6 7) ({x} {y} {z}) simpleGrading ({grading}));\n\
         boundary (inlet {{ type patch; faces ((0 3 2 1)); }} outlet {{ type patch; faces ((4 5 6 7)); }}\n\
         walls {{ type wall; faces ((0 4 7 3) (1 2 6 5) (0 1 5 4) (3 7 6 2)); }});\n"
    )
}

/// Recipe of a quarter of a cylinder around the z axis in two sectors, whose inmost cells are wedges.
fn wedge() -> String {
    let e = EDGE_MM;
    let middle = |share: f64| {
        let angle = 0.5 * std::f64::consts::PI * share;
        format!("{} {}", e * angle.cos(), e * angle.sin())
    };
    let [low, half, high] = [0.25, 0.5, 0.75].map(middle);
    format!(
        "scale 1e-3;\nvertices ((0 0 0) ({e} 0 0) ({half} 0) (0 {e} 0) (0 0 {e}) ({e} 0 {e}) ({half} {e}) \
         (0 {e} {e}));\nblocks (hex (0 1 2 0 4 5 6 4) (8 10 8) simpleGrading (1 1 1) \
         hex (0 2 3 0 4 6 7 4) (8 10 8) simpleGrading (1 1 1));\n\
         edges (arc 1 2 ({low} 0) arc 2 3 ({high} 0) arc 5 6 ({low} {e}) arc 6 7 ({high} {e}));\n\
         boundary (inlet {{ type patch; faces ((0 2 1 0) (0 3 2 0)); }}\n\
         outlet {{ type patch; faces ((4 5 6 4) (4 6 7 4)); }}\n\
         walls {{ type wall; faces ((0 1 5 4) (0 4 7 3) (1 2 6 5) (2 3 7 6)); }});\n"
    )
}

/// Recipe of a pipe along z of a radius and a length [mm], around the line at this radius from both other
/// axes, with an inner square of a half edge over the radius; cells along its edge, from it to the wall, and
/// along the pipe.
fn pipe(r: f64, e: f64, square_over_radius: f64, [along, out, layers]: [usize; 3]) -> String {
    let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let mut vertices = String::new();
    for z in [0.0, e] {
        for scale in [square_over_radius * r, r / 2.0_f64.sqrt()] {
            for [x, y] in square {
                write!(vertices, "({} {} {z})", r + scale * x, r + scale * y).unwrap();
            }
        }
    }
    let mut blocks = format!("hex (0 1 2 3 8 9 10 11) ({along} {along} {layers}) simpleGrading (1 1 1)\n");
    let (mut mantle, mut below, mut above, mut edges) =
        (String::new(), "(0 3 2 1)".to_owned(), "(8 9 10 11)".to_owned(), String::new());
    for a in 0..4 {
        let b = (a + 1) % 4;
        let (c, d) = (b + 4, a + 4);
        writeln!(
            blocks,
            "hex ({a} {d} {c} {b} {} {} {} {}) ({out} {along} {layers}) simpleGrading (1 1 1)",
            a + 8,
            d + 8,
            c + 8,
            b + 8
        )
        .unwrap();
        write!(mantle, "({d} {c} {} {})", c + 8, d + 8).unwrap();
        write!(below, "({a} {b} {c} {d})").unwrap();
        write!(above, "({} {} {} {})", a + 8, d + 8, c + 8, b + 8).unwrap();
        let middle = [[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]][a].map(|x: f64| r + x * r);
        for (floor, z) in [(0, 0.0), (8, e)] {
            writeln!(edges, "arc {} {} ({} {} {z})", d + floor, c + floor, middle[0], middle[1]).unwrap();
        }
    }
    format!(
        "scale 1e-3;\nvertices ({vertices});\nblocks ({blocks});\nedges ({edges});\n\
         boundary (inlet {{ type patch; faces ({below}); }} outlet {{ type patch; faces ({above}); }}\n\
         walls {{ type wall; faces ({mantle}); }});\n"
    )
}

/// Moves the corners of a box's cells by up to a fifth of their size; those on a face stay on it.
fn perturb(bench: &Workbench) {
    foam_program(bench, "blockMesh", &[]);
    crate::foam_case::perturb(bench, EDGE_MM, 8, 0.2);
}

/// Makes a box of tetrahedra, six for each cube with moved corners; with `dual`, the dual polyhedra.
fn tetrahedra(bench: &Workbench, cells: usize, dual: bool) {
    const MOVED: f64 = 0.1;
    let mut random = Random(2);
    let size = 1e-3 * EDGE_MM / cells as f64;
    let index = |at: [usize; 3]| (at[0] * (cells + 1) + at[1]) * (cells + 1) + at[2] + 1;
    let mut nodes = String::new();
    let all = (0..(cells + 1).pow(3))
        .map(|i| [i / (cells + 1).pow(2), i / (cells + 1) % (cells + 1), i % (cells + 1)]);
    for at in all {
        let place = at.map(|k| {
            let step = if k == 0 || k == cells { 0.0 } else { MOVED * (2.0 * random.number() - 1.0) };
            size * (k as f64 + step)
        });
        writeln!(nodes, "{} {} {} {}", index(at), place[0], place[1], place[2]).unwrap();
    }
    let (mut elements, mut count) = (String::new(), 0);
    let orders = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]];
    for i in 0..cells.pow(3) {
        let at = [i / cells.pow(2), i / cells % cells, i % cells];
        for (which, order) in orders.iter().enumerate() {
            let mut corner = at;
            let mut corners = vec![corner];
            for &axis in order {
                corner[axis] += 1;
                corners.push(corner);
            }
            for left_out in 0..4 {
                let face: Vec<[usize; 3]> = (0..4).filter(|k| *k != left_out).map(|k| corners[k]).collect();
                let on = |axis: usize, side: usize| face.iter().all(|corner| corner[axis] == side);
                let patch = match (on(2, 0), on(2, cells)) {
                    (true, _) => 1,
                    (_, true) => 2,
                    _ if (0..2).any(|axis| on(axis, 0) || on(axis, cells)) => 3,
                    _ => continue,
                };
                count += 1;
                let [a, b, c] = [0, 1, 2].map(|k| index(face[k]));
                writeln!(elements, "{count} 2 2 {patch} {patch} {a} {b} {c}").unwrap();
            }
            let mut tetrahedron: Vec<usize> = corners.iter().map(|&corner| index(corner)).collect();
            if which >= 3 {
                tetrahedron.swap(1, 2);
            }
            count += 1;
            let [a, b, c, d] = tetrahedron[..] else { unreachable!() };
            writeln!(elements, "{count} 4 2 4 4 {a} {b} {c} {d}").unwrap();
        }
    }
    bench.write(
        "mesh.msh",
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n2 1 \"inlet\"\n2 2 \"outlet\"\n2 3 \
             \"walls\"\n3 4 \"gas\"\n$EndPhysicalNames\n$Nodes\n{}\n{nodes}$EndNodes\n$Elements\n{count}\n\
             {elements}$EndElements\n",
            (cells + 1).pow(3)
        ),
    );
    foam_program(bench, "gmshToFoam", &[&bench.path("mesh.msh").display().to_string()]);
    if dual {
        foam_command_on(bench, "polyDualMesh", &["30", "-overwrite"]);
    }
}
