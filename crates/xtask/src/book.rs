//! The docs as a book: made by MkDocs, and read by a test in a headless browser.

use crate::debian;
use crate::shell::run as execute;
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Packages that are installed from Debian where they are missing.
const PACKAGES: [&str; 2] = ["chromium", "python3-venv"];
/// Browser that reads the book.
const BROWSER: &str = "/usr/bin/chromium";
/// Folder of the book's own programs.
const SOURCE: &str = "crates/xtask/book";

/// Builds the book into `target/book` and tests it.
pub(crate) fn run(root: &Path) -> Result<()> {
    let programs = environment(root)?;
    let mut build = Command::new(programs.join("mkdocs"));
    // The variable silences advertisements that have no line of their own.
    build.env("NO_MKDOCS_2_WARNING", "1").args(["build", "--strict", "--quiet"]);
    execute(build.current_dir(root))?;
    debian::provide(&PACKAGES[..1])?;
    let mut check = Command::new(programs.join("python"));
    check.arg(root.join(SOURCE).join("check.py")).args(["target/book", BROWSER]);
    execute(check.args(["--pictures", "target/book-pictures"]).current_dir(root))?;
    println!("the book is target/book/index.html; pictures of some pages are in target/book-pictures");
    Ok(())
}

/// Folder of the programs of a Python environment with the book's packages, made anew where its list changes.
fn environment(root: &Path) -> Result<PathBuf> {
    let list = root.join(SOURCE).join("requirements.txt");
    let folder = root.join("target/book-environment");
    let programs = folder.join("bin");
    let installed = folder.join("installed.txt");
    let asked = std::fs::read_to_string(&list).with_context(|| format!("cannot read {}", list.display()))?;
    if std::fs::read_to_string(&installed).is_ok_and(|text| text == asked) {
        return Ok(programs);
    }
    println!("installing the packages of {SOURCE}/requirements.txt into target/book-environment");
    debian::provide(&PACKAGES[1..])?;
    execute(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&folder))?;
    let mut install = Command::new(programs.join("pip"));
    install.args(["install", "--quiet", "--disable-pip-version-check", "--no-deps", "--requirement"]);
    execute(install.arg(&list)).context("cannot install the book's packages; is there a network?")?;
    std::fs::write(installed, asked)?;
    Ok(programs)
}
