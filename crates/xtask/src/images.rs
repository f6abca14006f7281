//! The container images, and an engine that builds and runs them.

use crate::openfoam::PROGRAM;
use crate::profile::Profile;
use crate::shell::{cargo, run as execute, works};
use crate::{debian, openfoam};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Debian's release that has the OpenFOAM we build for.
const RELEASE: &str = "bookworm";
/// Name that we give to an image of that release.
const BASE: &str = "amberfield-debian:bookworm";
/// Name of an image of that release in a registry, where one can be reached.
const STOCK: &str = "debian:bookworm-slim";
/// Package of the engine.
const ENGINE: &str = "docker.io";
/// Package of the program that drives two containers at once.
const COMPOSE: &str = "docker-compose";
/// Images with a stage that has Debian's packages and nothing of ours, and that stage.
const PACKAGE_STAGES: [(&str, &str); 2] = [("openfoam", "package"), ("host", "server")];
/// Longest time that an engine may take to start.
const START: Duration = Duration::from_secs(60);

/// Builds all images.
pub(crate) fn run(root: &Path) -> Result<()> {
    openfoam::run(root)?;
    execute(&mut cargo(root, &["build", "--release", "-p", "amberfield-cli"]))?;
    provide(root)?;
    build(root, Profile::Release)
}

/// Starts an engine where none runs, and makes what the images begin with; compiles nothing.
pub(crate) fn provide(root: &Path) -> Result<()> {
    let place = place(root)?;
    provide_engine(&place)?;
    provide_base(&place)?;
    // OpenFOAM's package is most of an image: made now, it is taken from the engine's cache later.
    for (name, stage) in PACKAGE_STAGES {
        let context = place.join(stage);
        std::fs::create_dir_all(&context)?;
        let mut build = Command::new("docker");
        build.args(["build", "-q", "--target", stage, "--build-arg", &format!("BASE={BASE}"), "-f"]);
        execute(build.arg(recipe(root, name)).arg(context))?;
    }
    Ok(())
}

/// Builds all images around programs that are built already.
pub(crate) fn build(root: &Path, profile: Profile) -> Result<()> {
    let place = place(root)?;
    let solver = root.join("openfoam-solver").join(profile.solver_folder());
    let [field, gas, library, test] =
        [PROGRAM, "amberPimpleFoam", "libelectricField.so", "selfTest"].map(|name| solver.join(name));
    let script = root.join("docker/solve.sh");
    let dem = profile.folder(root).join("amberfield");
    image(root, &place, "dem", &[&dem])?;
    image(root, &place, "openfoam", &[&script, &field, &gas, &library, &test])?;
    image(root, &place, "host", &[&dem, &field, &gas, &library, &test])
}

/// Folder in which images are made.
fn place(root: &Path) -> Result<PathBuf> {
    let place = root.join("target/images");
    std::fs::create_dir_all(&place)?;
    Ok(place)
}

/// File that says how an image is made.
fn recipe(root: &Path, name: &str) -> PathBuf {
    root.join(format!("docker/{name}.Dockerfile"))
}

/// Builds `amberfield-<name>` of `docker/<name>.Dockerfile` around some files.
fn image(root: &Path, place: &Path, name: &str, files: &[&Path]) -> Result<()> {
    let context = place.join(name);
    std::fs::create_dir_all(&context)?;
    for file in files {
        let target = context.join(file.file_name().context("a file has a name")?);
        std::fs::copy(file, &target).with_context(|| format!("cannot copy {}", file.display()))?;
    }
    let mut build = Command::new("docker");
    build.args([
        "build",
        "-q",
        "--build-arg",
        &format!("BASE={BASE}"),
        "-t",
        &format!("amberfield-{name}"),
        "-f",
    ]);
    execute(build.arg(recipe(root, name)).arg(context))
}

/// Installs and starts an engine where none runs.
fn provide_engine(place: &Path) -> Result<()> {
    let runs = || works(Command::new("docker").arg("info"));
    if !works(Command::new("docker").arg("--version")) {
        debian::provide(&[ENGINE])?;
    }
    if !works(Command::new(COMPOSE).arg("version"))
        && !works(Command::new("docker").args(["compose", "version"]))
    {
        debian::provide(&[COMPOSE])?;
    }
    if runs() {
        return Ok(());
    }
    let log = place.join("dockerd.log");
    println!("no container engine runs; starting dockerd, its log is {}", log.display());
    let file = std::fs::File::create(&log)?;
    let mut engine = Command::new("dockerd")
        .stdin(Stdio::null())
        .stdout(file.try_clone()?)
        .stderr(file)
        .spawn()
        .context("cannot start dockerd; start a container engine, then try again")?;
    let begun = Instant::now();
    while !runs() {
        let ended = engine.try_wait()?.is_some();
        if ended || begun.elapsed() > START {
            let said = std::fs::read_to_string(&log).unwrap_or_default();
            let last = said.lines().last().unwrap_or("nothing");
            bail!("dockerd did not start and said: {last}; start a container engine, or run this as root");
        }
        std::thread::sleep(Duration::from_millis(200));
    }
    Ok(())
}

/// Debian's base system as an image: from a registry, or made here.
fn provide_base(place: &Path) -> Result<()> {
    if works(Command::new("docker").args(["image", "inspect", BASE])) {
        return Ok(());
    }
    if works(Command::new("docker").args(["pull", STOCK])) {
        return execute(Command::new("docker").args(["tag", STOCK, BASE]));
    }
    println!("no registry has {STOCK}; making it with debootstrap");
    debian::provide(&["debootstrap"])?;
    let folder = place.join("base");
    let _ = std::fs::remove_dir_all(&folder);
    let mut bootstrap = Command::new("debootstrap");
    bootstrap
        .args(["--variant=minbase", RELEASE])
        .arg(&folder)
        .args(debian::mirror(RELEASE))
        .stdout(Stdio::null());
    execute(&mut bootstrap).context("debootstrap needs root and the system's package sources")?;
    let mut pack =
        Command::new("tar").arg("-C").arg(&folder).args(["-c", "."]).stdout(Stdio::piped()).spawn()?;
    let packed = pack.stdout.take().context("tar has an output")?;
    execute(Command::new("docker").args(["import", "-", BASE]).stdin(packed))?;
    if !pack.wait()?.success() {
        bail!("tar could not read all of {}", folder.display());
    }
    Ok(std::fs::remove_dir_all(&folder)?)
}
