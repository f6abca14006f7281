//! Patches of OpenFOAM's meshes: what the DEM side learns of them, and walls that are patches.

use super::good;
use amberfield_core::Vector3;
use amberfield_coupling::{Announced, RemoteSolver, SolverSettings};
use amberfield_field::far::FarField as _;
use amberfield_tests::foam_case::{ball, brick, foam_program, write_case};
use amberfield_tests::{Answer, CsvTable, FoamBox, Workbench};
use std::fmt::Write as _;
use std::time::Duration;

/// Largest difference of areas and centres from those that OpenFOAM says, over the size of a face.
const ROUND_OFF: f64 = 1e-9;

/// Solver of the case in the folder `foam`, with a number of processes.
fn solver(bench: &Workbench, ranks: u32) -> RemoteSolver {
    let settings = SolverSettings {
        ranks,
        timeout: Duration::from_secs(60),
        far_tolerance: 1e-7,
        ..SolverSettings::started(bench.path("foam"), bench.path("solver"))
    };
    Announced::new(settings).and_then(Announced::connect).expect("the solver answers")
}

#[test]
fn boundary_faces_come_with_their_corners_and_patches_from_any_number_of_ranks() {
    let [cyclic, wall, open] = [
        ("cyclic", "type cyclic;"),
        ("wall", "type fixedValue; value uniform 0;"),
        ("patch", "type zeroGradient;"),
    ];
    let brick = brick([12.0, 9.0, 10.0], [6, 4, 5], &[cyclic, cyclic, wall, open, wall, wall]);
    let bench = Workbench::new("");
    write_case(&bench, &brick.mesh, &brick.conditions, "Gauss linear");
    for ranks in [1, 3] {
        let solver = solver(&bench, ranks);
        let mesh = solver.mesh();
        let names: Vec<&str> = mesh.patches().iter().map(|patch| patch.name.as_str()).collect();
        let kinds: Vec<&str> = mesh.patches().iter().map(|patch| patch.kind.as_str()).collect();
        assert_eq!(names, ["x0", "x1", "y0", "y1", "z0", "z1"]);
        assert_eq!(kinds, ["cyclic", "cyclic", "wall", "patch", "wall", "wall"]);
        assert_eq!(mesh.boundary().len(), 2 * (6 * 5 + 6 * 4));
        for (index, face) in mesh.boundary().iter().enumerate() {
            let corners = mesh.corners_of(index);
            assert_eq!(corners.len(), 4);
            let area = (corners[2] - corners[0]).cross(&(corners[3] - corners[1])) / 2.0;
            assert!((area - face.normal * face.area).norm() < ROUND_OFF * face.area, "{area:?} {face:?}");
            let centre = corners.iter().sum::<Vector3<f64>>() / 4.0;
            assert!((centre - face.centre).norm() < ROUND_OFF * face.area.sqrt(), "{centre:?} {face:?}");
            let axis = face.normal.iamax();
            let side = usize::from(face.normal[axis] > 0.0);
            assert_eq!(face.patch as usize, 2 * axis + side, "{face:?}");
        }
    }
}

/// Scene of grains of glass in the file `grains.csv`, with walls of the same, in a box that is larger than
/// the mesh. There is no field, and so the solver is not started: only its mesh counts.
fn scene_of(walls: &str, end_s: f64) -> String {
    format!(
        "[domain]\nmin_m = [-0.02, -0.02, -0.02]\nmax_m = [0.02, 0.02, 0.02]\n[domain.boundary]\nx = 'open'\n\
         y = 'open'\nz = 'open'\n{walls}\
         [[materials]]\nname = 'glass'\ndensity_kg_m3 = 2500.0\nyoung_Pa = 5e5\npoisson = 0.22\n\
         restitution = 0.5\nfriction = 0.3\nrolling_friction = 0.02\n\
         [particles]\nfile = 'grains.csv'\n\
         [time]\nstep_s = 1e-5\nend_s = {end_s}\ngravity_m_s2 = [0, 0, -9.81]\n\
         [solver]\nopenfoam_case = 'foam'\n[output]\nformats = ['csv']\n"
    )
}

fn patch_wall(name: &str) -> String {
    format!("[[walls]]\npatch = '{name}'\nmaterial = 'glass'\n")
}

/// Particles at the end of a run of a scene.
fn end_of(bench: &Workbench, scene: &str, out: &str) -> CsvTable {
    bench.write("scene.toml", scene);
    good(&bench.run(&["run", "scene.toml", "--out", out, "--no-progress"]));
    let last = bench.names(&format!("{out}/particles")).into_iter().rfind(|name| name.ends_with(".csv"));
    CsvTable::parse(&bench.read(&format!("{out}/particles/{}", last.expect("a file"))))
}

#[test]
fn a_grain_comes_to_rest_on_a_patch_as_on_a_plane() {
    /// Round-off of closest points, amplified over the steps, over the radius of the grain.
    const ROUND_OFF: f64 = 1e-8;
    const RADIUS: f64 = 5e-4;
    let wall = ("wall", "type fixedValue; value uniform 0;");
    let brick = brick([12.0, 12.0, 10.0], [7, 5, 4], &[wall; 6]);
    let bench = Workbench::new("");
    write_case(&bench, &brick.mesh, &brick.conditions, "Gauss linear");
    bench.write(
        "grains.csv",
        format!(
            "id,x_m,y_m,z_m,vx_m_s,vy_m_s,vz_m_s,radius_m,material\n\
             1,0.0041,0.0057,0.003,0.03,0.01,0,{RADIUS},glass\n"
        ),
    );
    let plane = "[[walls]]\nplane = { point_m = [0, 0, 0], normal = [0, 0, 1] }\nmaterial = 'glass'\n";
    let plane = end_of(&bench, &scene_of(plane, 0.2), "plane");
    let patch = end_of(&bench, &scene_of(&patch_wall("z0"), 0.2), "patch");
    for axis in ["x_m", "y_m", "z_m"] {
        let [plane, patch] = [&plane, &patch].map(|table| table.numbers(axis)[0]);
        assert!((plane - patch).abs() < ROUND_OFF * RADIUS, "{axis}: {plane:e} {patch:e}");
    }
    let z = patch.numbers("z_m")[0];
    assert!((z - RADIUS).abs() < 0.01 * RADIUS && patch.numbers("x_m")[0] > 4.2e-3, "{z:e}");
}

