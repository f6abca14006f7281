//! The price of what a plain scene leaves out: instructions of a run over those of the crate's lower folders
//! alone, which know no field, no charge and no gas.

use crate::shell::{cargo, run as execute, works};
use anyhow::{Context, Result, bail, ensure};
use std::path::Path;
use std::process::Command;

/// Largest share of instructions by which the two programs may differ.
const MOST: f64 = 0.01;
/// Example of the dem crate that runs the plain bed as any scene is run.
const WHOLE: &str = "plain_bed";
/// Example that runs the same bed with the folders `motion` and `contacts` alone, which know no field.
const BARE: &str = "bare_bed";
/// Folder in which both are built.
const TARGET: &str = "target/leaving-out";
/// Setting that keeps the C library from `rep stosb` and `rep movsb`, of which callgrind counts an
/// instruction per byte.
///
/// Whether the compiler makes a loop or a call of zeroing an array is its own choice, another one in either
/// program.
const NO_REP: &str =
    "glibc.cpu.x86_rep_stosb_threshold=1000000000:glibc.cpu.x86_rep_movsb_threshold=1000000000";

/// Builds both examples of `crates/dem/examples` and counts their instructions under callgrind. They must end
/// with the same numbers.
pub(crate) fn run(root: &Path) -> Result<()> {
    provide_valgrind()?;
    for example in [WHOLE, BARE] {
        let build = ["build", "--release", "-p", "amberfield-dem", "--example", example];
        execute(cargo(root, &build).arg("--target-dir").arg(root.join(TARGET)))?;
    }
    let (whole, bare) = std::thread::scope(|scope| {
        let whole = scope.spawn(|| measure(root, WHOLE));
        let bare = measure(root, BARE);
        (whole.join().expect("what measures does not panic"), bare)
    });
    let (whole, bare) = (whole?, bare?);
    ensure!(
        whole.told == bare.told,
        "the two programs do not run the same bed: {WHOLE} ends with {}, {BARE} with {}",
        whole.told,
        bare.told
    );
    #[expect(clippy::cast_precision_loss, reason = "a ratio for the eye")]
    let ratio = whole.instructions as f64 / bare.instructions as f64;
    println!(
        "plain bed, 1728 grains, 1000 steps: {} instructions as a run, {} with motion and contacts alone: \
         ratio {ratio:.5}",
        whole.instructions, bare.instructions
    );
    if (ratio - 1.0).abs() > MOST {
        bail!(
            "a plain scene pays for what it leaves out: ratio {ratio:.5}, at most {MOST} from 1 is allowed"
        );
    }
    Ok(())
}

/// One program, run under callgrind.
struct Measured {
    instructions: u64,
    /// Numbers that it ended with.
    told: String,
}

fn measure(root: &Path, example: &str) -> Result<Measured> {
    let target = root.join(TARGET);
    let counts = target.join(format!("{example}.callgrind"));
    let mut count = Command::new("valgrind");
    count
        .args(["--tool=callgrind", "--quiet"])
        .arg(format!("--callgrind-out-file={}", counts.display()))
        .env("RAYON_NUM_THREADS", "1")
        .env("GLIBC_TUNABLES", NO_REP)
        .arg(target.join("release/examples").join(example));
    let output = count.output().with_context(|| format!("cannot run {count:?}"))?;
    let complaint = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{example} failed under callgrind: {complaint}");
    let told = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    Ok(Measured { instructions: total(&counts)?, told })
}

/// Instructions that a file of callgrind's counts.
fn total(counts: &Path) -> Result<u64> {
    let text =
        std::fs::read_to_string(counts).with_context(|| format!("cannot read {}", counts.display()))?;
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
