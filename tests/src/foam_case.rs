//! OpenFOAM cases with meshes of many shapes.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use crate::Workbench;
use amberfield_core::Vector3;
use amberfield_coupling::foam_command;
use std::fmt::Write as _;

/// Corners of the six sides of a hexahedron, numbered as in OpenFOAM.
const SIDES: [[usize; 4]; 6] =
    [[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]];
/// Signs of the coordinates of the corners of a hexahedron, in the order of OpenFOAM.
const CORNERS: [[i32; 3]; 8] =
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]];
/// Half the edge of the inner cube of a ball or cylinder, over the radius.
const CORE: f64 = 0.42;

/// Writes a case into the folder `foam`.
///
/// `mesh` is a recipe for `blockMesh`, `conditions` are those of the potential by patch, `gradient` is the
/// scheme for gradients.
pub fn write_case(bench: &Workbench, mesh: &str, conditions: &str, gradient: &str) {
    let file = |name: &str, class: &str, text: &str| write_file(bench, name, class, text);
    file("system/blockMeshDict", "dictionary", mesh);
    file(
        "system/controlDict",
        "dictionary",
        "startFrom startTime; startTime 0; stopAt endTime; endTime 1; deltaT 1; writeControl timeStep; \
         writeInterval 1;\n",
    );
    file(
        "system/fvSchemes",
        "dictionary",
        &format!(
            "ddtSchemes {{ default none; }} gradSchemes {{ default {gradient}; }} divSchemes {{ default \
             none; }}\n\
             laplacianSchemes {{ default Gauss linear corrected; }} interpolationSchemes {{ default linear; \
             }} snGradSchemes {{ default corrected; }}\n"
        ),
    );
    file("system/fvSolution", "dictionary", "solvers {}\n");
    write_potential(bench, conditions);
}

/// Writes the potential of the case in the folder `foam`; `conditions` are given by patch.
pub fn write_potential(bench: &Workbench, conditions: &str) {
    let text = format!(
        "dimensions [1 2 -3 0 0 -1 0];\ninternalField uniform 0;\nboundaryField {{ {conditions} }}\n"
    );
    write_file(bench, "0/phiE", "volScalarField", &text);
}

/// Writes a file of the case in the folder `foam`, with its header.
pub fn write_file(bench: &Workbench, name: &str, class: &str, text: &str) {
    let (folder, object) = name.rsplit_once('/').unwrap();
    std::fs::create_dir_all(bench.path("foam").join(folder)).unwrap();
    let head = format!("FoamFile {{ version 2.0; format ascii; class {class}; object {object}; }}\n");
    bench.write(&format!("foam/{name}"), head + text);
}

/// Writes a case of a gas into the folder `foam`.
///
/// `mesh` is a recipe for `blockMesh`, `velocity` and `pressure` are conditions by patch of U and of p over
/// the density, `viscosity` is the kinematic viscosity [m²/s].
pub fn write_gas_case(bench: &Workbench, mesh: &str, velocity: &str, pressure: &str, viscosity: f64) {
    let file = |name: &str, class: &str, text: &str| write_file(bench, name, class, text);
    file("system/blockMeshDict", "dictionary", mesh);
    file(
        "system/controlDict",
        "dictionary",
        "startFrom startTime; startTime 0; stopAt endTime; endTime 1e9; deltaT 1; writeControl none; \
         writeInterval 1e9;\n",
    );
    file(
        "system/fvSchemes",
        "dictionary",
        "ddtSchemes { default Euler; } gradSchemes { default Gauss linear; } divSchemes { default Gauss \
         linear; div(alphaPhi,U) Gauss limitedLinearV 1; \"div\\(alphaPhi,(k|epsilon)\\)\" Gauss upwind; }\n\
         laplacianSchemes { default Gauss linear corrected; } interpolationSchemes { default linear; } \
         snGradSchemes { default corrected; }\n",
    );
    file(
        "system/fvSolution",
        "dictionary",
        "solvers { \"p.*\" { solver GAMG; smoother GaussSeidel; tolerance 1e-10; relTol 0; } \
         \"(U|k|epsilon).*\" { solver PBiCGStab; preconditioner DILU; tolerance 1e-12; relTol 0; } }\n\
         PIMPLE { nOuterCorrectors 4; nCorrectors 3; nNonOrthogonalCorrectors 0; momentumPredictor yes; \
         pRefCell 0; pRefValue 0; }\n",
    );
    file(
        "constant/transportProperties",
        "dictionary",
        &format!("transportModel Newtonian;\nnu [0 2 -1 0 0 0 0] {viscosity:e};\n"),
    );
    file("constant/turbulenceProperties", "dictionary", "simulationType laminar;\n");
    file(
        "0/U",
        "volVectorField",
        &format!(
            "dimensions [0 1 -1 0 0 0 0];\ninternalField uniform (0 0 0);\nboundaryField {{ {velocity} }}\n"
        ),
    );
    file(
        "0/p",
        "volScalarField",
        &format!("dimensions [0 2 -2 0 0 0 0];\ninternalField uniform 0;\nboundaryField {{ {pressure} }}\n"),
    );
}

