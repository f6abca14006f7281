//! Plates, corners and bends over OpenFOAM: what a wall hides is hidden, edges have their own fields, and
//! cells change little.

use super::{difference, good};
use amberfield_core::{Permittivity, Vector3};
use amberfield_oracle::GroundedWedge;
use amberfield_tests::foam_case::{Random, write_case};
use amberfield_tests::{CsvTable, Workbench};
use std::fmt::Write as _;

const SCENE: &str = "[particles]\nfile = 'grains.csv'\n[electric_field]\ntuning = 'model'\ntolerance = 1e-2\n\
    [solver]\nopenfoam_case = 'foam'\ntimeout_s = 60.0\n";
const GROUND: &str = "walls { type fixedValue; value uniform 0; }";
/// Exact E along x of a charge of 1 pC a millimetre before the middle of a wall of a grounded box of 5 by 10
/// by 10 mm, at the charge, and 2 mm farther from the wall [V/m].
const BEFORE_THE_PLATE: [f64; 2] = [2146.7, -1824.2];
/// Field behind the plate, and error before it, over the field at the charge (0.05 to 0.6 % seen).
const SHIELDED: f64 = 0.01;
/// Radius of a grain at edges [m], a quarter of a cell, and the error there over its field at a plane (0.1 to
/// 0.5 % seen; 1.0 % at a plate's tip, where the wedge is not the whole truth).
const GRAIN: f64 = 1e-4;
const AT_EDGE: f64 = 0.015;
/// Difference of E between 12 and 24 cells across an arm of a bend, of which half is the coarse mesh's (1.0 %
/// seen).
const BEND: f64 = 0.03;

/// Box of 10 mm of two blocks, with a plate of a thickness [mm] between them from x = 5 mm on.
fn box_with_plate(thickness: f64) -> String {
    let mut text = "convertToMeters 1e-3;\nvertices (".to_owned();
    for [low, high] in [[0.0, 5.0], [5.0 + thickness, 10.0]] {
        for z in [0, 10] {
            write!(text, "({low} 0 {z}) ({high} 0 {z}) ({high} 10 {z}) ({low} 10 {z}) ").unwrap();
        }
    }
    let behind = (2.0 * (5.0 - thickness)).round();
    write!(
        text,
        ");\nblocks (hex (0 1 2 3 4 5 6 7) (10 20 20) simpleGrading (1 1 1) hex (8 9 10 11 12 13 14 15) \
         ({behind} 20 20) simpleGrading (1 1 1));\ndefaultPatch {{ name walls; type wall; }}\nboundary ();\n"
    )
    .unwrap();
    text
}

/// Bend of two arms 5 mm wide and deep, with so many cells across an arm.
fn bend(cells: usize) -> String {
    let mut text = "convertToMeters 1e-3;\nvertices (".to_owned();
    for [z, y] in [[0, 0], [0, 5], [5, 0], [5, 5], [10, 0], [10, 5]] {
        for x in [0, 5, 10] {
            write!(text, "({x} {y} {z}) ").unwrap();
        }
    }
    text.push_str(");\nblocks (");
    for first in [0, 1, 6] {
        let corners = [0, 1, 4, 3, 6, 7, 10, 9].map(|corner| (first + corner).to_string()).join(" ");
        write!(text, "hex ({corners}) ({cells} {cells} {cells}) simpleGrading (1 1 1) ").unwrap();
    }
    text.push_str(");\ndefaultPatch { name walls; type wall; }\nboundary ();\n");
    text
}

/// Prism of a corner of an angle [rad] at the origin, its sides 12 mm long, with faces of 0.43 mm.
fn corner(angle: f64) -> String {
    let (b, c) = ([12.0, 0.0], [12.0 * angle.cos(), 12.0 * angle.sin()]);
    let mean = |of: &[[f64; 2]]| [0, 1].map(|axis| of.iter().map(|p| p[axis]).sum::<f64>() / of.len() as f64);
    let a = [0.0, 0.0];
    let points = [a, b, c, mean(&[a, b]), mean(&[b, c]), mean(&[c, a]), mean(&[a, b, c])];
    let mut text = "convertToMeters 1e-3;\nvertices (".to_owned();
    for z in [-5, 5] {
        for [x, y] in points {
            write!(text, "({x} {y} {z}) ").unwrap();
        }
    }
    text.push_str(");\nblocks (");
    for quad in [[0, 3, 6, 5], [3, 1, 4, 6], [5, 6, 4, 2]] {
        let corners: Vec<String> = [0, 7].iter().flat_map(|z| quad.map(|p| (p + z).to_string())).collect();
        write!(text, "hex ({}) (14 14 20) simpleGrading (1 1 1) ", corners.join(" ")).unwrap();
    }
    text.push_str(");\ndefaultPatch { name walls; type wall; }\nboundary ();\n");
    text
}

