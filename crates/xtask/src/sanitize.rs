//! The address sanitizer over unsafe code: Rust's tests of it, and the field solver's.

use crate::shell::{cargo, run as execute};
use crate::{debian, openfoam};
use anyhow::Result;
use std::path::Path;

/// Crates with unsafe code.
const CRATES: [&str; 4] = ["amberfield-wire", "amberfield-field", "amberfield-coupling", "amberfield-capi"];
/// Tests over OpenFOAM that the sanitizer cannot be in.
///
/// Either a solver that is not built with it loads our library, or another build of the solver is meant, or
/// the test looks at memory, which the sanitizer does not give back, or a patch has eight faces a rank (see
/// [`OPTIONS`]).
const NOT_THESE: [&str; 4] =
    ["function_object", "of_a_later_version", "a_long_run_holds", "needs_no_charge_and_is_the_same"];
/// Options of the sanitizer for two habits of OpenFOAM's.
///
/// OpenFOAM keeps what it made until the process ends, so leaks are not looked for. And the package's own
/// `Foam::sqr` of normals (slip walls, outlets) reads eight bytes behind the last. This is harmless behind
/// an allocation of libc's, but not where an allocation of the sanitizer's ends with its page. With gaps of
/// 32 bytes between allocations none of the tests' patches ends there, except those of eight faces.
const OPTIONS: &str = "detect_leaks=0:max_redzone=32";
/// The sanitizer needs the target named, so that build scripts do without it.
const TARGET: &str = "x86_64-unknown-linux-gnu";

/// Builds and runs Rust's tests and the field solver's.
pub(crate) fn run(root: &Path) -> Result<()> {
    let mut test = cargo(root, &["test", "--lib", "--tests", "--target", TARGET]);
    test.args(CRATES.iter().flat_map(|name| ["-p", name]));
    test.env("CARGO_TARGET_DIR", root.join("target/sanitize"));
    // A flag that stable compilers know, and hide.
    execute(test.env("RUSTC_BOOTSTRAP", "1").env("RUSTFLAGS", "-Zsanitizer=address"))?;

    debian::provide(&["libasan8"])?;
    let flags = "-DCMAKE_CXX_FLAGS=-fsanitize=address -fno-omit-frame-pointer -g";
    let build = openfoam::release(root, "build-sanitize", &[flags])?;
    let mut tests =
        cargo(root, &["test", "-p", "amberfield-tests", "--test", "commands", "--", "openfoam::"]);
    tests.args(NOT_THESE.iter().flat_map(|name| ["--skip", name]));
    tests.env("AMBERFIELD_SOLVER", build.join(openfoam::PROGRAM));
    execute(tests.env("ASAN_OPTIONS", OPTIONS))
}
