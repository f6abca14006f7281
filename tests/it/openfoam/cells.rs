//! Cells, parts and cyclic patches of meshes: what is found, what is joined, what is refused by name.

use super::meshes::{case, mesh_of, solver};
use super::{AGREEMENT, difference, good};
use amberfield_coupling::RemoteSolver;
use amberfield_field::far::FarField;
use amberfield_tests::foam_case::{Random, brick, foam_program, write_case, write_file};
use amberfield_tests::{Answer, CsvTable, Workbench};
use std::fmt::Write as _;
use std::process::Command;

const SCENE: &str = "[particles]\nfile = 'grains.csv'\n[electric_field]\ntuning = 'model'\n\
    [solver]\nopenfoam_case = 'foam'\ntimeout_s = 20.0\n";
const GROUND: &str = "type fixedValue; value uniform 0;";
/// Share of a cell's size beside its centre at which the mesh must be found too.
const BESIDE: f64 = 0.1;
/// Folder of OpenFOAM's examples in Debian's package.
const EXAMPLES: &str = "/usr/share/doc/openfoam-examples/examples";
/// Difference of the same field on other ranks, over its RMS: the linear solver's tolerance.
const SAME: f64 = 1e-6;
/// Difference of mirrored fields over the largest field: the solver's tolerance and round-off.
const MIRRORED: f64 = 1e-6;

/// Box along the axes with corners \[mm\] and cells.
struct Block {
    low: [f64; 3],
    high: [f64; 3],
    cells: [usize; 3],
}

/// Charged grain.
#[derive(Clone, Copy)]
struct Grain {
    /// Place [m].
    place: [f64; 3],
    /// Charge [C].
    charge: f64,
}

/// Recipe of blocks that are joined where they share corners, with patches as `blockMesh` takes them.
fn blocks(blocks: &[Block], patches: &str) -> String {
    let mut vertices: Vec<[f64; 3]> = Vec::new();
    let mut text = String::new();
    for block in blocks {
        let [a, b] = [block.low, block.high];
        let corners = [
            [a[0], a[1], a[2]],
            [b[0], a[1], a[2]],
            [b[0], b[1], a[2]],
            [a[0], b[1], a[2]],
            [a[0], a[1], b[2]],
            [b[0], a[1], b[2]],
            [b[0], b[1], b[2]],
            [a[0], b[1], b[2]],
        ];
        let numbers = corners.map(|corner| {
            let known = vertices.iter().position(|vertex| *vertex == corner);
            let number = known.unwrap_or(vertices.len());
            if known.is_none() {
                vertices.push(corner);
            }
            number.to_string()
        });
        let [x, y, z] = block.cells;
        writeln!(text, "hex ({}) ({x} {y} {z}) simpleGrading (1 1 1)", numbers.join(" ")).unwrap();
    }
    let vertices: Vec<String> = vertices.iter().map(|[x, y, z]| format!("({x} {y} {z})")).collect();
    format!(
        "scale 1e-3;\nvertices ({});\nblocks ({text});\ndefaultPatch {{ name walls; type wall; }}\n\
         boundary ({patches});\n",
        vertices.join(" ")
    )
}

/// Scene of grains, with a case of a mesh and its conditions.
fn with_grains(mesh: &str, conditions: &str, grains: &[Grain]) -> Workbench {
    let bench = Workbench::new(SCENE);
    write_case(&bench, mesh, conditions, "Gauss linear");
    write_grains(&bench, grains);
    bench
}

/// Writes the grains of a scene.
fn write_grains(bench: &Workbench, grains: &[Grain]) {
    let mut text = "id,x_m,y_m,z_m,radius_m,charge_C\n".to_owned();
    for (id, Grain { place: [x, y, z], charge }) in grains.iter().enumerate() {
        writeln!(text, "{id},{x},{y},{z},1e-5,{charge}").unwrap();
    }
    bench.write("grains.csv", text);
}

fn field(bench: &Workbench, options: &[&str]) -> Answer {
    bench.run(&[&["field", "scene.toml", "--out", "out.csv"], options].concat())
}

/// Components of E [V/m], first those along x of all grains.
fn e(bench: &Workbench) -> [Vec<f64>; 3] {
    let table = CsvTable::parse(&bench.read("out.csv"));
    ["ex_V_per_m", "ey_V_per_m", "ez_V_per_m"].map(|name| table.numbers(name))
}

