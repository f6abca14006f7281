//! The command line.

use amberfield_core::Method;
use amberfield_scene::Units;
use clap::{ArgAction, Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// Simulates charged grains: their motion, the charge that they trade where they touch,
/// and the electric field that they feel. You choose the error of the field; the program measures it.
#[derive(Debug, Parser)]
#[command(name = "amberfield", version, propagate_version = true, verbatim_doc_comment)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) common: Common,
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// Options of every command.
#[derive(Debug, Args)]
pub(crate) struct Common {
    /// Number of threads [default: all cores]
    #[arg(long, global = true, value_parser = threads)]
    pub(crate) threads: Option<usize>,
    /// Writes more to the log (-vv: much more)
    #[arg(short, long, global = true, action = ArgAction::Count, conflicts_with = "quiet")]
    pub(crate) verbose: u8,
    /// Writes to the log only what went wrong
    #[arg(short, long, global = true)]
    pub(crate) quiet: bool,
    /// Form of the log on stderr
    #[arg(long, global = true, value_enum, default_value_t = LogFormat::Text)]
    pub(crate) log_format: LogFormat,
    /// Shows no progress bar and no progress lines
    #[arg(long, global = true)]
    pub(crate) no_progress: bool,
}

/// Form of the log on stderr.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum LogFormat {
    /// Plain lines
    Text,
    /// One JSON object per line
    Json,
}

/// Command of the program.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Simulates a scene and writes ParaView files, history, checkpoints and a picture
    Run(RunOptions),
    /// Computes the electric field at the particles of one snapshot, without motion
    Field(FieldOptions),
    /// Explains what a scene will run and what it leaves out, with expected error, memory and limits of the
    /// step
    Explain(ExplainOptions),
    /// Compares candidates for the field's parameters by their measured error and time, and chooses
    Tune(TuneOptions),
    /// Measures error against run time: sweeps methods and parameters over problems
    #[cfg(feature = "plots")]
    Study(StudyOptions),
    /// Writes a small scene with comments to start from, or lists such scenes
    New(NewOptions),
    /// Writes the grains of a file, a checkpoint or a run in another form
    Convert(ConvertOptions),
    /// Shows the keys of a scene (values, units, defaults, examples) and the columns of files
    Keys(KeysOptions),
    /// Tells what this machine offers and which stale runs it holds
    Doctor(DoctorOptions),
}

/// Options of `run`.
#[derive(Debug, Args)]
pub(crate) struct RunOptions {
    /// Scene file
    pub(crate) scene: PathBuf,
    /// Folder of the results [default: named after the scene]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Stops after this many steps, counted from the start of this call
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) steps: Option<u64>,
    /// Continues from a checkpoint; the results are the same bit for bit as without a stop
    #[arg(long, value_name = "CHECKPOINT", conflicts_with = "overwrite")]
    pub(crate) resume: Option<PathBuf>,
    /// Continues though the OpenFOAM case has changed since the checkpoint, and logs what has
    #[arg(long, requires = "resume")]
    pub(crate) accept_changed_case: bool,
    /// Replaces the results in an existing run folder
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Overrides a key of the scene, for example electric_field.tolerance=1e-3
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
}

/// Options of `field`.
#[derive(Debug, Args)]
pub(crate) struct FieldOptions {
    /// Scene file
    pub(crate) scene: PathBuf,
    /// Method of the field, instead of the scene's: p3m, direct, kolehmainen or cutoff
    #[arg(long, value_name = "M")]
    pub(crate) method: Option<Method>,
    /// Tolerance of the field, instead of the scene's: relative RMS error of E
    #[arg(long, value_name = "T")]
    pub(crate) tolerance: Option<f64>,
    /// File of the result [default: named after the scene]
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) out: Option<PathBuf>,
    /// Writes the parts of the field too: near, middle, far, correction, faces, external
    #[arg(long)]
    pub(crate) components: bool,
    /// Number of evaluations of which the time is measured
    #[arg(long, value_name = "N", default_value_t = 1)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) repeat: u32,
    /// Overrides a key of the scene, for example electric_field.tolerance=1e-3
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
}

/// Options of `new`.
#[derive(Debug, Args)]
pub(crate) struct NewOptions {
    /// Scene: bed, separator, chute or fluidised-bed [default: lists them]
    pub(crate) name: Option<String>,
    /// Folder of the scene [default: named after the scene]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

/// Options of `convert`.
#[derive(Debug, Args)]
pub(crate) struct ConvertOptions {
    /// Table, dump of LAMMPS or LIGGGHTS, VTK file, checkpoint, or run folder
    pub(crate) from: PathBuf,
    /// File to write; its ending is its form: .csv, .vtu, .lammpstrj or .dump, .data
    pub(crate) to: PathBuf,
    /// Step of the frame, in a file or run with several [default: the last]
    #[arg(long, value_name = "N")]
    pub(crate) step: Option<u64>,
    /// Unit style of a dump or data file that is written: si, cgs, micro, nano, real, metal or electron
    /// [default: si]
    #[arg(long, value_name = "STYLE", value_parser = Units::named)]
    pub(crate) units: Option<Units>,
    /// Unit style of a dump or VTK file that is read and does not name its own
    #[arg(long, value_name = "STYLE", value_parser = Units::named)]
    pub(crate) from_units: Option<Units>,
    /// Names of the materials of types 1, 2, …, separated by commas
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) materials_by_type: Vec<String>,
}

/// Options of `keys`.
#[derive(Debug, Args)]
pub(crate) struct KeysOptions {
    /// Key or section, for example domain.boundary.x, or file, for example history.csv [default: all keys]
    pub(crate) path: Option<String>,
}

/// Options of `explain`.
#[derive(Debug, Args)]
pub(crate) struct ExplainOptions {
    /// Scene file
    pub(crate) scene: PathBuf,
    /// Overrides a key of the scene, for example electric_field.tolerance=1e-3
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
}

/// Options of `tune`.
#[derive(Debug, Args)]
pub(crate) struct TuneOptions {
    /// Scene file
    pub(crate) scene: PathBuf,
    /// Tolerance of the field, instead of the scene's: relative RMS error of E
    #[arg(long, value_name = "T")]
    pub(crate) tolerance: Option<f64>,
    /// File of the table of candidates [default: named after the scene]
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) out: Option<PathBuf>,
    /// Overrides a key of the scene, for example electric_field.tolerance=1e-3
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
}

/// Options of `study`.
#[cfg(feature = "plots")]
#[derive(Debug, Args)]
pub(crate) struct StudyOptions {
    /// Study file
    pub(crate) study: PathBuf,
    /// Folder of the results [default: named after the study]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Measures nothing; writes the page anew from the newest rows in the folder
    #[arg(long)]
    pub(crate) page: bool,
}

/// Options of `doctor`.
#[derive(Debug, Args)]
pub(crate) struct DoctorOptions {
    /// Removes what stale runs below the current folder left behind
    #[arg(long)]
    pub(crate) clean: bool,
}

fn threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(threads @ 1..=65_536) => Ok(threads),
        _ => Err("give a whole number from 1 to 65536".to_owned()),
    }
}
