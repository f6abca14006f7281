//! The error that is stated over meshes of many shapes, against the truth: clouds of few and of many grains.

#![expect(clippy::print_stdout, reason = "how good it is, for whoever asks with --nocapture")]

use super::meshes::{case, mesh_of, solver};
use amberfield_core::{Boundary, Domain, FieldSettings, Method, Permittivity, Tuning, Vector3};
use amberfield_field::{ElectricField, FieldValues, Wanted};
use amberfield_oracle::{GroundedCylinder, grounded_cavity};
use amberfield_tests::Workbench;
use amberfield_tests::foam_case::{
    Random, ball, brick, cylinder, foam_command_on, foam_program, write_case, write_file,
};
use amberfield_tests::foam_refinement::refine;

/// Edge of the boxes, and diameter of the ball and the cylinder [mm].
const EDGE: f64 = 12.0;
const CHARGE: f64 = 1e-12;
/// Tolerance of what stands for the truth, where no closed form does.
const TRUE: f64 = 1e-5;
/// Stated over true error, at least and at most, in nine of ten scenes; and at least in all.
const MOSTLY: [f64; 2] = [0.5, 2.0];
const NEVER_BELOW: f64 = 1.0 / 3.0;
/// Grains up to which the truth is a direct sum.
const FEW: usize = 200;

/// Shape of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    /// Grounded cube of some kind of cells.
    Cube(&'static str),
    /// Grounded cube, half of which has cells of half the size.
    Hanging,
    /// Grounded cube with a sheet across its middle.
    Divided,
    /// Box with two cyclic, two insulating, a grounded and a charged side.
    Mixed,
    /// Grounded ball.
    Ball,
    /// Grounded cylinder.
    Cylinder,
}

/// Grains in a mesh.
#[derive(Clone, Copy, Debug)]
struct Scene {
    shape: Shape,
    cells: usize,
    grains: usize,
    one_sign: bool,
    tolerance: f64,
}

impl Scene {
    fn case(&self) -> Workbench {
        let cells = self.cells;
        match self.shape {
            Shape::Cube(kind) => mesh_of(kind, cells),
            Shape::Hanging => {
                let bench = mesh_of("hexahedra", cells);
                foam_program(&bench, "blockMesh", &[]);
                refine(&bench, [-1.0, -1.0, 0.5e-3 * EDGE], [1.0; 3]);
                bench
            }
            Shape::Divided => {
                let bench = mesh_of("hexahedra", cells);
                foam_program(&bench, "blockMesh", &[]);
                divide(&bench);
                bench
            }
            Shape::Mixed => {
                let (cyclic, lid) = (("cyclic", "type cyclic;"), ("wall", "type zeroGradient;"));
                let plates = ["0", "200"].map(|volts| format!("type fixedValue; value uniform {volts};"));
                let [low, high] = plates.each_ref().map(|plate| ("wall", plate.as_str()));
                let brick = brick([EDGE; 3], [cells; 3], &[cyclic, cyclic, lid, lid, low, high]);
                let bench = Workbench::new("");
                write_case(&bench, &brick.mesh, &brick.conditions, "Gauss linear");
                bench
            }
            Shape::Ball => case(&ball(0.5 * EDGE, cells, cells * 3 / 5), "leastSquares"),
            Shape::Cylinder => case(&cylinder(0.5 * EDGE, EDGE, [cells, cells], cells / 2), "leastSquares"),
        }
    }

    /// Places inside, on a lattice with a shake of less than the grains' distance [m].
    fn positions(&self) -> Vec<Vector3<f64>> {
        let edge = 1e-3 * EDGE;
        let share = match self.shape {
            Shape::Ball => std::f64::consts::PI / 6.0,
            Shape::Cylinder => std::f64::consts::FRAC_PI_4,
            _ => 1.0,
        };
        let mut random = Random(11);
        let mut lattice = (self.grains as f64 / share).cbrt().ceil() as usize;
        loop {
            let spacing = edge / lattice as f64;
            let mut places: Vec<Vector3<f64>> = (0..lattice.pow(3))
                .map(|i| {
                    let node = [i % lattice, i / lattice % lattice, i / lattice / lattice];
                    Vector3::from(node.map(|k| (k as f64 + 0.5 + 0.6 * (random.number() - 0.5)) * spacing))
                })
                .filter(|place| self.holds(place, 0.2 * spacing))
                .collect();
            if places.len() < self.grains {
                lattice += 1;
                continue;
            }
            // The surplus is left out anywhere.
            while places.len() > self.grains {
                let index = (random.number() * places.len() as f64) as usize;
                places.swap_remove(index);
            }
            return places.iter().map(|place| self.moved(place)).collect();
        }
    }