/// Asserts that all cell centres, and places beside them, are found inside the mesh.
fn is_found(name: &str, solver: &RemoteSolver) {
    let mesh = solver.mesh();
    for (cell, centre) in mesh.centres().iter().enumerate() {
        let (found, inside) = mesh.locate(centre, None);
        assert!(inside && found as usize == cell, "{name}: the centre of cell {cell} is in {found}");
        let step = BESIDE * mesh.volumes()[cell].cbrt();
        for axis in 0..3 {
            for step in [-step, step] {
                let mut point = *centre;
                point[axis] += step;
                let found = mesh.locate(&point, None);
                assert!(found.1, "{name}: {point} beside cell {cell}");
                // Also from the other end of the mesh.
                assert_eq!(mesh.locate(&point, Some(0)), found, "{name}: {point} beside cell {cell}");
            }
        }
    }
}

#[test]
fn every_place_inside_a_mesh_is_found_whatever_dividers_stand_there() {
    // Rooms side by side behind thin walls, with doors at alternate ends.
    let block = |x: [f64; 2], y: [f64; 2]| Block {
        low: [x[0], y[0], 0.0],
        high: [x[1], y[1], 4.0],
        cells: [if x[1] - x[0] > 1.0 { 2 } else { 1 }, (y[1] - y[0]) as usize, 4],
    };
    let ends = [[0.0, 1.0], [1.0, 7.0], [7.0, 8.0]];
    let mut rooms = Vec::new();
    for (number, x) in [0.0, 2.25, 4.5, 6.75].into_iter().enumerate() {
        rooms.extend(ends.map(|y| block([x, x + 2.0], y)));
        if number < 3 {
            rooms.push(block([x + 2.0, x + 2.25], ends[2 * (number % 2)]));
        }
    }
    let bench = case(&blocks(&rooms, ""), "Gauss linear");
    is_found("rooms", &solver(&bench));
    for (kind, cells) in [("perturbed", 8), ("tetrahedra", 4), ("polyhedra", 5)] {
        is_found(kind, &solver(&mesh_of(kind, cells)));
    }
}

/// Case of OpenFOAM's own example of walls that meet at sharp angles.
#[test]
fn in_openfoams_example_of_opposite_walls_every_centre_is_found_and_the_field_is_computed() {
    let bench = Workbench::new(SCENE);
    let example = format!("{EXAMPLES}/mesh/snappyHexMesh/opposite_walls");
    let copied = Command::new("cp").args(["-r", &example]).arg(bench.path("foam")).status().unwrap();
    assert!(copied.success(), "{example} is not there; install openfoam-examples");
    let mesh = bench.read("foam/system/blockMeshDict");
    write_case(&bench, &mesh, &format!("\".*\" {{ {GROUND} }}"), "leastSquares");
    foam_program(&bench, "blockMesh", &[]);
    foam_program(&bench, "snappyHexMesh", &["-overwrite"]);
    let solver = solver(&bench);
    let mesh = solver.mesh();
    let mut grains = Vec::new();
    for (cell, centre) in mesh.centres().iter().enumerate() {
        assert_eq!(mesh.locate(centre, None), (cell as u32, true), "the centre of cell {cell}");
        if cell % 100 == 0 {
            let charge = if cell % 200 == 0 { 1e-12 } else { -1e-12 };
            grains.push(Grain { place: (*centre).into(), charge });
        }
    }
    drop(solver);
    write_grains(&bench, &grains);
    good(&field(&bench, &[]));
}

/// Case of a box whose cells are dealt to the ranks at random, so that each cyclic face joins two of them.
#[test]
fn cells_dealt_to_ranks_at_random_have_the_same_field() {
    let (cyclic, ground) = (("cyclic", "type cyclic;"), ("wall", GROUND));
    let brick = brick([6.0; 3], [6; 3], &[cyclic, cyclic, ground, ground, cyclic, cyclic]);
    let mut random = Random(9);
    let grains: Vec<Grain> = (0..40)
        .map(|grain| {
            let place = [0; 3].map(|_| 6e-3 * (0.02 + 0.96 * random.number()));
            Grain { place, charge: if grain % 2 == 0 { -1e-12 } else { 1e-12 } }
        })
        .collect();
    let bench = with_grains(&brick.mesh, &brick.conditions, &grains);
    let hybrid = ["--method", "kolehmainen", "--set", "electric_field.field_cutoff_radius=2e-3"];
    for method in [&[][..], &hybrid] {
        let of = |ranks: &str| {
            let ranks = format!("solver.ranks={ranks}");
            let tight = ["--set", &ranks, "--set", "electric_field.far_tolerance=1e-10"];
            good(&field(&bench, &[method, &tight].concat()));
            e(&bench).concat()
        };
        let one = of("1");
        write_file(
            &bench,
            "system/decomposeParDict",
            "dictionary",
            "numberOfSubdomains 3; method random; coeffs {}\n",
        );
        assert!(difference(&of("3"), &one) < SAME, "{method:?}");
    }
}

