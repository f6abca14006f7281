//! Command `amberfield run`.

use crate::arguments::{Common, RunOptions};
use crate::failure::Failure;
use crate::logging::Log;
use crate::run::{RunRequest, simulate};
use crate::terminal::Terminal;
use crate::{interrupt, print};
use amberfield_scene::SceneInput;

/// Runs a simulation and prints what was done.
pub(crate) fn run(options: &RunOptions, common: &Common, log: &Log) -> Result<(), Failure> {
    let request = RunRequest {
        scene: SceneInput::File(options.scene.clone()),
        out: options.out.clone(),
        steps: options.steps,
        resume: options.resume.clone(),
        accept_changed_case: options.accept_changed_case,
        overwrite: options.overwrite,
        set: options.set.clone(),
    };
    interrupt::watch()?;
    let outcome = {
        let mut terminal = Terminal::new(common);
        simulate(&request, &mut terminal, log)?
    };
    for line in &outcome.lines {
        print::line(format_args!("{line}"));
    }
    outcome.verdict
}
