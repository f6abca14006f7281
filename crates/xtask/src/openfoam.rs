//! Everything that `openfoam-solver/` needs, and its build.
//!
//! Debian's OpenFOAM package has programs and libraries, but no headers and no wmake. The headers come from
//! the matching source package, by the system's own package sources turned into source ones. They are
//! unpacked into a folder below `target/`.

use crate::debian;
use crate::profile::Profile;
use crate::shell::{cargo, run as execute};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Packages that are installed from Debian where they are missing; one of the examples is a test.
const PACKAGES: [&str; 6] = ["openfoam", "openfoam-examples", "g++", "make", "cmake", "bzip2"];
/// Folders of the headers that the solver includes.
const HEADERS: [&str; 9] = [
    "finiteVolume",
    "meshTools",
    "OpenFOAM",
    "OSspecific/POSIX",
    "fvOptions",
    "transportModels/incompressible",
    "TurbulenceModels/turbulenceModels",
    "TurbulenceModels/incompressible",
    "TurbulenceModels/phaseIncompressible",
];
/// Variable without which nothing linked to OpenFOAM runs, and the folder that Debian's package has for it.
const PROJECT: (&str, &str) = ("WM_PROJECT_DIR", "/usr/share/openfoam");

/// Program of the solver that answers for the field alone; the others stand beside it.
pub(crate) const PROGRAM: &str = "electricFieldFoam";

/// Installs what is missing, fetches the headers, builds the C library, the solver and its self-test, and
/// runs the self-test.
pub(crate) fn run(root: &Path) -> Result<()> {
    release(root, Profile::Release.solver_folder(), &[]).map(drop)
}

/// Does the same into a folder of `openfoam-solver/`, with more to tell cmake; returns the programs' folder.
pub(crate) fn release(root: &Path, folder: &str, flags: &[&str]) -> Result<PathBuf> {
    provide(root)?;
    execute(&mut cargo(root, &["build", "--release", "-p", "amberfield-capi"]))?;
    build(root, Profile::Release, folder, flags)
}

/// Installs what a build needs and fetches the headers; compiles nothing.
pub(crate) fn provide(root: &Path) -> Result<()> {
    debian::provide(&PACKAGES)?;
    provide_headers(root).map(drop)
}

/// Builds around a C library that is built already, into a folder of `openfoam-solver/`, with more to tell
/// cmake; runs the self-test and returns the programs' folder.
pub(crate) fn build(root: &Path, profile: Profile, folder: &str, flags: &[&str]) -> Result<PathBuf> {
    let headers = provide_headers(root)?;
    let source = root.join("openfoam-solver");
    let build = source.join(folder);
    let library = profile.folder(root).join("libamberfield_capi.a");
    execute(
        Command::new("cmake")
            .args(["-S".as_ref(), source.as_os_str(), "-B".as_ref(), build.as_os_str()])
            .arg(format!("-DFOAM_SRC={}", headers.display()))
            .arg(format!("-DAMBERFIELD_LIB={}", library.display()))
            .args(flags),
    )?;
    execute(Command::new("cmake").arg("--build").arg(&build).args(["--parallel", "2"]))?;
    let mut test = Command::new(build.join("selfTest"));
    if std::env::var_os(PROJECT.0).is_none() {
        test.env(PROJECT.0, PROJECT.1);
    }
    execute(&mut test).context("the build computes wrong numbers; is -D__restrict__= among the flags?")?;
    Ok(build)
}

/// The `src` folder of the headers.
fn provide_headers(root: &Path) -> Result<PathBuf> {
    let version = debian::version("openfoam").context("OpenFOAM is not installed as a package")?;
    let folder = root.join("target/openfoam").join(&version);
    let source = folder.join("src");
    let complete = folder.join("complete");
    if !complete.is_file() {
        fetch_headers(&folder, &version)?;
    }
    let wmake = folder.join("wmake");
    let path = std::env::var("PATH").unwrap_or_default();
    for header in HEADERS.iter().map(|header| source.join(header)) {
        if header.join("lnInclude").is_dir() {
            continue;
        }
        let mut link = Command::new(wmake.join("wmakeLnInclude"));
        link.arg("-s").arg(header).env("WM_DIR", &wmake).env("WM_PROJECT_DIR", &folder);
        execute(link.env("PATH", format!("{}:{path}", wmake.display())))?;
    }
    std::fs::write(complete, "")?;
    Ok(source)
}

/// Fetches the source package of a version and unpacks what builds need of it into a folder.
fn fetch_headers(folder: &Path, version: &str) -> Result<()> {
    println!("fetching OpenFOAM's headers (source package {version}) into target/openfoam");
    let apt = private_apt(folder)?;
    let with_apt = |arguments: &[&str]| {
        let mut command = Command::new("apt-get");
        command.env("APT_CONFIG", &apt).current_dir(folder).args(arguments);
        execute(&mut command)
    };
    with_apt(&["update", "-q"])?;
    with_apt(&["source", "-q", "--download-only", &format!("openfoam={version}")])?;
    let archive = std::fs::read_dir(folder)?
        .flatten()
        .map(|entry| entry.path())
        .find(|path| path.to_string_lossy().contains(".orig.tar"))
        .context("the source package has no archive")?;
    let mut unpack = Command::new("tar");
    unpack.arg("-xf").arg(&archive).args(["--strip-components=1", "--wildcards", "*/src/*", "*/wmake/*"]);
    execute(unpack.current_dir(folder))?;
    std::fs::remove_file(&archive)?;
    Ok(())
}

/// A configuration of apt with the system's package sources as source ones, and state of its own.
fn private_apt(folder: &Path) -> Result<PathBuf> {
    for part in ["apt/lists/partial", "apt/cache/archives/partial", "apt/parts"] {
        std::fs::create_dir_all(folder.join(part))?;
    }
    let system = Path::new("/etc/apt");
    let parts = std::fs::read_dir(system.join("sources.list.d")).into_iter().flatten().flatten();
    let mut found = false;
    for path in parts.map(|entry| entry.path()).chain([system.join("sources.list")]) {
        let Ok(text) = std::fs::read_to_string(&path) else { continue };
        let lines = text.lines().map(|line| match line.strip_prefix("Types:") {
            Some(_) => "Types: deb-src".to_owned(),
            None if line.starts_with("deb ") => line.replacen("deb ", "deb-src ", 1),
            None => line.to_owned(),
        });
        let lines: Vec<String> = lines.collect();
        let name = path.file_name().unwrap_or_default();
        let ending = if text.contains("Types:") { "sources" } else { "list" };
        let own = folder.join("apt/parts").join(name).with_extension(ending);
        std::fs::write(own, lines.join("\n") + "\n")?;
        found = true;
    }
    if !found {
        bail!("no package sources below {}; configure apt, then try again", system.display());
    }
    let path = folder.join("apt/apt.conf");
    let place = folder.join("apt");
    let place = place.display();
    std::fs::write(
        &path,
        format!(
            "Dir::State::lists \"{place}/lists\";\nDir::Cache \"{place}/cache\";\n\
             Dir::Etc::sourcelist \"/dev/null\";\nDir::Etc::sourceparts \"{place}/parts\";\n\
             APT::Sandbox::User \"root\";\n"
        ),
    )?;
    Ok(path)
}
