//! The field over a mesh, by the stand-in for a field solver.

use super::boxes::{
    BoxScene, Sheet, in_another_order, with_patches_joined, with_patches_reversed, with_patches_split,
};
use super::lines::{Demand, Line, assert_that_nothing_matters, what_matters};
use super::scene::{Content, Frame, Grain, cloud, grain};
use amberfield_core::Boundary;
use amberfield_field::far::Condition;
use std::f64::consts::FRAC_PI_2;

const INSULATING: Boundary = Boundary::Insulating { normal_field_v_m: 0.0 };
const GROUNDED: [[Boundary; 2]; 3] = [[Boundary::Grounded; 2]; 3];
/// Faces of every kind.
const MIXED: [[Boundary; 2]; 3] = [
    [Boundary::Grounded, Boundary::Potential(20.0)],
    [INSULATING, Boundary::Insulating { normal_field_v_m: 2e3 }],
    [Boundary::Grounded; 2],
];
const PERIODIC: [[Boundary; 2]; 3] = [[Boundary::Periodic; 2], [Boundary::Grounded; 2], [INSULATING; 2]];
/// Place of the sheet [mm].
const SHEET: f64 = 4.5;

/// Lines of a scene that is seen otherwise, or written down otherwise.
const SEEN_OTHERWISE: [Line<BoxScene>; 14] = [
    Line {
        name: "cells and faces in another order",
        demand: Demand::Same,
        change: |scene| scene.changes.push(in_another_order),
    },
    Line {
        name: "patches in another order",
        demand: Demand::Same,
        change: |scene| scene.changes.push(with_patches_reversed),
    },
    Line {
        name: "patches split",
        demand: Demand::Same,
        change: |scene| scene.changes.push(with_patches_split),
    },
    Line {
        name: "patches joined",
        demand: Demand::Same,
        change: |scene| scene.changes.push(with_patches_joined),
    },
    Line { name: "grains in another order", demand: Demand::Same, change: reverse_grains },
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
    Line { name: "mirrored", demand: Demand::Same, change: |scene| scene.content.frame = Frame::mirrored() },
    Line {
        name: "a thousand times larger",
        demand: Demand::Same,
        change: |scene| scene.content.frame = Frame::scaled(1e3),
    },
    Line {
        name: "a hundred times smaller",
        demand: Demand::Same,
        change: |scene| scene.content.frame = Frame::scaled(1e-2),
    },
    Line {
        name: "the other sign of charge",
        demand: Demand::Same,
        change: |scene| scene.content.frame = Frame::of_other_sign(),
    },
    Line {
        name: "charges and permittivity larger",
        demand: Demand::Same,
        change: |scene| scene.content.frame = Frame::in_medium(3.7),
    },
    Line {
        name: "other grains before",
        demand: Demand::Same,
        change: |scene| scene.content.has_history = true,
    },
    Line { name: "probes without charge added", demand: Demand::WithinStated, change: add_probes },
];
/// Line of a better answer.
const BETTER: [Line<BoxScene>; 1] = [Line {
    name: "tolerance halved",
    demand: Demand::WithinStated,
    change: |scene| scene.content.tolerance *= 0.5,
}];
/// Lines of directions that only walls of a mesh may have, not axes that repeat.
const OBLIQUE: [Line<BoxScene>; 1] = [Line {
    name: "turned by an oblique angle",
    demand: Demand::WithinStated,
    change: |scene| scene.content.frame = Frame::turned([1.0, 2.0, -0.7], 0.6),
}];

fn reverse_grains(scene: &mut BoxScene) {
    scene.content.sets.iter_mut().for_each(|grains| grains.reverse());
}

fn add_probes(scene: &mut BoxScene) {
    let probes = cloud(4, [0.5; 3], [4.0, 4.5, 5.5], 0.3, 11);
    for grains in &mut scene.content.sets {
        let first = grains.len();
        grains.extend(probes.iter().map(|probe| Grain { name: first + probe.name, charge: 0.0, ..*probe }));
    }
}

/// Sets of grains in a box of 9 by 6 by 6 mm: a cloud on both sides of the sheet's place, one beside the
/// sheet's end, one at a wall.
fn sets() -> Vec<Vec<Grain>> {
    let mut clouds = cloud(14, [0.2; 3], [4.3, 5.8, 5.8], 0.4, 3);
    let other_side = cloud(14, [4.7, 0.2, 0.2], [8.8, 5.8, 5.8], 0.4, 5);
    clouds.extend(other_side.into_iter().map(|grain| Grain { name: 14 + grain.name, ..grain }));
    vec![clouds, vec![grain(0, [4.3, 3.2, 3.1], 1.0)], vec![grain(0, [1.1, 2.7, 5.7], -2.0)]]
}

fn base(faces: [[Boundary; 2]; 3], sheets: Vec<Sheet>) -> BoxScene {
    BoxScene {
        content: Content::new(sets()),
        edges: [9.0, 6.0, 6.0],
        cells: [12, 8, 8],
        faces,
        sheets,
        changes: Vec::new(),
    }
}

fn half_a_sheet(condition: Condition) -> Vec<Sheet> {
    vec![Sheet { x: SHEET, to_z: 3.0, condition }]
}

