//! The command line.

use amberfield_core::Method;
use clap::{ArgAction, Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// Electric field and motion of charged grains.
#[derive(Debug, Parser)]
#[command(name = "amberfield", version, about, propagate_version = true)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) common: Common,
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// Options of every command.
#[derive(Debug, Args)]
pub(crate) struct Common {
    /// Number of threads (default: all cores)
    #[arg(long, global = true, value_parser = threads)]
    pub(crate) threads: Option<usize>,
    /// Say more (-vv: much more)
    #[arg(short, long, global = true, action = ArgAction::Count, conflicts_with = "quiet")]
    pub(crate) verbose: u8,
    /// Say only what went wrong
    #[arg(short, long, global = true)]
    pub(crate) quiet: bool,
    /// Form of the log on stderr
    #[arg(long, global = true, value_enum, default_value_t = LogFormat::Text)]
    pub(crate) log_format: LogFormat,
    /// No progress bar and no progress lines
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

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Simulate
    Run(RunOptions),
    /// The electric field at the particles of one snapshot, no motion
    Field(FieldOptions),
    /// What will run, what is left out and why, error expected, memory, limits on the time step
    Explain(ExplainOptions),
    /// Candidates for the field's parameters, their measured error and time, the choice
    Tune(TuneOptions),
    /// Error against run time: methods and parameters swept over problems
    #[cfg(feature = "plots")]
    Study(StudyOptions),
    /// What this machine offers, stale runs
    Doctor(DoctorOptions),
}

/// Options of `run`.
#[derive(Debug, Args)]
pub(crate) struct RunOptions {
    /// Scene file
    pub(crate) scene: PathBuf,
    /// Run folder (default: named after the scene)
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Stop after so many steps of this call
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) steps: Option<u64>,
    /// Go on from a checkpoint, bit for bit
    #[arg(long, value_name = "CHECKPOINT", conflicts_with = "overwrite")]
    pub(crate) resume: Option<PathBuf>,
    /// Replace the results in an existing run folder
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Override a key of the scene
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
}

/// Options of `field`.
#[derive(Debug, Args)]
pub(crate) struct FieldOptions {
    /// Scene file
    pub(crate) scene: PathBuf,
    /// Method instead of the scene's
    #[arg(long, value_name = "M")]
    pub(crate) method: Option<Method>,
    /// Tolerance instead of the scene's
    #[arg(long, value_name = "T")]
    pub(crate) tolerance: Option<f64>,
    /// Result (default: named after the scene)
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) out: Option<PathBuf>,
    /// Also the parts of the field by level
    #[arg(long)]
    pub(crate) components: bool,
    /// Repetitions for the time measured
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) repeat: u32,
    /// Override a key of the scene
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
}

/// Options of `explain`.
#[derive(Debug, Args)]
pub(crate) struct ExplainOptions {
    /// Scene file
    pub(crate) scene: PathBuf,
    /// Override a key of the scene
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
}

/// Options of `tune`.
#[derive(Debug, Args)]
pub(crate) struct TuneOptions {
    /// Scene file
    pub(crate) scene: PathBuf,
    /// Tolerance instead of the scene's
    #[arg(long, value_name = "T")]
    pub(crate) tolerance: Option<f64>,
    /// Table of the candidates (default: named after the scene)
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) out: Option<PathBuf>,
    /// Override a key of the scene
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
}

/// Options of `study`.
#[cfg(feature = "plots")]
#[derive(Debug, Args)]
pub(crate) struct StudyOptions {
    /// Study file
    pub(crate) study: PathBuf,
    /// Folder of the results (default: named after the study)
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Measure nothing: write the page anew from the newest rows in the folder
    #[arg(long)]
    pub(crate) page: bool,
}

/// Options of `doctor`.
#[derive(Debug, Args)]
pub(crate) struct DoctorOptions {
    /// Remove what stale runs below the current folder left behind
    #[arg(long)]
    pub(crate) clean: bool,
}

fn threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(threads @ 1..=65_536) => Ok(threads),
        _ => Err("give a whole number from 1 to 65536".to_owned()),
    }
}