/// Box of 10 mm with a plate of a thickness [mm] that stands on its floor, y = 0, up to half the height, in
/// cells of half a millimetre.
fn box_with_blunt_plate(thickness: f64) -> String {
    let mut text = "convertToMeters 1e-3;\nvertices (".to_owned();
    for z in [0, 10] {
        for y in [0, 5, 10] {
            for x in [-5.0, -0.5 * thickness, 0.5 * thickness, 5.0] {
                write!(text, "({x} {y} {z}) ").unwrap();
            }
        }
    }
    text.push_str(");\nblocks (");
    let through = (2.0 * thickness).round().max(1.0);
    for [x, y] in [[0, 0], [2, 0], [0, 1], [1, 1], [2, 1]] {
        let corners = [0, 1, 5, 4, 12, 13, 17, 16].map(|corner| (x + 4 * y + corner).to_string()).join(" ");
        let across = if x == 1 { through } else { 10.0 };
        write!(text, "hex ({corners}) ({across} 10 20) simpleGrading (1 1 1) ").unwrap();
    }
    text.push_str(");\ndefaultPatch { name walls; type wall; }\nboundary ();\n");
    text
}

/// Frame of an edge: a point of it [m], and the directions of the first face, away from it, and along it.
struct Frame {
    origin: Vector3<f64>,
    axes: [Vector3<f64>; 3],
}

impl Frame {
    fn turned(&self, v: &Vector3<f64>) -> Vector3<f64> {
        Vector3::from(self.axes.map(|axis| axis.dot(v)))
    }

    /// Errors of E at charges of 1 pC and at probes [m], over the field of a grain of radius [`GRAIN`] that
    /// touches a plane.
    fn errors(&self, mesh: &str, angle: f64, charges: &[Vector3<f64>], probes: &[Vector3<f64>]) -> Vec<f64> {
        let positions = [charges, probes].concat();
        let mut amounts = vec![0.0; positions.len()];
        amounts[..charges.len()].fill(1e-12);
        let e = field(mesh, &positions, &amounts);
        let coulomb = Permittivity::VACUUM.coulomb() * 1e-12;
        let local = |place: &Vector3<f64>| self.turned(&(place - self.origin));
        let sources: Vec<_> = charges.iter().map(local).collect();
        let wedge = GroundedWedge { angle };
        let error = |(place, e): (&Vector3<f64>, &[f64])| {
            let exact = coulomb * wedge.field(&local(place), &sources);
            (self.turned(&Vector3::new(e[0], e[1], e[2])) - exact).norm() / (coulomb / (4.0 * GRAIN * GRAIN))
        };
        positions.iter().zip(e.chunks(3)).map(error).collect()
    }
}

/// E at grains [V/m], three numbers a grain.
fn field(mesh: &str, positions: &[Vector3<f64>], charges: &[f64]) -> Vec<f64> {
    let bench = Workbench::new(SCENE);
    write_case(&bench, mesh, GROUND, "Gauss linear");
    let mut text = "id,x_m,y_m,z_m,radius_m,charge_C\n".to_owned();
    for (id, (at, charge)) in positions.iter().zip(charges).enumerate() {
        writeln!(text, "{id},{},{},{},0,{charge}", at.x, at.y, at.z).unwrap();
    }
    bench.write("grains.csv", text);
    good(&bench.run(&["field", "scene.toml", "--out", "out.csv"]));
    let table = CsvTable::parse(&bench.read("out.csv"));
    let [x, y, z] = ["ex_V_per_m", "ey_V_per_m", "ez_V_per_m"].map(|name| table.numbers(name));
    (0..x.len()).flat_map(|grain| [x[grain], y[grain], z[grain]]).collect()
}

