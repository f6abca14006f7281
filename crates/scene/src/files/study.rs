//! Files of `amberfield study`.

use super::{Column, FileTable};

pub(super) static FILES: &[&FileTable] = &[&PAGE, &PICTURES, &POINTS, &MOTIONS, &EXTREMES, &ENERGIES];

/// Columns with which most rows begin.
const DATE: Column = Column::new(&["date"], "", "Day of the measurement, in UTC.");
const VERSION: Column = Column::new(&["version"], "", "Version of the program.");
const PROCESSOR: Column = Column::new(&["processor"], "", "Name of the processor.");
const THREADS: Column = Column::new(&["threads"], "", "Number of threads.");
const VALUE: Column = Column::new(&["value"], "", "Value of the swept key; empty without a sweep.");
const COMMAND: Column = Column::new(&["command"], "", "Command that repeats the row.");
const FAILURE: Column = Column::new(&["failure"], "", "Reason why it failed; empty if it did not.");

static PAGE: FileTable = FileTable::plain("NAME.md", "Page with tables and pictures, named as the study.");

static PICTURES: FileTable =
    FileTable::plain("pictures/NAME", "Curves of the page, each as `.svg` and `.png`.");

/// Points of a study: a method on a problem.
pub static POINTS: FileTable = FileTable::csv(
    "data/DATE-NAME.csv",
    "Error and time of each method with each of its parameters on each problem.",
    &[
        DATE,
        VERSION,
        PROCESSOR,
        THREADS,
        Column::new(&["problem"], "", "Name of the problem."),
        Column::new(&["grains"], "", "Number of grains."),
        Column::new(&["truth"], "", "Source of the exact field."),
        Column::new(&["method"], "", "Name of the method."),
        VALUE,
        Column::new(&["parameters"], "", "Parameters in force."),
        Column::new(
            &["error"],
            "",
            "RMS of |ΔE| over the scale; empty, as all numbers below, where it failed.",
        ),
        Column::new(&["p99", "worst"], "", "99th percentile and largest of |ΔE| over the scale."),
        Column::new(&["bias"], "", "Mean of ΔE·E over that of E²: what does not average out."),
        Column::new(&["estimated"], "", "Error that the error model expected."),
        Column::new(&["promised"], "", "Tolerance that the method promises to keep."),
        Column::new(&["allowed"], "", "Error that the study allows."),
        Column::new(
            &["seconds", "seconds_least", "seconds_most"],
            "s",
            "Time of an evaluation: median of all, and medians of the fastest and slowest turn.",
        ),
        Column::new(&["stages"], "s", "Time per stage, as `near=1.2e-3 grid=3.4e-4`."),
        Column::new(&["memory_bytes"], "bytes", "Memory held."),
        Column::new(&["pairs_per_grain"], "", "Mean number of partners within the cut-off radius."),
        COMMAND,
        FAILURE,
    ],
)
.when("`[[problems]]`");

/// Whole runs of a study.
pub static MOTIONS: FileTable = FileTable::csv(
    "data/DATE-NAME-motions.csv",
    "Error and time of whole runs.",
    &[
        DATE,
        VERSION,
        PROCESSOR,
        THREADS,
        Column::new(&["problem"], "", "Name of the scene that moves."),
        Column::new(&["method"], "", "Name of the settings."),
        VALUE,
        Column::new(&["seconds"], "s", "Wall-clock time of the run."),
        Column::new(&["steps"], "", "Number of steps."),
        Column::new(&["evaluations"], "", "Number of evaluations of the field."),
        Column::new(
            &["horizon_s"],
            "s",
            "Time up to which trajectories count: a small change has grown tenfold by then.",
        ),
        Column::new(
            &["position_error"],
            "",
            "RMS deviation from the reference at that time, over the RMS way since the start.",
        ),
        Column::new(
            &["charge_error"],
            "",
            "RMS deviation of the charges at that time, over the RMS of what has moved.",
        ),
        Column::new(
            &["height", "kinetic", "contacts"],
            "",
            "Mean height, kinetic energy and contacts per grain at the end, as standard \
             deviations of the replicas away from their mean.",
        ),
        COMMAND,
        FAILURE,
    ],
)
.when("`[[motions]]`");

/// Scenes at their ends.
pub static EXTREMES: FileTable = FileTable::csv(
    "data/DATE-NAME-extremes.csv",
    "What became of scenes with one thing pushed to its end.",
    &[
        DATE,
        VERSION,
        PROCESSOR,
        THREADS,
        Column::new(&["extreme"], "", "Name of what is pushed to its end."),
        VALUE,
        Column::new(&["ended"], "", "`well`, `refused`, `unsound`, or another exit code."),
        Column::new(&["said"], "", "Last message of the command, if it did not end well."),
        Column::new(&["seconds"], "s", "Wall-clock time."),
        Column::new(
            &["gain", "loss"],
            "",
            "Largest rise and fall of the energy, over the largest that was turned over.",
        ),
        Column::new(
            &["charge_drift"],
            "",
            "Largest change of the charge of grains and walls over the sizes of all charges.",
        ),
        Column::new(&["kinetic_j"], "J", "Kinetic energy per grain at the end."),
        Column::new(&["limited"], "", "Number of grains whose force was limited."),
        Column::new(&["error"], "", "Relative RMS error of E against the direct sum."),
        Column::new(&["broken"], "", "Expectations that were not met; empty if all were."),
        COMMAND,
    ],
)
.when("`[[extremes]]`");

/// Energies of such scenes over time.
pub static ENERGIES: FileTable = FileTable::csv(
    "data/DATE-NAME-energies.csv",
    "Energies of these scenes over time.",
    &[
        Column::new(&["extreme"], "", "Name of what is pushed to its end."),
        VALUE,
        Column::new(&["time_s"], "s", "Time."),
        Column::new(
            &["change"],
            "",
            "Change of the energy since the start, over the largest that was turned over.",
        ),
    ],
)
.when("`[[extremes]]`");
