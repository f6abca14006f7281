//! Command of a command line.

use crate::arguments::{Arguments, Command};
use crate::failure::{EXIT_BUG, Failure};
use crate::{commands, logging, print};
use clap::Parser as _;
use std::ffi::OsString;

/// Exit code of the command `amberfield` with these arguments, of which the first is its name. Once in a
/// process: it starts the log and the threads.
pub fn command(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    install_panic_hook();
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => error.exit(),
    };
    let log = logging::start(&arguments.common);
    match start_threads(&arguments).and_then(|()| dispatch(&arguments, &log)) {
        Ok(()) => 0,
        Err(failure) => {
            failure.report();
            failure.code()
        }
    }
}

/// Calls the function of the command.
fn dispatch(arguments: &Arguments, log: &logging::Log) -> Result<(), Failure> {
    let common = &arguments.common;
    match &arguments.command {
        Command::Run(options) => commands::run(options, common, log),
        Command::Field(options) => commands::field(options),
        Command::Explain(options) => commands::explain(options),
        Command::Tune(options) => commands::tune(options),
        #[cfg(feature = "plots")]
        Command::Study(options) => commands::study(options),
        Command::New(options) => commands::new(options),
        Command::Convert(options) => commands::convert(options),
        Command::Keys(options) => commands::keys(options),
        Command::Doctor(options) => commands::doctor(options),
    }
}

/// Installs a hook that turns a panic in any thread into the message and the exit code of a bug.
fn install_panic_hook() {
    let default = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        default(info);
        print::error(format_args!(
            "this is a bug in amberfield {}; please report it with the message above and the scene",
            env!("CARGO_PKG_VERSION")
        ));
        std::process::exit(i32::from(EXIT_BUG));
    }));
}

/// Starts the threads of the computation.
fn start_threads(arguments: &Arguments) -> Result<(), Failure> {
    let threads = arguments.common.threads.unwrap_or(0);
    // This thread is one of them: to give each loop to other threads and wait would cost a wake-up each time.
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .use_current_thread()
        .build_global()
        .map_err(|error| Failure::bad_input(format!("--threads {threads}: {error}; give fewer threads")))
}