/// Answer of a box with other patches along x.
fn along_x(kind: &str, condition: &str) -> Answer {
    let ground = ("wall", GROUND);
    let sides = [(kind, condition), (kind, condition), ground, ground, ground, ground];
    let brick = brick([6.0; 3], [6; 3], &sides);
    let grain = |x: f64, charge: f64| Grain { place: [x, 3e-3, 3e-3], charge };
    let grains = [grain(2e-3, 1e-12), grain(4e-3, -1e-12)];
    field(&with_grains(&brick.mesh, &brick.conditions, &grains), &[])
}

fn refuses(answer: &Answer, words: &[&str]) {
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    for word in words {
        assert!(answer.stderr.contains(word), "{word}: {}", answer.stderr);
    }
}

#[test]
fn cyclic_patches_that_cannot_be_joined_are_refused_by_name() {
    good(&along_x("cyclic", "type cyclic;"));
    let jump = "type fixedJump; patchType cyclic; jump uniform 10; value uniform 0;";
    refuses(&along_x("cyclic", jump), &["patch x0 of field phiE has the condition fixedJump"]);

    let patches = |sides: [&str; 2]| {
        let [left, right] = sides;
        format!(
            "left {{ type cyclic; neighbourPatch right; faces ({left}); }}\n\
             right {{ type cyclic; neighbourPatch left; faces ({right}); }}\n"
        )
    };
    let conditions = format!("left {{ type cyclic; }} right {{ type cyclic; }} walls {{ {GROUND} }}");
    let answer = |mesh: &str, inside: [f64; 3]| {
        field(&with_grains(mesh, &conditions, &[Grain { place: inside, charge: 1e-12 }]), &[])
    };
    let hexahedron = |vertices: &str, patches: &str| {
        format!(
            "scale 1e-3;\nvertices ({vertices});\n\
             blocks (hex (0 1 2 3 4 5 6 7) (6 6 6) simpleGrading (1 1 1));\n\
             defaultPatch {{ name walls; type wall; }}\nboundary ({patches});\n"
        )
    };
    let sides = patches(["(0 4 7 3)", "(1 2 6 5)"]);
    let cube = "(0 0 0) (6 0 0) (6 6 0) (0 6 0) (0 0 6) (6 0 6) (6 6 6) (0 6 6)";
    let [moved, back] = ["6e-3", "-6e-3"].map(|x| {
        format!("type cyclicAMI; transform translational; separationVector ({x} 0 0); neighbourPatch")
    });
    let loose = sides.replacen("type cyclic; neighbourPatch", &moved, 1);
    let loose = loose.replace("type cyclic; neighbourPatch", &back);
    let conditions = conditions.replace("type cyclic;", "type cyclicAMI;");
    let bench =
        with_grains(&hexahedron(cube, &loose), &conditions, &[Grain { place: [3e-3; 3], charge: 1e-12 }]);
    refuses(&field(&bench, &[]), &["patch left is of type cyclicAMI"]);

    let skewed = "(0 0 0) (6 1 0) (6 7 0) (0 6 0) (0 0 6) (6 1 6) (6 7 6) (0 6 6)";
    let skewed = answer(&hexahedron(skewed, &sides), [3e-3; 3]);
    refuses(&skewed, &["patch left moves", "along no axis"]);

    let sector = "(3 0 0) (6 0 0) (0 6 0) (0 3 0) (3 0 6) (6 0 6) (0 6 6) (0 3 6)";
    let turn = "; transform rotational; rotationAxis (0 0 1); rotationCentre (0 0 0); faces";
    let sides = patches(["(0 1 5 4)", "(3 7 6 2)"]).replace("; faces", turn);
    let sector = answer(&hexahedron(sector, &sides), [3e-3; 3]);
    refuses(&sector, &["patch left turns what crosses it"]);

    // The upper half of both ends is wall.
    let halves =
        [0.0, 3.0].map(|z| Block { low: [0.0, 0.0, z], high: [6.0, 6.0, z + 3.0], cells: [6, 6, 3] });
    let half = answer(&blocks(&halves, &patches(["(0 4 7 3)", "(1 2 6 5)"])), [3e-3; 3]);
    refuses(&half, &["patch walls stands beside cyclic patches", "along x"]);

    // A recess that reaches beyond one end.
    let recess = [
        Block { low: [0.0; 3], high: [2.0, 6.0, 6.0], cells: [2, 6, 6] },
        Block { low: [2.0, 0.0, 0.0], high: [6.0; 3], cells: [4, 6, 6] },
        Block { low: [0.0, 0.0, 6.0], high: [2.0, 6.0, 8.0], cells: [2, 6, 2] },
        Block { low: [-2.0, 0.0, 6.0], high: [0.0, 6.0, 8.0], cells: [2, 6, 2] },
    ];
    let recess = answer(&blocks(&recess, &patches(["(0 4 7 3)", "(8 9 11 10)"])), [3e-3; 3]);
    refuses(&recess, &["patch left is 0.006 m from its neighbour along x", "0.008 m long"]);
}

