//! Everything that must hold before a change is merged.

use crate::shell::{cargo, run as execute};
use crate::{deny, leaving_out, test, tidy};
use anyhow::{Result, bail};
use std::path::Path;
use std::time::Instant;

/// Runs every check, also after one failed, and fails if any did.
pub(crate) fn run(root: &Path, with_tests: bool) -> Result<()> {
    let mut failed = Vec::new();
    let mut step = |name: &'static str, result: &dyn Fn() -> Result<()>| {
        println!("== {name}");
        let start = Instant::now();
        match result() {
            Ok(()) => println!("== {name}: good, {:.0} s", start.elapsed().as_secs_f64()),
            Err(error) => {
                println!("== {name}: failed: {error:#}");
                failed.push(name);
            }
        }
    };
    step("format", &|| execute(&mut cargo(root, &["fmt", "--all", "--check"])));
    step("tidy", &|| tidy::run(root));
    step("clippy", &|| {
        execute(&mut cargo(root, &["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]))
    });
    step("clippy without coupling and plots", &|| {
        let cli = ["clippy", "-p", "amberfield-cli", "--no-default-features", "--bins"];
        execute(cargo(root, &cli).args(["--", "-D", "warnings"]))
    });
    step("docs", &|| documentation(root));
    step("deny", &|| deny::run(root));
    step("bench, quick", &|| {
        let bench = [
            "run",
            "-p",
            "amberfield-study",
            "--bin",
            "bench",
            "--",
            "--quick",
            "--out",
            "target/quick-report",
        ];
        execute(&mut cargo(root, &bench))
    });
    step("leaving out", &|| leaving_out::run(root));
    if with_tests {
        step("tests", &|| test::run(root));
    }
    if failed.is_empty() {
        println!("== all checks good");
        return Ok(());
    }
    bail!("failed: {}", failed.join(", "))
}

fn documentation(root: &Path) -> Result<()> {
    execute(cargo(root, &["doc", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings"))
}
