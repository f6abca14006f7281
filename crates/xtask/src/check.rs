//! Everything that must hold before a change is merged.

use crate::profile::Profile;
use crate::shell::{cargo, run as execute};
use crate::{book, deny, leaving_out, test, tidy};
use anyhow::{Result, bail};
use std::path::Path;
use std::process::Command;
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
        let cli = ["clippy", "-p", "amberfield-cli", "--no-default-features", "--lib", "--bins"];
        execute(cargo(root, &cli).args(["--", "-D", "warnings"]))
    });
    step("docs", &|| documentation(root));
    step("book", &|| book::run(root));
    step("deny", &|| deny::run(root));
    step("bench, quick", &|| quick_bench(root));
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

/// Runs the measuring program at its smallest size. The whole workspace is compiled for it, as for the tests:
/// for a part of it, crates would be compiled with other features, and then once more.
fn quick_bench(root: &Path) -> Result<()> {
    execute(&mut cargo(root, &["build", "--workspace", "--all-targets"]))?;
    let mut bench = Command::new(Profile::Dev.folder(root).join("bench"));
    execute(bench.current_dir(root).args(["--quick", "--out", "target/quick-report"]))
}

fn documentation(root: &Path) -> Result<()> {
    execute(cargo(root, &["doc", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings"))
}