/// Case of two insulated rooms without a door.
#[test]
fn each_closed_room_must_be_neutral_and_has_a_field_of_its_own() {
    let rooms = [0.0, 12.0].map(|x| Block { low: [x, 0.0, 0.0], high: [x + 6.0, 6.0, 6.0], cells: [6; 3] });
    let mesh = blocks(&rooms, "");
    let insulated = "walls { type zeroGradient; }";
    let pair = |x: f64| {
        [([x - 1e-3, 3e-3, 2e-3], 1e-12), ([x + 1e-3, 3e-3, 4e-3], -1e-12)]
            .map(|(place, charge)| Grain { place, charge })
    };
    let both = with_grains(&mesh, insulated, &[pair(3e-3), pair(15e-3)].concat());
    for ranks in ["1", "2"] {
        good(&field(&both, &["--set", &format!("solver.ranks={ranks}")]));
        // The rooms are alike, and each is as if it were alone.
        let e = e(&both);
        let [one, other] = [0, 2].map(|first| e.each_ref().map(|e| e[first..first + 2].to_vec()).concat());
        assert!(difference(&one, &other) < AGREEMENT, "ranks {ranks}: {one:?} {other:?}");
    }
    let [left, right] = [pair(3e-3)[0], pair(15e-3)[1]];
    let refused = field(&with_grains(&mesh, insulated, &[left, right]), &[]);
    refuses(&refused, &["net charge 1e-12 C", "216 of 432 cells", "from (5.0000e-4"]);
    let background = ["--set", "electric_field.neutralising_background=true"];
    good(&field(&with_grains(&mesh, insulated, &[left, right]), &background));
}

#[test]
fn a_linear_solver_that_gives_up_is_an_error_with_its_residual() {
    let brick = brick([6.0; 3], [6; 3], &[("wall", GROUND); 6]);
    let bench =
        with_grains(&brick.mesh, &brick.conditions, &[Grain { place: [2e-3, 3e-3, 3e-3], charge: 1e-12 }]);
    let with = |entry: &str| {
        let text = format!("solvers {{ V {{ solver PCG; preconditioner DIC; tolerance 1e-2; {entry} }} }}\n");
        write_file(&bench, "system/fvSolution", "dictionary", &text);
        field(&bench, &[])
    };
    // The scene's tolerance counts, not the case's.
    good(&with("relTol 0.5;"));
    let exact = e(&bench);
    good(&with("relTol 0;"));
    assert_eq!(e(&bench), exact);
    let answer = with("relTol 0; maxIter 1;");
    assert_eq!(answer.code, Some(4), "{}", answer.stderr);
    assert!(answer.stderr.contains("gave up after 1 iterations with a residual of"), "{}", answer.stderr);
    let run = bench.run(&["run", "scene.toml", "--out", "out", "--no-progress"]);
    assert_ne!(run.code, Some(0));
}

#[test]
fn a_mirrored_scene_has_a_mirrored_field() {
    let (ground, lid) = (("wall", GROUND), ("wall", "type zeroGradient;"));
    let brick = brick([6.0, 6.0, 8.0], [6, 6, 8], &[ground, ground, lid, lid, ground, ground]);
    let mut random = Random(5);
    let grains: Vec<Grain> = (0..60)
        .map(|grain| {
            let place = [6e-3, 6e-3, 8e-3].map(|edge| edge * (0.02 + 0.96 * random.number()));
            Grain { place, charge: if grain % 3 == 0 { -1e-12 } else { 1e-12 } }
        })
        .collect();
    let tight = ["--set", "electric_field.far_tolerance=1e-11"];
    let of = |grains: &[Grain]| {
        let bench = with_grains(&brick.mesh, &brick.conditions, grains);
        good(&field(&bench, &tight));
        e(&bench)
    };
    let here = of(&grains);
    let largest = here.iter().flatten().fold(0.0, |most: f64, e| most.max(e.abs()));
    for (axis, edge) in [6e-3, 6e-3, 8e-3].into_iter().enumerate() {
        let mut mirrored = grains.clone();
        for Grain { place, .. } in &mut mirrored {
            place[axis] = edge - place[axis];
        }
        let there = of(&mirrored);
        for (component, (here, there)) in here.iter().zip(&there).enumerate() {
            let sign = if component == axis { -1.0 } else { 1.0 };
            let worst = here.iter().zip(there).map(|(a, b)| (a - sign * b).abs()).fold(0.0, f64::max);
            assert!(worst < MIRRORED * largest, "axis {axis}: {:e}", worst / largest);
        }
    }
}
