//! Licences, sources and duplicates of everything that is linked, by cargo-deny.

use crate::shell::{cargo, run as execute, works};
use anyhow::Result;
use std::path::Path;

/// Runs cargo-deny with the repository's `deny.toml`; installs it first where it is missing.
pub(crate) fn run(root: &Path) -> Result<()> {
    if !works(&mut cargo(root, &["deny", "--version"])) {
        println!("cargo-deny is missing: installing it (a few minutes, once)");
        // Unoptimised: it compiles twice as fast and has little to do.
        execute(&mut cargo(root, &["install", "--locked", "--debug", "cargo-deny"]))?;
    }
    execute(&mut cargo(root, &["deny", "check", "bans", "licenses", "sources"]))?;
    if works(&mut cargo(root, &["deny", "fetch", "db"])) {
        execute(&mut cargo(root, &["deny", "check", "advisories"]))
    } else {
        println!(
            "the advisory database cannot be reached from here: known vulnerabilities were not looked up"
        );
        Ok(())
    }
}
