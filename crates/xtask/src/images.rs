//! The two container images, and an engine that builds and runs them.

use crate::shell::{cargo, run as execute, works};
use crate::{debian, openfoam};
use anyhow::{Context, Result, bail};
use std::path::Path;
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
/// Longest time that an engine may take to start.
const START: Duration = Duration::from_secs(60);

/// Builds both images.
pub(crate) fn run(root: &Path) -> Result<()> {
    openfoam::run(root)?;
    build(root)
}

/// Builds both images around a field solver that is built already.
pub(crate) fn build(root: &Path) -> Result<()> {
    let place = root.join("target/images");
    std::fs::create_dir_all(&place)?;
    provide_engine(&place)?;
    provide_base(&place)?;
    execute(&mut cargo(root, &["build", "--release", "-p", "amberfield-cli"]))?;
    let solver = ["electricFieldFoam", "amberPimpleFoam", "libelectricField.so", "selfTest"]
        .map(|name| root.join("openfoam-solver/build").join(name));
    let [field, gas, library, test] = &solver;
    let script = root.join("docker/solve.sh");
    image(root, &place, "dem", &[&root.join("target/release/amberfield")])?;
    image(root, &place, "openfoam", &[&script, field, gas, library, test])
}

/// Builds `amberfield-<name>` of `docker/<name>.Dockerfile` around some files.
fn image(root: &Path, place: &Path, name: &str, files: &[&Path]) -> Result<()> {
    let context = place.join(name);
    std::fs::create_dir_all(&context)?;
    for file in files {
        let target = context.join(file.file_name().context("a file has a name")?);
        std::fs::copy(file, &target).with_context(|| format!("cannot copy {}", file.display()))?;
    }
    let recipe = root.join(format!("docker/{name}.Dockerfile"));
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
    execute(build.arg(recipe).arg(context))
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