#[test]
fn field_in_a_box_does_not_see_how_the_box_is_looked_at() {
    let scene = base(MIXED, Vec::new());
    assert_that_nothing_matters(&scene, &SEEN_OTHERWISE);
    assert_that_nothing_matters(&scene, &BETTER);
    assert_that_nothing_matters(&scene, &OBLIQUE);
}

#[test]
fn field_around_a_sheet_does_not_see_how_the_sheet_is_looked_at() {
    let scene = base(MIXED, half_a_sheet(Condition::Potential(0.0)));
    assert_that_nothing_matters(&scene, &SEEN_OTHERWISE);
    assert_that_nothing_matters(&scene, &BETTER);
    assert_that_nothing_matters(&scene, &OBLIQUE);
}

#[test]
fn field_in_a_box_that_repeats_does_not_see_how_the_box_is_looked_at() {
    let mut scene = base(PERIODIC, half_a_sheet(Condition::Potential(0.0)));
    scene.content.sets.remove(1);
    assert_that_nothing_matters(&scene, &SEEN_OTHERWISE);
    assert_that_nothing_matters(&scene, &BETTER);
    let of_periods: [Line<BoxScene>; 2] = [
        Line {
            name: "grains a period farther",
            demand: Demand::Same,
            change: |scene| {
                let grains = scene.content.sets.iter_mut().flatten();
                grains.skip(1).step_by(2).for_each(|grain| grain.place.x += 9e-3);
            },
        },
        // The grids' nodes stand elsewhere between the grains.
        Line {
            name: "seam elsewhere",
            demand: Demand::WithinStated,
            change: |scene| {
                scene.sheets[0].x += 3.0;
                scene.content.sets.iter_mut().flatten().for_each(|grain| grain.place.x += 3e-3);
            },
        },
    ];
    assert_that_nothing_matters(&scene, &of_periods);

    // Ghosts at the rim of an insulating sheet may see the sheet beyond the seam from one side only (1.3e-4
    // of E_rms seen).
    let mirrored: [Line<BoxScene>; 1] = [Line {
        name: "insulating sheet mirrored",
        demand: Demand::WithinStated,
        change: |scene| scene.content.frame = Frame::mirrored(),
    }];
    assert_that_nothing_matters(&base(PERIODIC, half_a_sheet(Condition::Slope(0.0))), &mirrored);
}

/// Case of a grounded channel 6 mm wide whose far end is 9 mm from the grains. A charge's field falls by
/// exp(−√2 π/6) per mm along it: what a wall 7 mm away answers, exp(−2·7·0.74) = 3e-5 of the field beside a
/// charge, is below what is stated, and a wall farther away answers less.
#[test]
fn field_in_a_channel_does_not_see_what_is_far_away_or_behind_a_wall() {
    let mut scene = base(GROUNDED, Vec::new());
    scene.edges[0] = 13.5;
    scene.cells[0] = 18;
    scene.content.sets = vec![
        cloud(40, [0.2; 3], [4.3, 5.8, 5.8], 0.4, 3),
        vec![grain(0, [3.6, 2.9, 1.7], 1.0)],
        vec![grain(0, [1.1, 2.7, 5.7], -2.0)],
    ];
    let lines: [Line<BoxScene>; 4] = [
        Line {
            name: "far wall farther",
            demand: Demand::WithinStated,
            change: |scene| (scene.edges[0], scene.cells[0]) = (19.5, 26),
        },
        Line {
            name: "far wall at a potential",
            demand: Demand::WithinStated,
            change: |scene| scene.faces[0][1] = Boundary::Potential(1.0),
        },
        Line { name: "sheet far away", demand: Demand::WithinStated, change: put_up_a_sheet },
        Line { name: "grains behind a sheet far away", demand: Demand::WithinStated, change: fill_behind },
    ];
    assert_that_nothing_matters(&scene, &lines);
}

fn put_up_a_sheet(scene: &mut BoxScene) {
    scene.sheets = vec![Sheet { x: 11.25, to_z: 6.0, condition: Condition::Potential(0.0) }];
}

fn fill_behind(scene: &mut BoxScene) {
    put_up_a_sheet(scene);
    for grains in &mut scene.content.sets {
        let first = grains.len();
        let behind = cloud(6, [11.6, 0.4, 0.4], [13.1, 5.6, 5.6], 0.4, 13);
        grains.extend(behind.iter().map(|grain| Grain { name: first + grain.name, ..*grain }));
    }
}

/// Changes that physics does see, so that the demands above are known to be demands.
#[test]
fn what_does_matter_is_seen() {
    let lines: [Line<BoxScene>; 3] = [
        Line {
            name: "an end insulated",
            demand: Demand::WithinStated,
            change: |scene| scene.faces[2] = [INSULATING; 2],
        },
        Line {
            name: "grains moved by a tenth of a millimetre",
            demand: Demand::WithinStated,
            change: |scene| scene.content.sets.iter_mut().flatten().for_each(|grain| grain.place.z -= 1e-4),
        },
        Line {
            name: "charges larger by 1e-4",
            demand: Demand::Same,
            change: |scene| scene.content.sets.iter_mut().flatten().for_each(|grain| grain.charge *= 1.0001),
        },
    ];
    let seen = what_matters(&base(MIXED, half_a_sheet(Condition::Potential(0.0))), &lines);
    for Line { name, .. } in &lines {
        assert!(seen.iter().any(|text| text.starts_with(name)), "{name}: {}", seen.join("\n"));
    }
}