    /// Whether a place in the cube is a distance from all walls [m].
    fn holds(&self, place: &Vector3<f64>, distance: f64) -> bool {
        let half = 0.5e-3 * EDGE;
        let from_middle = place - Vector3::repeat(half);
        let flat = from_middle.xy().norm();
        match self.shape {
            Shape::Ball => from_middle.norm() < half - distance,
            Shape::Cylinder => flat < half - distance,
            Shape::Divided => from_middle.x.abs() > distance,
            _ => true,
        }
    }

    /// A place of the cube in the frame of the mesh.
    fn moved(&self, place: &Vector3<f64>) -> Vector3<f64> {
        let half = 0.5e-3 * EDGE;
        match self.shape {
            Shape::Ball => place - Vector3::repeat(half),
            Shape::Cylinder => place - Vector3::new(half, half, 0.0),
            _ => *place,
        }
    }

    /// The exact field [V/m].
    fn truth(&self, positions: &[Vector3<f64>], charges: &[f64]) -> Vec<Vector3<f64>> {
        let (edge, coulomb) = (1e-3 * EDGE, Permittivity::VACUUM.coulomb());
        let grounded = [[Boundary::Grounded; 2]; 3];
        let in_box = |min: f64, max: f64, faces, positions: &[Vector3<f64>], charges: &[f64]| {
            let (min, max) = (Vector3::new(min, 0.0, 0.0), Vector3::new(max, edge, edge));
            let domain = Domain::new(min, max, faces).unwrap();
            let method = if positions.len() <= FEW { Method::Direct } else { Method::default() };
            let settings =
                FieldSettings { tolerance: TRUE, tuning: Tuning::Model, method, ..FieldSettings::default() };
            let mut field = ElectricField::new(&domain, &settings, positions, charges).unwrap();
            evaluate(&mut field, positions, charges)
        };
        match self.shape {
            Shape::Cube(_) | Shape::Hanging => in_box(0.0, edge, grounded, positions, charges),
            Shape::Mixed => {
                let insulating = Boundary::Insulating { normal_field_v_m: 0.0 };
                let plates = [Boundary::Grounded, Boundary::Potential(200.0)];
                let faces = [[Boundary::Periodic; 2], [insulating; 2], plates];
                in_box(0.0, edge, faces, positions, charges)
            }
            Shape::Divided => {
                let mut truth = vec![Vector3::zeros(); positions.len()];
                for (low, high) in [(0.0, 0.5 * edge), (0.5 * edge, edge)] {
                    let is_here = |index: &usize| (low..high).contains(&positions[*index].x);
                    let here: Vec<usize> = (0..positions.len()).filter(is_here).collect();
                    let places: Vec<_> = here.iter().map(|&index| positions[index]).collect();
                    let amounts: Vec<_> = here.iter().map(|&index| charges[index]).collect();
                    let e = in_box(low, high, grounded, &places, &amounts);
                    here.iter().zip(e).for_each(|(&index, e)| truth[index] = e);
                }
                truth
            }
            Shape::Ball => grounded_cavity(coulomb, 0.5 * edge, positions, charges),
            Shape::Cylinder => {
                GroundedCylinder { coulomb_constant: coulomb, radius: 0.5 * edge, length: edge }
                    .field(positions, charges)
            }
        }
    }

