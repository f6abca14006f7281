//! The price of the field for a plain scene: instructions of a build with the field crate over those of one
//! without it.

use crate::shell::{cargo, run as execute, works};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Largest share of instructions by which the two builds may differ.
const MOST: f64 = 0.01;
const EXAMPLE: &str = "plain_bed";
/// Keeps the C library from `rep stosb` and `rep movsb`, of which callgrind counts an instruction per byte.
///
/// Whether the compiler makes a loop or a call of zeroing an array is its own choice, another one in either
/// build.
const NO_REP: &str =
    "glibc.cpu.x86_rep_stosb_threshold=1000000000:glibc.cpu.x86_rep_movsb_threshold=1000000000";

/// Builds `crates/dem/examples/plain_bed.rs` both ways and counts its instructions under callgrind.
pub(crate) fn run(root: &Path) -> Result<()> {
    provide_valgrind()?;
    let with = instructions(root, "with-field", &[])?;
    let without = instructions(root, "without-field", &["--no-default-features"])?;
    #[expect(clippy::cast_precision_loss, reason = "a ratio for the eye")]
    let ratio = with as f64 / without as f64;
    println!(
        "plain bed, 1728 grains, 400 steps: {with} instructions with the field crate, {without} without it: \
         ratio {ratio:.5}"
    );
    if (ratio - 1.0).abs() > MOST {
        bail!("a plain scene pays for the field: ratio {ratio:.5}, at most {MOST} from 1 is allowed");
    }
    Ok(())
}

/// Instructions of the example in a build of its own.
fn instructions(root: &Path, name: &str, options: &[&str]) -> Result<u64> {
    let target: PathBuf = root.join("target/leaving-out").join(name);
    let mut build = cargo(root, &["build", "--release", "-p", "amberfield-dem", "--example", EXAMPLE]);
    execute(build.args(options).arg("--target-dir").arg(&target))?;
    let counts = target.join("callgrind.out");
    let mut count = Command::new("valgrind");
    count
        .args(["--tool=callgrind", "--quiet"])
        .arg(format!("--callgrind-out-file={}", counts.display()))
        .env("RAYON_NUM_THREADS", "1")
        .env("GLIBC_TUNABLES", NO_REP)
        .arg(target.join("release/examples").join(EXAMPLE));
    execute(&mut count)?;
    let text =
        std::fs::read_to_string(&counts).with_context(|| format!("cannot read {}", counts.display()))?;
    let total =
        text.lines().find_map(|line| line.strip_prefix("summary: ").or(line.strip_prefix("totals: ")));
    let total = total.with_context(|| format!("{} names no total", counts.display()))?;
    Ok(total.trim().parse()?)
}

/// Installs valgrind where it is missing.
fn provide_valgrind() -> Result<()> {
    if works(Command::new("valgrind").arg("--version")) {
        return Ok(());
    }
    println!("valgrind is missing: installing it with apt-get");
    execute(Command::new("apt-get").args(["update", "-q"]))
        .and_then(|()| execute(Command::new("apt-get").args(["install", "-y", "-q", "valgrind"])))
        .context("cannot install valgrind; install it, then try again")
}
