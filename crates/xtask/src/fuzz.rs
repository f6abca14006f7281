//! The fuzzer over everything that is read: cargo-fuzz with the targets of `tests/fuzz`.

use crate::shell::{cargo, run as execute, works};
use anyhow::{Context as _, Result};
use std::path::Path;

/// Names of the targets to which bytes are sent.
const TARGETS: [&str; 8] = ["scene", "grains", "surface", "checkpoint", "message", "mesh", "dump", "vtk"];
/// Longest input [bytes].
const LONGEST: usize = 4096;
/// Time of a target unless told [s].
const SECONDS: u32 = 600;

/// Runs targets for some time each; installs cargo-fuzz first where it is missing.
///
/// Inputs that are found new stay out of the committed corpora.
pub(crate) fn run(root: &Path, words: &[&str]) -> Result<()> {
    let (seconds, named) = match words {
        ["--seconds", seconds, named @ ..] => (seconds.parse().context("--seconds takes a number")?, named),
        named => (SECONDS, named),
    };
    if !works(&mut cargo(root, &["fuzz", "--version"])) {
        println!("cargo-fuzz is missing: installing it (a few minutes, once)");
        execute(&mut cargo(root, &["install", "--locked", "--debug", "cargo-fuzz"]))?;
    }
    let targets: Vec<&str> = if named.is_empty() { TARGETS.to_vec() } else { named.to_vec() };
    let target_dir = root.join("target/fuzz");
    for target in targets {
        let found = target_dir.join("corpus").join(target);
        std::fs::create_dir_all(&found)?;
        let corpora = [found, root.join("tests/fuzz/corpus").join(target)];
        let mut fuzz = cargo(root, &["fuzz", "run", "--fuzz-dir", "tests/fuzz", target]);
        fuzz.arg("--target-dir").arg(&target_dir).args(corpora).arg("--");
        fuzz.arg(format!("-max_total_time={seconds}")).arg(format!("-max_len={LONGEST}"));
        fuzz.args(["-timeout=20", "-print_final_stats=1"]);
        // The address sanitizer is asked for by a flag that stable compilers know, and hide.
        execute(fuzz.env("RUSTC_BOOTSTRAP", "1"))?;
    }
    Ok(())
}
