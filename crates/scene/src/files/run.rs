//! Files of `amberfield run`.

use super::history::HISTORY;
use super::{Column, FileTable, Form, When};

pub(super) static FILES: &[&FileTable] = &[
    &HISTORY,
    &WALL_FORCES,
    &EXITS,
    &OUTLETS_GRAINS,
    &CHARGE_HISTOGRAM,
    &CHARGE_PLOTS,
    &GRAINS_VTU,
    &GRAINS_CSV,
    &GRAINS_PNG,
    &GRAINS_SERIES,
    &WALL_CHARGE,
    &WALL_SURFACES,
    &WALL_SERIES,
    &PICTURE,
    &CHECKPOINT,
    &SUMMARY,
    &TUNING,
    &LOG,
    &SCENE,
    &LOCK,
];

/// Step and time, with which rows of several tables begin.
pub(super) const STEP: Column = Column::new(&["step"], "", "Number of the step; 0 is the start.");
pub(super) const TIME: Column = Column::new(&["time_s"], "s", "Time of the step.");

/// Name of the array of electric forces.
pub const ELECTRIC_FORCE: &str = "electric_force_N";

/// Forces of the grains on each wall.
pub static WALL_FORCES: FileTable = FileTable::csv(
    "wall_forces.csv",
    "Forces of the grains on each wall, a row for each wall with each row of the history.",
    &[
        STEP,
        TIME,
        Column::new(&["wall"], "", "Number of the wall in the order of `[[walls]]`, counted from 0."),
        Column::new(
            &["normal_x_N", "normal_y_N", "normal_z_N"],
            "N",
            "Force of the grains on the wall along the normals of the contacts, damping included.",
        ),
        Column::new(
            &["tangential_x_N", "tangential_y_N", "tangential_z_N"],
            "N",
            "Force of the grains on the wall across them: friction, and its damping.",
        ),
        Column::new(
            &["torque_x_N_m", "torque_y_N_m", "torque_z_N_m"],
            "N m",
            "Torque about the origin, rolling friction included.",
        ),
    ],
)
.when("walls");

/// Grains that left the box.
pub static EXITS: FileTable = FileTable::csv(
    "exits.csv",
    "Grains that left the box, a row for each.",
    &[
        STEP,
        TIME,
        Column::new(&["id"], "", "Number of the grain."),
        Column::new(&["face"], "", "Face through which it left: `x_min`, `x_max` and so on."),
        Column::new(&["x_m", "y_m", "z_m"], "m", "Place of its centre."),
        Column::new(&["vx_m_s", "vy_m_s", "vz_m_s"], "m/s", "Velocity in the middle of the step."),
        Column::new(&["radius_m"], "m", "Radius."),
        Column::new(&["charge_C"], "C", "Charge that it takes away."),
    ],
)
.when("`particles.on_exit = \"delete\"`");

/// Grains that left through outlets.
pub static OUTLETS_GRAINS: FileTable = FileTable::csv(
    "outlets_grains.csv",
    "Grains that left through an outlet with `each`, a row for each.",
    &[
        STEP,
        TIME,
        Column::new(&["outlet"], "", "Name of the outlet."),
        Column::new(&["id"], "", "Number of the grain."),
        Column::new(&["material"], "", "Name of its material."),
        Column::new(&["x_m", "y_m", "z_m"], "m", "Place of its centre."),
        Column::new(&["vx_m_s", "vy_m_s", "vz_m_s"], "m/s", "Velocity in the middle of the step."),
        Column::new(&["radius_m"], "m", "Radius."),
        Column::new(&["mass_kg"], "kg", "Mass."),
        Column::new(&["charge_C"], "C", "Charge that it takes away."),
    ],
)
.when("an outlet with `each = true`");

/// Distribution of charge over the grains.
pub static CHARGE_HISTOGRAM: FileTable = FileTable::csv(
    "charge_histogram.csv",
    "Distribution of charge over the grains: 40 rows, one for each bin, with each file of all grains.",
    &[
        STEP,
        TIME,
        Column::new(&["charge_from_C", "charge_to_C"], "C", "Edges of the bin of charges."),
        Column::new(&["grains_by_charge"], "", "Number of grains with such a charge."),
        Column::new(
            &["charge_to_mass_from_C_kg", "charge_to_mass_to_C_kg"],
            "C/kg",
            "Edges of the bin of charges over masses.",
        ),
        Column::new(&["grains_by_charge_to_mass"], "", "Number of grains with such a ratio."),
    ],
)
.when("charging by contact");

