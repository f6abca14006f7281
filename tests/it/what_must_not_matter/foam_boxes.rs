//! Boxes whose cells OpenFOAM has, in any frame and written down in any way.

use super::scene::{Content, Frame, Scene, Solver};
use amberfield_coupling::{Announced, SolverSettings};
use amberfield_tests::Workbench;
use amberfield_tests::foam_case::{
    brick, foam_program, move_points, perturb, write_case, write_file, write_potential,
};
use amberfield_tests::foam_refinement::refine;
use std::fmt::Write as _;
use std::time::Duration;

/// Relative tolerance of the linear solver, so that where it stops is not seen.
const FAR_TOLERANCE: f64 = 1e-10;
/// Time that an answer may take on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);
/// Width and height of the boxes, and edge of their cells [mm].
const WIDTH: f64 = 6.0;
const CELL: f64 = 0.75;
/// Sides of a hexahedron, low and high along each axis, and its corners, numbered as in OpenFOAM.
const SIDES: [[usize; 4]; 6] =
    [[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]];
const CORNERS: [[usize; 3]; 8] =
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
pub(super) const PATCHES: [&str; 8] = ["x0", "x1", "y0", "y1", "z0", "z1", "left", "right"];

/// Box whose cells OpenFOAM has.
#[derive(Clone, Copy, Debug)]
pub(super) enum Shape {
    /// Cubes, with a sheet across x at 4.5 mm from z = 0 to its middle.
    Sheet,
    /// A cube of hexahedra out of shape.
    Skewed,
}

/// Grains in a box whose cells OpenFOAM has.
#[derive(Clone, Debug)]
pub(super) struct FoamScene {
    pub(super) content: Content,
    pub(super) shape: Shape,
    pub(super) ranks: u32,
    pub(super) recipe: Recipe,
    /// Changes of the mesh that `blockMesh` has made.
    pub(super) changes: Vec<fn(&Workbench)>,
}

/// The way in which the box with a sheet is written down.
#[derive(Clone, Debug)]
pub(super) struct Recipe {
    /// Patches in the order of the file.
    pub(super) patches: Vec<&'static str>,
    /// Unit of length of the recipe [m].
    pub(super) unit: f64,
    /// Whether the blocks leave the sheet open, or it is cut into the mesh later.
    pub(super) has_sheet: bool,
}

impl Scene for FoamScene {
    fn content(&self) -> &Content {
        &self.content
    }

    fn solver(&self) -> Solver {
        let bench = self.case();
        let settings = SolverSettings {
            ranks: self.ranks,
            timeout: PATIENCE,
            far_tolerance: FAR_TOLERANCE,
            ..SolverSettings::started(bench.path("foam"), bench.path("solver"))
        };
        let solver = Announced::new(settings).and_then(Announced::connect).expect("the solver answers");
        Solver::new(Box::new(solver))
    }
}

impl FoamScene {
    /// Folder with the case in the frame of the scene.
    pub(super) fn case(&self) -> Workbench {
        let (recipe, gradient) = match self.shape {
            Shape::Sheet => (self.recipe.text(), "Gauss linear"),
            Shape::Skewed => {
                let cells = (WIDTH / CELL) as usize;
                (brick([WIDTH; 3], [cells; 3], &[("wall", ""); 6]).mesh, "leastSquares")
            }
        };
        let bench = Workbench::new("");
        write_case(&bench, &recipe, "", gradient);
        std::fs::remove_file(bench.path("foam/0/phiE")).expect("it was written");
        // Points are written with all their digits.
        write_file(
            &bench,
            "system/controlDict",
            "dictionary",
            "startFrom startTime; startTime 0; stopAt endTime; endTime 1; deltaT 1; writeControl timeStep; \
             writeInterval 1; writePrecision 17;\n",
        );
        foam_program(&bench, "blockMesh", &[]);
        if matches!(self.shape, Shape::Skewed) {
            perturb(&bench, WIDTH, (WIDTH / CELL) as usize, 0.2);
        }
        self.changes.iter().for_each(|change| change(&bench));
        let Frame { turn, scale, sign, .. } = self.content.frame;
        move_points(&bench, |point| self.content.frame.place(&point));
        if turn.determinant() < 0.0 {
            reverse_faces(&bench);
        }
        // Patches that are cut begin with the name of the whole.
        let (volts, slope) = (20.0 * scale * sign, -2000.0 * sign);
        write_potential(
            &bench,
            &format!(
                "\"x1.*\" {{ type fixedValue; value uniform {volts}; }} \"y0.*\" {{ type zeroGradient; }} \
                 \"y1.*\" {{ type fixedGradient; gradient uniform {slope}; }} \
                 \"(x0|z0|z1|left|right).*\" {{ type fixedValue; value uniform 0; }}"
            ),
        );
        bench
    }
}

