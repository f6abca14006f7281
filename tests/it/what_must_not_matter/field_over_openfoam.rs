//! The field over a mesh, by OpenFOAM: what its files and processes may change.

use super::foam_boxes::{
    FoamScene, PATCHES, Recipe, Shape, cut_the_sheet, join_patches, refine_far_away, renumber, split_patches,
};
use super::lines::{Demand, Line, SAME, assert_that_nothing_matters};
use super::scene::{Content, Frame, cloud, grain};
use crate::openfoam::difference;
use amberfield_tests::CsvTable;
use std::f64::consts::FRAC_PI_2;
use std::fmt::Write as _;

fn scene(shape: Shape) -> FoamScene {
    let sets = vec![
        cloud(60, [0.3; 3], [if matches!(shape, Shape::Sheet) { 7.5 } else { 5.7 }, 5.7, 5.7], 0.5, 3),
        vec![grain(0, [4.0, 2.9, 1.7], 1.0)],
        vec![grain(0, [4.2, 3.2, 3.1], 1.0)],
        vec![grain(0, [1.1, 2.7, 5.6], -2.0)],
    ];
    FoamScene {
        content: Content::new(sets),
        shape,
        ranks: 1,
        recipe: Recipe { patches: PATCHES.to_vec(), unit: 1e-3, has_sheet: true },
        changes: Vec::new(),
    }
}

const ON_RANKS: [Line<FoamScene>; 3] = [
    Line { name: "two ranks", demand: Demand::ByOtherRanks, change: |scene| scene.ranks = 2 },
    Line { name: "three ranks", demand: Demand::ByOtherRanks, change: |scene| scene.ranks = 3 },
    Line { name: "four ranks", demand: Demand::ByOtherRanks, change: |scene| scene.ranks = 4 },
];
const RENUMBERED: Line<FoamScene> =
    Line { name: "renumberMesh", demand: Demand::Same, change: |scene| scene.changes.push(renumber) };
const AFTER_OTHERS: Line<FoamScene> = Line {
    name: "other grains before",
    demand: Demand::Same,
    change: |scene| scene.content.has_history = true,
};
const MIRRORED: Line<FoamScene> =
    Line { name: "mirrored", demand: Demand::Same, change: |scene| scene.content.frame = Frame::mirrored() };

#[test]
fn field_around_a_sheet_does_not_see_ranks() {
    assert_that_nothing_matters(&scene(Shape::Sheet), &ON_RANKS);
}

#[test]
fn field_around_a_sheet_does_not_see_how_the_mesh_is_written_down() {
    let lines: [Line<FoamScene>; 7] = [
        RENUMBERED,
        Line { name: "metres", demand: Demand::Same, change: |scene| scene.recipe.unit = 1.0 },
        Line {
            name: "sheet by createBaffles",
            demand: Demand::Same,
            change: |scene| {
                scene.recipe.has_sheet = false;
                scene.changes.push(cut_the_sheet);
            },
        },
        Line {
            name: "patches in another order",
            demand: Demand::Same,
            change: |scene| scene.recipe.patches.reverse(),
        },
        Line {
            name: "patches split",
            demand: Demand::Same,
            change: |scene| scene.changes.push(split_patches),
        },
        Line {
            name: "patches joined",
            demand: Demand::Same,
            change: |scene| scene.changes.push(join_patches),
        },
        Line {
            name: "cells refined where nothing is",
            demand: Demand::WithinStated,
            change: |scene| scene.changes.push(refine_far_away),
        },
    ];
    assert_that_nothing_matters(&scene(Shape::Sheet), &lines);
}

#[test]
fn field_around_a_sheet_does_not_see_names_and_rows_of_grains_nor_threads() {
    let scene = scene(Shape::Sheet);
    let bench = scene.case();
    bench.write(
        "scene.toml",
        "[particles]\nfile = 'grains.csv'\n[electric_field]\ntuning = 'model'\nfar_tolerance = 1e-10\n\
         [solver]\nopenfoam_case = 'foam'\ntimeout_s = 120.0\n",
    );
    let grains = &scene.content.sets[0];
    // E by grain [V/m], however the grains are called and in whatever rows they stand.
    let field = |ids: &[usize], rows: &[usize], threads: &str| {
        let mut text = "id,x_m,y_m,z_m,radius_m,charge_C\n".to_owned();
        for &row in rows {
            let (at, charge) = (grains[row].place, grains[row].charge);
            writeln!(text, "{},{},{},{},1e-5,{charge}", ids[row], at.x, at.y, at.z).expect("memory");
        }
        bench.write("grains.csv", text);
        let mut command = bench.command(&["field", "scene.toml", "--out", "out.csv"]);
        let output = command.env("RAYON_NUM_THREADS", threads).output().expect("it starts");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(matches!(output.status.code(), Some(0 | 4)), "{said}");
        let table = CsvTable::parse(&bench.read("out.csv"));
        let [id, x, y, z] = ["id", "ex_V_per_m", "ey_V_per_m", "ez_V_per_m"].map(|name| table.numbers(name));
        let e = |grain: usize| {
            let row = id.iter().position(|id| *id == ids[grain] as f64).expect("the grain is there");
            [x[row], y[row], z[row]]
        };
        (0..grains.len()).flat_map(e).collect::<Vec<f64>>()
    };
    let ascending: Vec<usize> = (0..grains.len()).collect();
    let descending: Vec<usize> = ascending.iter().rev().copied().collect();
    let others: Vec<usize> = ascending.iter().map(|grain| 900_000 - 17 * grain).collect();
    let known = field(&ascending, &ascending, "2");
    assert_eq!(field(&others, &ascending, "1"), known, "names and threads change nothing at all");
    let apart = difference(&field(&ascending, &descending, "3"), &known);
    assert!(apart < SAME, "{apart:e}");
}

#[test]
fn field_around_a_sheet_does_not_see_how_the_mesh_is_looked_at() {
    let lines: [Line<FoamScene>; 6] = [
        Line {
            name: "shifted",
            demand: Demand::Same,
            change: |scene| scene.content.frame = Frame::shifted([0.37, -1.2, 0.051]),
        },
        Line {
            name: "turned by 90° about y",
            demand: Demand::Same,
            change: |scene| scene.content.frame = Frame::turned([0.0, 1.0, 0.0], FRAC_PI_2),
        },
        MIRRORED,
        AFTER_OTHERS,
        Line {
            name: "the other sign of charge, in a medium",
            demand: Demand::Same,
            change: |scene| scene.content.frame = Frame { medium: 3.7, ..Frame::of_other_sign() },
        },
        Line {
            name: "a thousand times larger",
            demand: Demand::Same,
            change: |scene| scene.content.frame = Frame::scaled(1e3),
        },
    ];
    assert_that_nothing_matters(&scene(Shape::Sheet), &lines);
}

#[test]
fn field_in_cells_out_of_shape_sees_none_of_it() {
    let lines: [Line<FoamScene>; 6] = [
        RENUMBERED,
        MIRRORED,
        AFTER_OTHERS,
        Line { name: "three ranks", demand: Demand::ByOtherRanks, change: |scene| scene.ranks = 3 },
        Line {
            name: "turned by an oblique angle",
            demand: Demand::WithinStated,
            change: |scene| scene.content.frame = Frame::turned([1.0, 2.0, -0.7], 0.6),
        },
        Line {
            name: "tolerance halved",
            demand: Demand::WithinStated,
            change: |scene| scene.content.tolerance *= 0.5,
        },
    ];
    assert_that_nothing_matters(&scene(Shape::Skewed), &lines);
}
