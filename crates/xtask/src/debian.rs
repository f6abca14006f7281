//! Packages of Debian's that are installed where they are missing.

use crate::shell::run as execute;
use anyhow::{Context, Result};
use std::process::Command;

/// Installs packages that are not there, and says so.
pub(crate) fn provide(packages: &[&str]) -> Result<()> {
    let missing: Vec<&str> = packages.iter().copied().filter(|package| version(package).is_none()).collect();
    if missing.is_empty() {
        return Ok(());
    }
    println!("installing {} with apt-get", missing.join(", "));
    execute(Command::new("apt-get").args(["update", "-q"]))
        .and_then(|()| {
            let mut install = Command::new("apt-get");
            install.args(["install", "-y", "-q", "--no-install-recommends"]).args(&missing);
            execute(install.env("DEBIAN_FRONTEND", "noninteractive"))
        })
        .with_context(|| format!("cannot install {}; install it, then try again", missing.join(", ")))
}

/// Source version of an installed package.
pub(crate) fn version(package: &str) -> Option<String> {
    let query = Command::new("dpkg-query")
        .args(["-W", "-f", "${db:Status-Status} ${source:Version}", package])
        .output()
        .ok()?;
    let text = String::from_utf8(query.stdout).ok()?;
    text.strip_prefix("installed ").map(str::to_owned)
}

/// Address from which the system gets a release's packages, as its own sources say.
pub(crate) fn mirror(release: &str) -> Option<String> {
    let listed = Command::new("apt-get")
        .args(["indextargets", "--format", "$(SITE)", &format!("Release: {release}")])
        .output()
        .ok()?;
    String::from_utf8(listed.stdout).ok()?.lines().next().map(str::to_owned)
}