impl Recipe {
    /// Recipe of four blocks, 12 mm long, of which the lower two are not joined.
    fn text(&self) -> String {
        let (x, y, z) = ([0.0, 4.5, 12.0], [0.0, WIDTH], [0.0, 0.5 * WIDTH, WIDTH]);
        let mut vertices = String::new();
        let mut add = |place: [f64; 3]| {
            let [x, y, z] = place.map(|x| 1e-3 * x / self.unit);
            write!(vertices, "({x} {y} {z}) ").expect("memory");
        };
        for x in x {
            for y in y {
                z.into_iter().for_each(|z| add([x, y, z]));
            }
        }
        // The second lower block has corners of its own at the sheet, but for the sheet's end.
        y.into_iter().for_each(|y| add([x[1], y, z[0]]));
        let corner = |block: usize, ix: usize, iy: usize, iz: usize| {
            let is_own = self.has_sheet && block == 1 && ix == 1 && iz == 0;
            if is_own { 18 + iy } else { (ix * 2 + iy) * 3 + iz }
        };
        let (mut blocks, mut faces) = (String::new(), vec![String::new(); PATCHES.len()]);
        for (block, low) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let corners = CORNERS.map(|[dx, dy, dz]| corner(block, block + dx, dy, low + dz));
            let text = corners.map(|corner| corner.to_string()).join(" ");
            let along = ((x[block + 1] - x[block]) / CELL) as usize;
            let (across, half) = ((WIDTH / CELL) as usize, (0.5 * WIDTH / CELL) as usize);
            write!(blocks, "hex ({text}) ({along} {across} {half}) simpleGrading (1 1 1) ").expect("memory");
            let mut end = |patch: usize, side: usize| {
                let text = SIDES[side].map(|corner| corners[corner].to_string()).join(" ");
                write!(faces[patch], "({text}) ").expect("memory");
            };
            end(block, block);
            end(2, 2);
            end(3, 3);
            end(4 + low, 4 + low);
            if self.has_sheet && low == 0 {
                end(6 + block, 1 - block);
            }
        }
        let patches = self.patches.iter().filter_map(|name| {
            let patch = PATCHES.iter().position(|known| known == name).expect("a patch of this box");
            let has_faces = !faces[patch].is_empty();
            has_faces.then(|| format!("{name} {{ type wall; faces ({}); }}\n", faces[patch]))
        });
        format!(
            "scale {};\nvertices ({vertices});\nblocks ({blocks});\nboundary ({});\n",
            self.unit,
            patches.collect::<String>()
        )
    }
}

/// Turns all faces round, as a mirrored mesh needs it.
fn reverse_faces(bench: &Workbench) {
    const FACES: &str = "foam/constant/polyMesh/faces";
    let text = bench.read(FACES);
    let lines = text.lines().map(|line| {
        let Some((count, corners)) = line.trim_end_matches(')').split_once('(') else {
            return line.to_owned();
        };
        if count.is_empty() || count.parse::<usize>().is_err() {
            return line.to_owned();
        }
        let corners: Vec<&str> = corners.split(' ').rev().collect();
        format!("{count}({})", corners.join(" "))
    });
    bench.write(FACES, lines.collect::<Vec<_>>().join("\n"));
}

pub(super) fn renumber(bench: &Workbench) {
    foam_program(bench, "renumberMesh", &["-overwrite"]);
}

/// Entry of the file `boundary`.
#[derive(Debug)]
struct Patch {
    name: String,
    start: usize,
    faces: usize,
}

fn read_patches(bench: &Workbench) -> Vec<Patch> {
    let text = bench.read("foam/constant/polyMesh/boundary");
    let body = &text[text.rfind("\n(\n").expect("a list") + 3..];
    let entries = body.split('}').filter_map(|entry| entry.split_once('{'));
    entries
        .map(|(name, entry)| {
            let number = |key: &str| {
                let rest = &entry[entry.find(key).expect("an entry") + key.len()..];
                rest[..rest.find(';').expect("its end")].trim().parse().expect("a number")
            };
            Patch { name: name.trim().to_owned(), start: number("startFace"), faces: number("nFaces") }
        })
        .collect()
}

fn write_patches(bench: &Workbench, patches: &[Patch]) {
    let mut text = format!("{}\n(\n", patches.len());
    for Patch { name, start, faces } in patches {
        writeln!(text, "{name} {{ type wall; nFaces {faces}; startFace {start}; }}").expect("memory");
    }
    write_file(bench, "constant/polyMesh/boundary", "polyBoundaryMesh", &(text + ")\n"));
}

/// Cuts each patch in two.
pub(super) fn split_patches(bench: &Workbench) {
    let halves = read_patches(bench).into_iter().flat_map(|Patch { name, start, faces }| {
        let half = faces / 3;
        let second = Patch { name: format!("{name}Second"), start: start + half, faces: faces - half };
        [Patch { name, start, faces: half }, second]
    });
    write_patches(bench, &halves.collect::<Vec<_>>());
}

/// Makes one patch of the last four, which are all grounded.
pub(super) fn join_patches(bench: &Workbench) {
    let mut patches = read_patches(bench);
    let last = patches.split_off(4);
    let faces = last.iter().map(|patch| patch.faces).sum();
    patches.push(Patch { name: "z0AndOthers".to_owned(), start: last[0].start, faces });
    write_patches(bench, &patches);
}

/// Cuts the cells beyond x = 9 mm, where no grain is, into eight each.
pub(super) fn refine_far_away(bench: &Workbench) {
    refine(bench, [9e-3, -1.0, -1.0], [1.0; 3]);
}

/// Cuts the sheet into a mesh without one.
pub(super) fn cut_the_sheet(bench: &Workbench) {
    write_file(
        bench,
        "system/topoSetDict",
        "dictionary",
        "actions (\n\
         { name sheet; type faceSet; action new; source boxToFace; box (4.49e-3 -1 -1) (4.51e-3 1 3e-3); }\n\
         { name sheet; type faceZoneSet; action new; source setToFaceZone; faceSet sheet; }\n);\n",
    );
    write_file(
        bench,
        "system/createBafflesDict",
        "dictionary",
        "internalFacesOnly true; baffles { sheet { type faceZone; zoneName sheet;\n\
         patches { master { name left; type wall; } slave { name right; type wall; } } } }\n",
    );
    foam_program(bench, "topoSet", &[]);
    foam_program(bench, "createBaffles", &["-overwrite"]);
}
