//! Keys of `[solver]`.

use super::{Form, Key};
use crate::limits::TIME;

pub(super) static KEYS: &[Key] = &[
    Key::new("openfoam_case", Form::Text, "Folder of the case, with 0/, constant/ and system/.")
        .required()
        .example("\"foam\"")
        .also(&["case", "folder", "path", "openfoam", "directory"]),
    Key::new("application", Form::Text, "Program that is started.")
        .without("electricFieldFoam, or amberPimpleFoam with a gas that flows")
        .example("\"electricFieldFoam\"")
        .also(&["program", "executable", "solver"]),
    Key::new(
        "start",
        Form::Boolean,
        "Whether the run starts the program, or waits for one that is started by hand.",
    )
    .default("true")
    .example("false"),
    Key::new("ranks", Form::Whole(1, 65_536), "Processes of the program, by MPI.")
        .default("1")
        .example("2")
        .also(&["processes", "np", "cores", "numberOfSubdomains", "processors", "n"]),
    Key::new("hosts", Form::Text, "File with the machines of the ranks, as mpirun's --hostfile takes it.")
        .without("this machine")
        .example("\"hosts.txt\"")
        .also(&["hostfile", "machinefile", "machines", "nodes"]),
    Key::new("timeout_s", Form::Number(TIME), "Silence of the program after which it counts as lost.")
        .unit("s")
        .default("30.0")
        .example("120.0")
        .also(&["timeout"]),
    Key::new("wait_s", Form::Number(TIME), "Time for which a program that is started by hand is waited for.")
        .unit("s")
        .without("for ever")
        .example("600.0"),
    Key::new(
        "on_solver_loss",
        Form::Word(&["stop", "fallback", "wait"]),
        "Effect of a lost program: the run ends, goes on with the internal grid, or waits for another.",
    )
    .default("\"stop\"")
    .example("\"wait\""),
];
