//! Files of `amberfield field` and `amberfield tune`.

use super::{Column, FileTable, Form, When};

pub(super) static FILES: &[&FileTable] = &[&FIELD, &FIELD_REPORT, &TUNE];

/// Parts of E, as their columns begin.
const NEAR: &[&str] = &["near_ex_V_per_m", "near_ey_V_per_m", "near_ez_V_per_m"];
const MIDDLE: &[&str] = &["middle_ex_V_per_m", "middle_ey_V_per_m", "middle_ez_V_per_m"];
const FAR: &[&str] = &["far_ex_V_per_m", "far_ey_V_per_m", "far_ez_V_per_m"];
const CORRECTION: &[&str] = &["correction_ex_V_per_m", "correction_ey_V_per_m", "correction_ez_V_per_m"];
const FACES: &[&str] = &["faces_ex_V_per_m", "faces_ey_V_per_m", "faces_ez_V_per_m"];
const EXTERNAL: &[&str] = &["external_ex_V_per_m", "external_ey_V_per_m", "external_ez_V_per_m"];

/// Field at the grains of a snapshot.
pub static FIELD: FileTable = FileTable::csv(
    "NAME-field.csv",
    "Field at every particle, in the order of the scene's particles; `--out` gives another name.",
    &[
        Column::new(&["id"], "", "Number of the particle."),
        Column::new(
            &["ex_V_per_m", "ey_V_per_m", "ez_V_per_m"],
            "V/m",
            "Field E that the particle feels; 0 outside the group.",
        ),
        Column::new(&["potential_V"], "V", "Potential without the particle's own singular term."),
        Column::new(NEAR, "V/m", "Part of pairs within the cut-off radius, images included.")
            .when(When::Components),
        Column::new(MIDDLE, "V/m", "Part of the internal grid beside a field solver's mesh.")
            .when(When::Components),
        Column::new(FAR, "V/m", "Smooth part of all charges.").when(When::Components),
        Column::new(
            CORRECTION,
            "V/m",
            "Correction of what near and far count twice; `kolehmainen` alone has it.",
        )
        .when(When::Components),
        Column::new(FACES, "V/m", "Part of potentials and normal fields that are given on faces.")
            .when(When::Components),
        Column::new(EXTERNAL, "V/m", "Uniform field that the scene gives.").when(When::Components),
    ],
);

/// Report beside a field.
pub static FIELD_REPORT: FileTable = FileTable::csv(
    "NAME-field.json",
    "What was computed, how exactly and how fast; named as the CSV file beside it.",
    &[
        Column::new(&["method"], "", "Method of the field."),
        Column::new(
            &["parameters"],
            "",
            "Parameters that were chosen, as in `tuning.json`; `built` names their kind.",
        ),
        Column::new(
            &["seconds.STAGE.min"],
            "s",
            "Shortest time of a stage, and of `total`, in all repetitions.",
        ),
        Column::new(&["seconds.STAGE.median"], "s", "Median time of it."),
        Column::new(&["pairs_per_particle"], "", "Mean number of partners within the cut-off radius."),
        Column::new(&["grid_cells"], "", "Cells of the internal grid along x, y and z; null without a grid."),
        Column::new(
            &["error_estimated"],
            "",
            "Relative RMS error by the error model; null for methods that promise none.",
        ),
        Column::new(
            &["error_measured"],
            "",
            "Relative RMS error measured on a sample; null when not measured.",
        ),
        Column::new(&["threads"], "", "Number of threads."),
        Column::new(&["version"], "", "Version of the program."),
    ],
)
.form(Form::Json);

/// Candidates of `amberfield tune`.
pub static TUNE: FileTable = FileTable::csv(
    "NAME-tune.csv",
    "Candidates for the field's parameters, a row for each, the choice last; `--out` gives another name.",
    &[
        Column::new(&["chosen"], "", "`true` in the last row, which is the choice."),
        Column::new(&["levels"], "", "`near and grid`, or `all pairs`."),
        Column::new(&["order"], "", "Order of the window: nodes that a charge is spread over along an axis."),
        Column::new(&["cutoff_m"], "m", "Cut-off radius of the near level."),
        Column::new(&["spacing_m"], "m", "Spacing of the grid's nodes."),
        Column::new(&["cloud_shape"], "", "Shape β of the clouds."),
        Column::new(&["window_shape"], "", "Shape β of the window."),
        Column::new(&["error_estimated"], "", "Relative RMS error by the error model."),
        Column::new(
            &["error_measured"],
            "",
            "Relative RMS error measured on a sample; empty when not measured.",
        ),
        Column::new(&["seconds"], "s", "Time of an evaluation."),
    ],
);