/// Runs a program of OpenFOAM on the case.
///
/// # Panics
/// When it fails.
pub fn foam_program(bench: &Workbench, program: &str, options: &[&str]) {
    let mut command = foam_command(program);
    // Some programs write pictures into the folder in which they run.
    command.args(options).arg("-case").arg(bench.path("foam")).current_dir(bench.path(""));
    let output = command.output().expect("OpenFOAM is there; `cargo xtask openfoam` installs it");
    assert!(output.status.success(), "{program}: {}", String::from_utf8_lossy(&output.stderr));
}

/// Runs a program of OpenFOAM on the case that changes its mesh and would change its fields, which stay as
/// they are.
///
/// # Panics
/// When it fails.
pub fn foam_command_on(bench: &Workbench, program: &str, options: &[&str]) {
    std::fs::rename(bench.path("foam/0"), bench.path("fields")).unwrap();
    foam_program(bench, program, options);
    let _ = std::fs::remove_dir_all(bench.path("foam/0"));
    std::fs::rename(bench.path("fields"), bench.path("foam/0")).unwrap();
}

/// Recipe of a cube with an edge \[mm\] and one patch `wall`.
///
/// `grading` is the ratio of the last cell to the first along each axis.
#[must_use]
pub fn cube(edge_mm: f64, cells: usize, grading: f64) -> String {
    let vertex =
        |c: &[i32; 3]| format!("({} {} {})", at(edge_mm, c[0]), at(edge_mm, c[1]), at(edge_mm, c[2]));
    let vertices: Vec<String> = CORNERS.iter().map(vertex).collect();
    let faces: Vec<String> = SIDES.iter().map(|side| quad(side, 0)).collect();
    format!(
        "scale 1e-3;\nvertices ({});\nblocks (hex (0 1 2 3 4 5 6 7) ({cells} {cells} {cells}) simpleGrading \
         ({grading} {grading} {grading}));\n\
         boundary ( wall {{ type wall; faces ({}); }} );\n",
        vertices.join(" "),
        faces.join(" ")
    )
}

/// Recipe of a box.
#[derive(Clone, Debug)]
pub struct Brick {
    /// Recipe of the mesh for `blockMesh`.
    pub mesh: String,
    /// Conditions of a field, by patch.
    pub conditions: String,
}

/// Recipe of a box of edges \[mm\] with a patch on each side.
///
/// `sides` are the kinds and the conditions of the patches `x0`, `x1`, `y0`, `y1`, `z0`, `z1`.
#[must_use]
pub fn brick(edges_mm: [f64; 3], cells: [usize; 3], sides: &[(&str, &str); 6]) -> Brick {
    const NAMES: [&str; 6] = ["x0", "x1", "y0", "y1", "z0", "z1"];
    let (mut patches, mut conditions) = (String::new(), String::new());
    for (side, (kind, condition)) in sides.iter().enumerate() {
        let (name, other, faces) = (NAMES[side], NAMES[side ^ 1], quad(&SIDES[side], 0));
        writeln!(patches, "{name} {{ type {kind}; neighbourPatch {other}; faces ({faces}); }}").unwrap();
        writeln!(conditions, "{name} {{ {condition} }}").unwrap();
    }
    let vertex = |c: &[i32; 3]| {
        format!("({} {} {})", at(edges_mm[0], c[0]), at(edges_mm[1], c[1]), at(edges_mm[2], c[2]))
    };
    let vertices: Vec<String> = CORNERS.iter().map(vertex).collect();
    let [x, y, z] = cells;
    let mesh = format!(
        "scale 1e-3;\nvertices ({});\nblocks (hex (0 1 2 3 4 5 6 7) ({x} {y} {z}) simpleGrading (1 1 1));\n\
         boundary ({patches});\n",
        vertices.join(" ")
    );
    Brick { mesh, conditions }
}