#[test]
fn plate_of_any_thickness_hides_one_half_of_a_box_from_the_other() {
    for thickness in [0.0, 0.5, 1.0] {
        let behind = 6.0 + thickness;
        let places = [[4.0, 5.0, 5.0], [2.0, 5.0, 5.0], [behind, 5.0, 5.0], [behind + 1.0, 5.0, 5.0]];
        let aside = [0.5 + behind - 1.0, 3.0, 5.0];
        let positions: Vec<_> =
            places.iter().chain([&aside]).map(|&place| 1e-3 * Vector3::from(place)).collect();
        let e = field(&box_with_plate(thickness), &positions, &[1e-12, 0.0, 0.0, 0.0, 0.0]);
        let most = SHIELDED * BEFORE_THE_PLATE[0];
        for (grain, along_x) in BEFORE_THE_PLATE.into_iter().enumerate() {
            let [x, y, z] = [0, 1, 2].map(|axis| e[3 * grain + axis]);
            assert!((x - along_x).hypot(y.hypot(z)) < most, "{thickness} mm, grain {grain}: {x} {y} {z}");
        }
        assert!(e[6..].iter().all(|e| e.abs() < most), "{thickness} mm: {e:?}");
    }
}

#[test]
fn field_in_a_bend_changes_little_with_the_cells() {
    let mut random = Random(4);
    let mut positions: Vec<Vector3<f64>> = Vec::new();
    while positions.len() < 600 {
        let [x, y, z] = [10.0, 5.0, 10.0].map(|edge| 0.3 + random.number() * (edge - 0.6));
        let from_edge = (5.0 - x).max(0.0).hypot((5.0 - z).max(0.0));
        let is_inside = x < 4.7 || z < 4.7 || (x < 5.0 && z < 5.0 && from_edge > 0.3);
        let next = 1e-3 * Vector3::new(x, y, z);
        if is_inside && positions.iter().all(|other| (other - next).norm() > 6e-4) {
            positions.push(next);
        }
    }
    let charges: Vec<f64> = (0..600).map(|grain| if grain % 2 == 0 { 1e-12 } else { -1e-12 }).collect();
    let [coarse, fine] = [12, 24].map(|cells| field(&bend(cells), &positions, &charges));
    let apart = difference(&coarse, &fine);
    assert!(apart < BEND, "{apart}");
}

/// Grains that touch both walls of a corner, or one beside the edge, and probes beside them: images of planes
/// have no place in a corner of 120 degrees, and five, which see each other, in one of 60.
#[test]
fn corners_of_any_angle_have_their_own_field() {
    for degrees in [45.0_f64, 60.0, 120.0] {
        let angle = degrees.to_radians();
        let at = |r: f64, phi: f64, z: f64| Vector3::new(r * phi.cos(), r * phi.sin(), 1e-3 * z);
        let touching = GRAIN / (0.5 * angle).sin();
        let beside = 4.0 * touching;
        let charges = [
            at(touching, 0.5 * angle, -2.0),
            at(2.0 * touching, 0.5 * angle, 0.0),
            at(beside, (GRAIN / beside).asin(), 2.0),
        ];
        let probes = [at(2.0 * touching, 0.5 * angle, -2.1), at(1.5 * touching, 0.6 * angle, 1.8)];
        let frame = Frame { origin: Vector3::zeros(), axes: [Vector3::x(), Vector3::y(), Vector3::z()] };
        let errors = frame.errors(&corner(angle), angle, &charges, &probes);
        assert!(errors.iter().all(|error| *error < AT_EDGE), "{degrees} degrees: {errors:?}");
    }
}

/// Grains around the edge of a plate a cell or two thick: for them it is the edge of an endless block.
#[test]
fn tips_of_plates_have_the_field_of_their_edges() {
    let angle = 1.5 * std::f64::consts::PI;
    for thickness in [0.5, 1.0] {
        let edge = Vector3::new(0.5e-3 * thickness, 5e-3, 0.0);
        let at = |x: f64, y: f64, z: f64| {
            edge + GRAIN * Vector3::new(x, y, 0.0) + Vector3::new(0.0, 0.0, 1e-3 * z)
        };
        let charges = [at(1.0, 0.02, 2.4), at(1.0, -3.0, 4.9), at(0.7, 0.7, 7.4)];
        let probes = [at(2.0, -2.0, 2.4), at(1.0, 3.0, 7.5)];
        let axes = [-Vector3::y(), Vector3::x(), Vector3::z()];
        let errors =
            Frame { origin: edge, axes }.errors(&box_with_blunt_plate(thickness), angle, &charges, &probes);
        assert!(errors.iter().all(|error| *error < AT_EDGE), "{thickness} mm: {errors:?}");
    }
}