#[test]
fn a_bed_stays_in_a_ball_whose_wall_is_a_curved_patch() {
    const EDGE: f64 = 6e-3;
    const RADIUS: f64 = 3e-4;
    let mut grains = "id,x_m,y_m,z_m,radius_m,material\n".to_owned();
    let mut count = 0;
    for number in 0..1000 {
        let place = [number / 100, number / 10 % 10, number % 10].map(|k| 9e-4 * (f64::from(k) - 4.5));
        if Vector3::from(place).norm() < EDGE - 1.2 * RADIUS {
            count += 1;
            let [x, y, z] = place;
            writeln!(grains, "{count},{x},{y},{z},{RADIUS},glass").expect("memory");
        }
    }
    for polyhedra in [false, true] {
        let bench = Workbench::new("");
        write_case(&bench, &ball(1e3 * EDGE, 8, 5), "", "leastSquares");
        bench.write("grains.csv", &grains);
        if polyhedra {
            foam_program(&bench, "blockMesh", &[]);
            std::fs::remove_file(bench.path("foam/0/phiE")).expect("it was written");
            foam_program(&bench, "polyDualMesh", &["30", "-overwrite"]);
        }
        let end = end_of(&bench, &scene_of(&patch_wall("wall"), 0.1), "out");
        let [x, y, z] = ["x_m", "y_m", "z_m"].map(|axis| end.numbers(axis));
        let depths: Vec<f64> =
            (0..x.len()).map(|i| EDGE - Vector3::new(x[i], y[i], z[i]).norm() - RADIUS).collect();
        let deepest = depths.iter().copied().fold(f64::INFINITY, f64::min);
        assert_eq!(depths.len(), count, "no grain is lost");
        // The facets lie inside the ball; grains dent them a little.
        assert!(deepest > -0.1 * RADIUS, "{deepest:e}");
        // The bed lies at the bottom: no grain is in the upper part, where a third of them began.
        assert!(z.iter().all(|z| *z < 0.4 * EDGE), "{z:?}");
    }
}

fn explain(scene: &FoamBox, walls: &str) -> Answer {
    let text = scene.bench.read("scene.toml").replace("[particles]", &format!("{walls}[particles]"));
    scene.bench.write("walls.toml", text);
    scene.bench.run(&["explain", "walls.toml"])
}

#[test]
fn patches_that_are_not_there_or_no_surface_are_refused_by_name() {
    let (cyclic, wall) = (("cyclic", "type cyclic;"), ("wall", "type fixedValue; value uniform 0;"));
    let faces = "x = 'periodic'\ny = 'periodic'\nz = 'grounded'";
    let scene = FoamBox::new(&[cyclic, cyclic, cyclic, cyclic, wall, wall], faces, "bipolar = 1e-13");
    for (patch, words) in [
        ("z2", ["walls[0].patch = \"z2\"", "it has x0, x1, y0, y1, z0, z1; the nearest is z0"]),
        ("x0", ["walls[0].patch = \"x0\"", "this patch is of the type cyclic"]),
        ("z0'\nscale = 2.0\n#'", ["walls[0].scale = 2", "a patch has no scale"]),
    ] {
        let answer = explain(&scene, &patch_wall(patch));
        assert_eq!(answer.code, Some(2), "{}", answer.stderr);
        assert!(words.iter().all(|word| answer.stderr.contains(word)), "{}", answer.stderr);
    }
    assert!(explain(&scene, &patch_wall("z2")).stderr.contains("the mesh of the case foam"));
}

#[test]
fn patches_without_a_wall_are_named_once() {
    const SAID: &str =
        "no wall of the scene stands at these patches of the mesh, and grains pass through them";
    let warnings = |walls: &str, out: &str| {
        let scene = FoamBox::grounded();
        let text = scene.bench.read("scene.toml").replace("end_s = 1e-3", "end_s = 5e-5");
        scene.bench.write("scene.toml", text.replace("[particles]", &format!("{walls}[particles]")));
        let answer = scene.bench.run(&["run", "scene.toml", "--out", out, "--no-progress"]);
        good(&answer);
        answer.stderr.lines().filter(|line| line.contains(SAID)).map(str::to_owned).collect::<Vec<_>>()
    };
    let none = warnings("", "none");
    assert_eq!(none.len(), 1, "{none:?}");
    assert!(none[0].contains(": x0, x1, y0, y1, z0, z1; add [[walls]] with patch = \"x0\""), "{none:?}");
    let plane = "[[walls]]\nplane = { point_m = [0, 0, 0], normal = [0, 0, 1] }\nmaterial = 'glass'\n";
    let some = warnings(&(patch_wall("x0") + &patch_wall("y1") + plane), "some");
    assert!(some.len() == 1 && some[0].contains(": x1, y0, z1; add"), "{some:?}");
    let all: String = ["x0", "x1", "y0", "y1", "z0", "z1"].map(patch_wall).concat();
    assert_eq!(warnings(&all, "all"), [] as [String; 0]);
}
