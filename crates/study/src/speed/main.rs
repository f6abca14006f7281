//! `cargo xtask bench`: measures speed and memory, ours and the peers', and writes the report of them.
//!
//! A section measures one thing and writes its rows to `docs/reports/data/DATE-SECTION.csv`; the page is
//! made from the newest file of every section.
#![expect(clippy::print_stdout, reason = "a program for developers that reports to the terminal")]

mod beds;
mod page;
mod sections;
mod timing;

use amberfield_study::Store;
use amberfield_study::machine::Machine;
use amberfield_study::peers::{PACKAGES, Peers};
use anyhow::Result;
use clap::{Parser, ValueEnum};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Measures speed and memory and writes docs/reports/speed.md.
#[derive(Debug, Parser)]
struct Arguments {
    /// Sections to measure [default: all]
    #[arg(value_enum)]
    sections: Vec<Section>,
    /// Small sizes: shows that everything runs, says nothing about speed
    #[arg(long)]
    quick: bool,
    /// Installs the peers into target/peers and measures them in the same run
    #[arg(long)]
    peers: bool,
    /// Goes on where a broken-off run of the section `field` stopped: keeps the rows of its newest file
    #[arg(long)]
    resume: bool,
    /// Measures nothing: writes the page of the rows that are there
    #[arg(long, conflicts_with_all = ["sections", "resume", "peers"])]
    page: bool,
    /// Folder of the report
    #[arg(long, default_value = "docs/reports")]
    out: PathBuf,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Section {
    Dem,
    Rest,
    Field,
    Open,
    Kernel,
    Scaling,
    Rates,
    Coupling,
    Charging,
    Gas,
    Lammps,
}

/// Settings that a section needs to know.
struct Context {
    quick: bool,
    resume: bool,
    peers: Option<Peers>,
    store: Store,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            println!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .expect("this crate lies two folders below the repository's root");
    if arguments.page {
        return page::write(&Store::new(root.join(&arguments.out))?);
    }
    let peers = if arguments.peers {
        println!("installing {} into target/peers", PACKAGES.join(", "));
        Some(Peers::install(root)?)
    } else {
        None
    };
    let context = Context {
        quick: arguments.quick,
        resume: arguments.resume,
        peers,
        store: Store::new(root.join(&arguments.out))?,
    };
    let all = Section::value_variants();
    let wanted = if arguments.sections.is_empty() { all } else { &arguments.sections };
    for section in wanted {
        println!("== {section:?}");
        match section {
            Section::Dem => sections::dem::measure(&context)?,
            Section::Rest => sections::rest::measure(&context)?,
            Section::Field => sections::field::measure(&context)?,
            Section::Open => sections::open::measure(&context)?,
            Section::Kernel => sections::kernel::measure(&context)?,
            Section::Scaling => sections::scaling::measure(&context)?,
            Section::Rates => sections::rates::measure(&context, root)?,
            Section::Coupling => sections::coupling::measure(&context, root)?,
            Section::Charging => sections::charging::measure(&context)?,
            Section::Gas => sections::gas::measure(&context, root)?,
            Section::Lammps => sections::lammps::measure(&context)?,
        }
    }
    // A run without peers keeps what an earlier one said of them.
    if context.peers.is_some() || context.store.newest::<Machine>("machine")?.is_none() {
        context.store.save("machine", &[Machine::read(context.peers.as_ref())])?;
    }
    page::write(&context.store)
}