static CHARGE_PLOTS: FileTable = FileTable::plain(
    "NAME_histogram.svg",
    "`charge_histogram.svg` and `charge_to_mass_histogram.svg`: curves of that table at five times.",
)
.when("charging by contact, and charges that differ");

/// Grains for ParaView.
pub static GRAINS_VTU: FileTable = FileTable::csv(
    "particles/grains_STEP.vtu",
    "Grains for ParaView, as points; Glyph with a sphere of radius `radius_m` shows them.",
    &[
        Column::new(&["id"], "", "Number of the grain."),
        Column::new(&["radius_m"], "m", "Radius."),
        Column::new(&["density_kg_m3"], "kg/m³", "Density."),
        Column::new(&["charge_C"], "C", "Charge."),
        Column::new(&["velocity_m_s"], "m/s", "Velocity."),
        Column::new(&["angular_velocity_rad_s"], "rad/s", "Angular velocity."),
        Column::new(
            &["material"],
            "",
            "Number of the material in the order of `[[materials]]`, counted from 0.",
        ),
        Column::new(
            &["group"],
            "",
            "Number of the group in the order in which the scene's particles name them; 0 is `all`.",
        ),
        Column::new(&[ELECTRIC_FORCE], "N", "Electric force qE, after a limit where there is one.")
            .when(When::Field),
        Column::new(&["points_m"], "m", "Centre of the grain, as ParaView's Points."),
        Column::new(&["connectivity"], "", "Points of the cells, as VTK asks for it; a grain is a cell."),
        Column::new(&["offsets"], "", "End of each cell's points."),
        Column::new(&["types"], "", "Type of each cell: 1, a vertex."),
    ],
)
.form(Form::Vtu)
.when("`output.formats` with `\"vtk\"`, which is there unless given");

/// Grains as a table, which scenes read.
pub static GRAINS_CSV: FileTable = FileTable::csv(
    "particles/grains_STEP.csv",
    "Grains as a table, a row for each. A scene reads it: `particles.file`.",
    &[
        Column::new(&["id"], "", "Number of the grain."),
        Column::new(&["x_m", "y_m", "z_m"], "m", "Place of its centre."),
        Column::new(&["radius_m"], "m", "Radius."),
        Column::new(&["charge_C"], "C", "Charge."),
        Column::new(&["vx_m_s", "vy_m_s", "vz_m_s"], "m/s", "Velocity."),
        Column::new(&["wx_rad_s", "wy_rad_s", "wz_rad_s"], "rad/s", "Angular velocity."),
        Column::new(&["density_kg_m3"], "kg/m³", "Density."),
        Column::new(&["material"], "", "Name of the material."),
        Column::new(&["group"], "", "Name of the group; `all` where there are none."),
    ],
)
.when("`output.formats` with `\"csv\"`");

static GRAINS_PNG: FileTable =
    FileTable::plain("particles/grains_STEP.png", "Picture of the grains, coloured by charge.")
        .when("`output.formats` with `\"png\"`");

static GRAINS_SERIES: FileTable =
    FileTable::plain("particles.pvd", "List of the files of grains with their times: open it in ParaView.")
        .when("`output.formats` with `\"vtk\"`");

/// Charge on walls for ParaView.
pub static WALL_CHARGE: FileTable = FileTable::csv(
    "walls/charge_STEP.vtu",
    "Charge on insulating walls for ParaView, a square around each charged place.",
    &[
        Column::new(&["wall"], "", "Number of the wall in the order of `[[walls]]`, counted from 0."),
        Column::new(&["charge_C"], "C", "Charge of the place."),
        Column::new(&["charge_density_C_m2"], "C/m²", "Charge per area there, with that of its neighbours."),
        Column::new(&["points_m"], "m", "Corners of the squares, as ParaView's Points."),
        Column::new(&["connectivity"], "", "Points of the cells, as VTK asks for it; a square is a cell."),
        Column::new(&["offsets"], "", "End of each cell's points."),
        Column::new(&["types"], "", "Type of each cell: 9, a quadrangle."),
    ],
)
.form(Form::Vtu)
.when("charging by contact, a wall with `charging`, and `\"vtk\"`");