/// Recipe of a ball around the origin with a radius \[mm\].
///
/// It has an inner cube of `cells` along each edge, and as many on each of six sides, `layers` deep.
#[must_use]
pub fn ball(radius_mm: f64, cells: usize, layers: usize) -> String {
    let corner = |scale: f64| {
        CORNERS.map(|c| {
            format!("({} {} {})", scale * f64::from(c[0]), scale * f64::from(c[1]), scale * f64::from(c[2]))
        })
    };
    let vertices = [corner(CORE * radius_mm), corner(radius_mm / 3.0_f64.sqrt())].concat();
    let mut blocks = format!("hex (0 1 2 3 4 5 6 7) ({cells} {cells} {cells}) simpleGrading (1 1 1)\n");
    let (mut faces, mut projected) = (String::new(), String::new());
    for side in &SIDES {
        let [a, b, c, d] = side;
        let outer = quad(side, 8);
        writeln!(
            blocks,
            "hex ({a} {b} {c} {d} {} {} {} {}) ({cells} {cells} {layers}) simpleGrading (1 1 1)",
            a + 8,
            b + 8,
            c + 8,
            d + 8
        )
        .unwrap();
        writeln!(projected, "project {outer} ball").unwrap();
        faces += &outer;
    }
    let mut edges = String::new();
    for (a, first) in CORNERS.iter().enumerate() {
        for (b, second) in CORNERS.iter().enumerate().skip(a + 1) {
            if (0..3).filter(|&axis| first[axis] != second[axis]).count() == 1 {
                writeln!(edges, "project {} {} (ball)", a + 8, b + 8).unwrap();
            }
        }
    }
    format!(
        "scale 1e-3;\ngeometry {{ ball {{ type searchableSphere; centre (0 0 0); radius {radius_mm}; }} }}\n\
         vertices ({});\nblocks ({blocks});\n\
         edges ({edges});\nfaces ({projected});\nboundary ( wall {{ type wall; faces ({faces}); }} );\n",
        vertices.join(" ")
    )
}

/// Recipe of a cylinder around the z axis from z = 0 with a radius and a length \[mm\].
///
/// It has an inner square of `cells` across and along the axis, and as many on each of four sides, `layers`
/// deep.
#[must_use]
pub fn cylinder(radius_mm: f64, length_mm: f64, cells: [usize; 2], layers: usize) -> String {
    let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let mut vertices = Vec::new();
    for z in [0.0, length_mm] {
        for scale in [CORE * radius_mm, radius_mm / 2.0_f64.sqrt()] {
            vertices.extend(square.iter().map(|[x, y]| format!("({} {} {z})", scale * x, scale * y)));
        }
    }
    let [across, along] = cells;
    let mut blocks = format!("hex (0 1 2 3 8 9 10 11) ({across} {across} {along}) simpleGrading (1 1 1)\n");
    let (mut mantle, mut ends, mut edges) =
        (String::new(), "(0 3 2 1) (8 9 10 11)".to_owned(), String::new());
    for a in 0..4 {
        let b = (a + 1) % 4;
        let (c, d) = (b + 4, a + 4);
        writeln!(
            blocks,
            "hex ({a} {d} {c} {b} {} {} {} {}) ({layers} {across} {along}) simpleGrading (1 1 1)",
            a + 8,
            d + 8,
            c + 8,
            b + 8
        )
        .unwrap();
        write!(mantle, "({d} {c} {} {})", c + 8, d + 8).unwrap();
        write!(ends, "({a} {b} {c} {d}) ({} {} {} {})", a + 8, d + 8, c + 8, b + 8).unwrap();
        let middle = [[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]][a].map(|x: f64| x * radius_mm);
        for (floor, z) in [(0, 0.0), (8, length_mm)] {
            writeln!(edges, "arc {} {} ({} {} {z})", d + floor, c + floor, middle[0], middle[1]).unwrap();
        }
    }
    format!(
        "scale 1e-3;\nvertices ({});\nblocks ({blocks});\nedges ({edges});\n\
         boundary ( mantle {{ type wall; faces ({mantle}); }} ends {{ type wall; faces ({ends}); }} );\n",
        vertices.join(" ")
    )
}