    /// Stated over true error of E, over the mesh of a case.
    fn ratio(&self, bench: &Workbench) -> f64 {
        let positions = self.positions();
        let sign = |grain: usize| if self.one_sign || grain.is_multiple_of(2) { CHARGE } else { -CHARGE };
        let charges: Vec<f64> = (0..positions.len()).map(sign).collect();
        let settings =
            FieldSettings { tolerance: self.tolerance, tuning: Tuning::Model, ..FieldSettings::default() };
        let mut field =
            ElectricField::over_mesh(Box::new(solver(bench)), &settings, &positions, &charges).unwrap();
        let found = evaluate(&mut field, &positions, &charges);
        let exact = self.truth(&positions, &charges);
        let squares: f64 = found.iter().zip(&exact).map(|(a, b)| (a - b).norm_squared()).sum();
        let truth = (squares / exact.iter().map(Vector3::norm_squared).sum::<f64>()).sqrt();
        let stated = field.error_measured().unwrap().relative_rms;
        println!("{self:?}: {truth:.2e}, stated {stated:.2e}, ratio {:.2}", stated / truth);
        stated / truth
    }
}

fn evaluate(field: &mut ElectricField, positions: &[Vector3<f64>], charges: &[f64]) -> Vec<Vector3<f64>> {
    let mut values = FieldValues::default();
    field.evaluate(positions, charges, Wanted::default(), &mut values).unwrap();
    values.e
}

/// Cuts a sheet without thickness across the middle of a cube.
fn divide(bench: &Workbench) {
    let half = 0.5e-3 * EDGE;
    let low = half - 1e-6;
    let high = half + 1e-6;
    write_file(
        bench,
        "system/topoSetDict",
        "dictionary",
        &format!(
            "actions ({{ name sheet; type faceSet; action new; source boxToFace; box ({low} -1 -1) ({high} 1 \
             1); }} {{ name sheet; type faceZoneSet; action new; source setToFaceZone; faceSet sheet; }});\n"
        ),
    );
    write_file(
        bench,
        "system/createBafflesDict",
        "dictionary",
        "internalFacesOnly true; baffles { sheet { type faceZone; zoneName sheet; patches { master { name \
         left; type wall; } slave { name right; type wall; } } } }\n",
    );
    foam_program(bench, "topoSet", &[]);
    foam_command_on(bench, "createBaffles", &["-overwrite"]);
}

#[test]
fn error_that_is_stated_is_the_error() {
    let mut ratios = Vec::new();
    let shapes = [
        (Shape::Cube("hexahedra"), 12),
        (Shape::Cube("graded"), 12),
        (Shape::Cube("perturbed"), 12),
        (Shape::Cube("tetrahedra"), 7),
        (Shape::Cube("polyhedra"), 8),
        (Shape::Hanging, 10),
        (Shape::Divided, 12),
        (Shape::Mixed, 12),
        (Shape::Ball, 10),
        (Shape::Cylinder, 10),
    ];
    for (shape, cells) in shapes {
        let scene = Scene { shape, cells, grains: 10, one_sign: false, tolerance: 1e-2 };
        let bench = scene.case();
        // The truth of a cylinder is a sum over pairs of series.
        let counts = if shape == Shape::Cylinder { [10, 30, 100] } else { [10, 300, 2000] };
        for grains in counts {
            for one_sign in [false, true] {
                ratios.push(Scene { grains, one_sign, ..scene }.ratio(&bench));
            }
        }
    }
    let many = Scene {
        shape: Shape::Cube("hexahedra"),
        cells: 20,
        grains: 100_000,
        one_sign: true,
        tolerance: 1e-2,
    };
    // What the mesh does not give.
    let coarse =
        Scene { shape: Shape::Cube("polyhedra"), cells: 8, grains: 300, one_sign: false, tolerance: 1e-3 };
    ratios.extend([many, coarse].map(|scene| scene.ratio(&scene.case())));
    let off = ratios.iter().filter(|ratio| !(MOSTLY[0]..=MOSTLY[1]).contains(*ratio)).count();
    assert!(10 * off <= ratios.len() && ratios.iter().all(|ratio| *ratio > NEVER_BELOW), "{ratios:?}");
}