/// Walls that move, for ParaView.
pub static WALL_SURFACES: FileTable = FileTable::csv(
    "walls/surface_STEP.vtu",
    "Walls that move, for ParaView, where they are; of a plane, what is in the box.",
    &[
        Column::new(&["wall"], "", "Number of the wall in the order of `[[walls]]`, counted from 0."),
        Column::new(&["points_m"], "m", "Corners of the faces, as ParaView's Points."),
        Column::new(&["connectivity"], "", "Points of the cells, as VTK asks for it; a face is a cell."),
        Column::new(&["offsets"], "", "End of each cell's points."),
        Column::new(&["types"], "", "Type of each cell: 7, a polygon."),
    ],
)
.form(Form::Vtu)
.when("a wall with `motion`, and `\"vtk\"`");

static WALL_SERIES: FileTable = FileTable::plain(
    "walls.pvd",
    "List of the files of walls with their times: part 0 charge, part 1 surfaces.",
)
.when("as these files");

static PICTURE: FileTable =
    FileTable::plain("picture.png", "Picture of the grains at the end.").when("a run that ends well");

static CHECKPOINT: FileTable = FileTable::plain(
    "checkpoints/step_STEP.amber",
    "All state of the run, for `--resume`: binary, with a checksum, for the same version of the program.",
);

/// End of a run in numbers.
pub static SUMMARY: FileTable = FileTable::csv(
    "summary.json",
    "End of the run in numbers.",
    &[
        Column::new(&["version"], "", "Version of the program."),
        Column::new(
            &["ending"],
            "",
            "`complete`, `steps` (as many as `--steps` asked for), `interrupted` or `failed`.",
        ),
        Column::new(&["error"], "", "Message of a run that failed, else null."),
        Column::new(&["grains"], "", "Number of grains at the end."),
        Column::new(&["step"], "", "Number of the last step."),
        Column::new(&["steps_of_the_run"], "", "Number of steps up to `time.end_s`."),
        Column::new(&["step_s"], "s", "Time step."),
        Column::new(&["time_s"], "s", "Time at the end."),
        Column::new(&["skin_m"], "m", "Distance beyond contact up to which neighbours are listed."),
        Column::new(&["wall_s"], "s", "Wall-clock time, earlier parts of the run included."),
        Column::new(&["wall_s_stages.STAGE"], "s", "Wall-clock time of each stage, as in `history.csv`."),
        Column::new(&["steps_per_s"], "1/s", "Steps per second of wall-clock time in this part of the run."),
        Column::new(&["contacts"], "", "Number of contacts at the end."),
        Column::new(
            &[
                "energies_at_start.kinetic_J",
                "energies_at_start.contact_J",
                "energies_at_start.gravity_J",
                "energies_at_start.electric_J",
            ],
            "J",
            "Energies when this part of the run began, as in `history.csv`.",
        ),
        Column::new(
            &[
                "energies_at_end.kinetic_J",
                "energies_at_end.contact_J",
                "energies_at_end.gravity_J",
                "energies_at_end.electric_J",
            ],
            "J",
            "Energies at its end; `energies_at_end` is null where it failed.",
        ),
        Column::new(&["energies_at_end"], "", "Null in a run that failed."),
        Column::new(&["books"], "", "Null where grains neither come nor go, else the keys below."),
        Column::new(
            &[
                "books.NAME.start.grains",
                "books.NAME.fed.grains",
                "books.NAME.left.grains",
                "books.NAME.inside.grains",
            ],
            "",
            "Numbers of grains of all materials (`all`) or of one (`materials.NAME`): inside is start and \
             fed less left.",
        ),
        Column::new(
            &["books.NAME.start.kg", "books.NAME.fed.kg", "books.NAME.left.kg", "books.NAME.inside.kg"],
            "kg",
            "Their masses.",
        ),
        Column::new(
            &["books.NAME.start.C", "books.NAME.fed.C", "books.NAME.left.C", "books.NAME.inside.C"],
            "C",
            "Their charges.",
        ),
        Column::new(&["books.NAME.gained_C"], "C", "Charge that they gained at contacts."),
        Column::new(
            &["books.feeds.NAME.fed.grains", "books.feeds.NAME.owed.grains"],
            "",
            "Numbers of grains that a feed brought, and that found no place.",
        ),
        Column::new(&["books.feeds.NAME.fed.kg", "books.feeds.NAME.owed.kg"], "kg", "Their masses."),
        Column::new(&["books.feeds.NAME.fed.C", "books.feeds.NAME.owed.C"], "C", "Their charges."),
        Column::new(
            &["books.outlets.NAME.grains", "books.outlets.NAME.materials.NAME.grains"],
            "",
            "Numbers of grains that left through an outlet, all and of one material.",
        ),
        Column::new(
            &["books.outlets.NAME.kg", "books.outlets.NAME.materials.NAME.kg"],
            "kg",
            "Their masses.",
        ),
        Column::new(
            &["books.outlets.NAME.C", "books.outlets.NAME.materials.NAME.C"],
            "C",
            "Charges that they took along.",
        ),
        Column::new(&["field"], "", "Null without a field, else the keys below."),
        Column::new(
            &["field.parameters"],
            "",
            "Parameters in force, as in `tuning.json`; `built` names their kind.",
        ),
        Column::new(&["field.error_estimated"], "", "Relative RMS error of E by the error model."),
        Column::new(&["field.error_measured"], "", "Relative RMS error of E measured last on a sample."),
        Column::new(&["field.memory_bytes"], "bytes", "Memory of the field."),
        Column::new(&["field_intervals"], "", "Null without a field, else the keys below."),
        Column::new(&["field_intervals.evaluations"], "", "Number of evaluations of the field."),
        Column::new(&["field_intervals.steps_now"], "", "Steps from one evaluation to the next, at the end."),
        Column::new(
            &["field_intervals.error_measured", "field_intervals.largest_error_measured"],
            "",
            "Relative error that is made between evaluations: the last one and the largest.",
        ),
        Column::new(&["limited"], "", "Null without `limit_field_force`, else the keys below."),
        Column::new(&["limited.grains_now"], "", "Grains whose electric force is limited at the end."),
        Column::new(&["limited.steps"], "", "Steps in which a force was limited."),
        Column::new(&["limited.grain_steps"], "", "Sum of the limited grains over all steps."),
        Column::new(&["limited.largest_force_N"], "N", "Largest force that was asked for."),
        Column::new(
            &["step_limits_s.LIMIT"],
            "s",
            "Limits of the time step by name; null where there is none.",
        ),
        Column::new(&["threads"], "", "Number of threads."),
        Column::new(&["cpu"], "", "Name of the processor."),
    ],
)
.form(Form::Json);