/// Moves the points of a cube's mesh by up to a share of its cells; those on a face stay on it.
///
/// # Panics
/// Without a mesh.
pub fn perturb(bench: &Workbench, edge_mm: f64, cells: usize, share: f64) {
    let (edge, most) = (1e-3 * edge_mm, 1e-3 * share * edge_mm / cells as f64);
    let mut random = Random(1);
    move_points(bench, |point| {
        point.map(|x| {
            let step = most * (2.0 * random.number() - 1.0);
            let at_end = x.abs() < 1e-9 || (x - edge).abs() < 1e-9;
            if at_end { x } else { x + step }
        })
    });
}

/// Moves the points of a mesh in text form; `to` says where to [m].
///
/// # Panics
/// Without a mesh.
pub fn move_points(bench: &Workbench, mut to: impl FnMut(Vector3<f64>) -> Vector3<f64>) {
    const POINTS: &str = "foam/constant/polyMesh/points";
    let text = bench.read(POINTS);
    let lines = text.lines().map(|line| {
        let numbers = line.trim_matches(['(', ')']).split(' ').filter_map(|word| word.parse().ok());
        let [x, y, z] = numbers.collect::<Vec<f64>>()[..] else { return line.to_owned() };
        let moved = to(Vector3::new(x, y, z));
        format!("({} {} {})", moved.x, moved.y, moved.z)
    });
    bench.write(POINTS, lines.collect::<Vec<_>>().join("\n"));
}

/// Makes a mesh of tetrahedra, six for each cell of a cube with moved corners; with `dual`, a mesh of the
/// dual polyhedra.
pub fn tetrahedra(bench: &Workbench, edge_mm: f64, cells: usize, dual: bool) {
    const MOVED: f64 = 0.1;
    let mut random = Random(2);
    let size = 1e-3 * edge_mm / cells as f64;
    let index = |at: [usize; 3]| (at[0] * (cells + 1) + at[1]) * (cells + 1) + at[2] + 1;
    let mut nodes = String::new();
    for_each_of(cells + 1, |at| {
        let place = at.map(|k| {
            let step = if k == 0 || k == cells { 0.0 } else { MOVED * (2.0 * random.number() - 1.0) };
            size * (k as f64 + step)
        });
        writeln!(nodes, "{} {} {} {}", index(at), place[0], place[1], place[2]).unwrap();
    });
    let mut elements = String::new();
    let mut count = 0;
    for_each_of(cells, |at| {
        for (order, even) in [
            ([0, 1, 2], true),
            ([1, 2, 0], true),
            ([2, 0, 1], true),
            ([0, 2, 1], false),
            ([1, 0, 2], false),
            ([2, 1, 0], false),
        ] {
            let mut corner = at;
            let mut tetrahedron = vec![index(corner)];
            for axis in order {
                corner[axis] += 1;
                tetrahedron.push(index(corner));
            }
            if !even {
                tetrahedron.swap(1, 2);
            }
            count += 1;
            let [a, b, c, d] = tetrahedron[..] else { unreachable!() };
            writeln!(elements, "{count} 4 2 1 1 {a} {b} {c} {d}").unwrap();
        }
    });
    let points = (cells + 1).pow(3);
    bench.write(
        "mesh.msh",
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{points}\n{nodes}$EndNodes\n$Elements\n\
            {count}\n{elements}$EndElements\n"
        ),
    );
    foam_program(bench, "gmshToFoam", &[&bench.path("mesh.msh").display().to_string()]);
    if dual {
        let potential = bench.read("foam/0/phiE");
        std::fs::remove_file(bench.path("foam/0/phiE")).unwrap();
        foam_program(bench, "polyDualMesh", &["30", "-overwrite"]);
        bench.write("foam/0/phiE", potential);
    }
}

/// Generator of equally distributed numbers in \[0, 1) that are the same on each machine (xorshift64*,
/// Vigna).
#[derive(Debug)]
pub struct Random(pub u64);

impl Random {
    /// Next number.
    pub fn number(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Visits the points of a cubic lattice.
fn for_each_of(count: usize, mut visit: impl FnMut([usize; 3])) {
    for x in 0..count {
        for y in 0..count {
            for z in 0..count {
                visit([x, y, z]);
            }
        }
    }
}

/// Coordinate of a corner on a side, −1 or 1.
fn at(edge: f64, side: i32) -> f64 {
    if side < 0 { 0.0 } else { edge }
}

/// Text of the corners of a side, each increased by `add`.
fn quad(side: &[usize; 4], add: usize) -> String {
    let [a, b, c, d] = side.map(|corner| corner + add);
    format!("({a} {b} {c} {d})")
}