/// Parameters of the field.
pub static TUNING: FileTable = FileTable::csv(
    "tuning.json",
    "Parameters of the field that were chosen at the start, below the name of their kind (`P3m` …).",
    &[
        Column::new(&["NAME.cutoff_m"], "m", "Cut-off radius of the near level, where the clouds end."),
        Column::new(&["NAME.cloud_shape"], "", "Shape β of the clouds."),
        Column::new(&["NAME.spacing_m"], "m", "Largest spacing of the grid's nodes."),
        Column::new(
            &["NAME.order"],
            "",
            "Order of the window: nodes that a charge is spread over along an axis.",
        ),
        Column::new(&["NAME.window_shape"], "", "Shape β of the window."),
        Column::new(
            &["NAME.kernel_accuracy"],
            "",
            "Error of the near kernel over the cloud's value at its centre.",
        ),
        Column::new(&["NAME.far"], "", "Null without a field solver, else the keys below."),
        Column::new(&["NAME.far.cloud_m"], "m", "Radius of the clouds of the far level."),
        Column::new(&["NAME.far.of_ghosts"], "", "Factor of the radii up to which ghost charges are felt."),
    ],
)
.form(Form::Json)
.when("`[electric_field]` and a charge");

/// Log of a run.
pub static LOG: FileTable = FileTable::csv(
    "log.jsonl",
    "Log of the run, a JSON object in each line; more than the terminal shows.",
    &[
        Column::new(&["timestamp"], "", "Time of day in UTC."),
        Column::new(&["level"], "", "`ERROR`, `WARN`, `INFO`, `DEBUG` or `TRACE`."),
        Column::new(&["fields.message"], "", "Message."),
        Column::new(&["fields.NAME"], "", "Numbers of some messages, as `step`."),
        Column::new(&["target"], "", "Part of the program that wrote the line."),
    ],
)
.form(Form::Json);

static SCENE: FileTable =
    FileTable::plain("scene.toml", "Scene as it was run, with all overrides of the command line.");

static LOCK: FileTable =
    FileTable::plain("run.lock", "Number of the process that writes here.").when("while the run goes on");
