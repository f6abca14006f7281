//! `amberfield convert`.

use crate::arguments::ConvertOptions;
use crate::failure::Failure;
use crate::print;
use crate::run::{Saved, SolverFolder, read_scene};
use amberfield_core::{Axis, Domain};
use amberfield_scene::{
    Purpose, Snapshot, SnapshotBox, SnapshotOptions, Units, read_checkpoint, read_outline, write_snapshot,
};
use std::path::{Path, PathBuf};

/// Writes the grains of a file, a checkpoint or a run in another form.
pub(crate) fn convert(options: &ConvertOptions) -> Result<(), Failure> {
    let ConvertOptions { from, to, step, units, from_units, materials_by_type } = options;
    if let (Ok(from), Ok(to)) = (from.canonicalize(), to.canonicalize())
        && from == to
    {
        return Err(Failure::bad_input(format!(
            "{}: would overwrite itself; name another file",
            to.display()
        )));
    }
    let choices =
        SnapshotOptions { units: *from_units, step: *step, materials_by_type: materials_by_type.clone() };
    let is_checkpoint = from.extension().is_some_and(|ending| ending == "amber");
    let snapshot = if from.is_dir() {
        of_run(from, choices)?
    } else if is_checkpoint {
        of_checkpoint(from, &choices)?
    } else {
        Snapshot::read(from, &choices)?
    };
    write_snapshot(to, &snapshot, units.unwrap_or(Units::Si))?;
    if !snapshot.unused.is_empty() {
        print::line(format_args!("columns that were not read: {}", snapshot.unused.join(", ")));
    }
    let step = snapshot.step.map_or_else(String::new, |step| format!(" of step {step}"));
    print::line(format_args!("{} grains{step}: {}", snapshot.len(), to.display()));
    Ok(())
}

/// Reads a frame of a run folder: that of the step that was chosen, else the last one.
fn of_run(folder: &Path, choices: SnapshotOptions) -> Result<Snapshot, Failure> {
    let refuse = |problem: String| Failure::bad_input(format!("{}: {problem}", folder.display()));
    let entries = std::fs::read_dir(folder.join("particles")).into_iter().flatten().flatten();
    // Of the two forms of a frame the table comes first, since it has densities and names.
    let mut frames: Vec<(u64, PathBuf)> = entries.filter_map(|entry| frame(entry.path())).collect();
    frames.sort_by_key(|(step, path)| (*step, path.extension().is_none_or(|ending| ending != "csv")));
    let Some(last) = frames.last().map(|(step, _)| *step) else {
        return Err(refuse(
            "no frames particles/grains_*.csv or .vtu; name a run folder or a file".to_owned(),
        ));
    };
    let step = choices.step.unwrap_or(last);
    let Some((_, path)) = frames.iter().find(|(found, _)| *found == step) else {
        let first = frames.first().map_or(0, |(step, _)| *step);
        return Err(refuse(format!(
            "no frame of step {step}; there are {} from {first} to {last}",
            frames.len()
        )));
    };
    let outline = read_outline(&folder.join("scene.toml"))?;
    let is_table = path.extension().is_some_and(|ending| ending == "csv");
    let materials_by_type = match is_table || !choices.materials_by_type.is_empty() {
        true => choices.materials_by_type,
        false => outline.materials,
    };
    let choices = SnapshotOptions { step: None, materials_by_type, ..choices };
    let mut snapshot = Snapshot::read(path, &choices)?;
    snapshot.step = Some(step);
    snapshot.bounds = outline.domain.as_ref().map(bounds_of);
    Ok(snapshot)
}

/// Step of a frame's file; `None` for other files.
fn frame(path: PathBuf) -> Option<(u64, PathBuf)> {
    let name = path.file_name()?.to_str()?;
    let (step, ending) = name.strip_prefix("grains_")?.split_once('.')?;
    let step = step.parse().ok().filter(|_| matches!(ending, "csv" | "vtu"))?;
    Some((step, path))
}

/// Reads a checkpoint, whose scene stands in the run folder.
fn of_checkpoint(path: &Path, choices: &SnapshotOptions) -> Result<Snapshot, Failure> {
    if *choices != SnapshotOptions::default() {
        let problem = "a checkpoint has one step, SI units and names; leave the options for them out";
        return Err(Failure::bad_input(format!("{}: {problem}", path.display())));
    }
    let folder = path.parent().map_or_else(|| Path::new("..").to_path_buf(), |folder| folder.join(".."));
    let scene = folder.join("scene.toml");
    let scene = read_scene(&scene, &[], Purpose::Run, &SolverFolder::beside(&scene))?;
    let saved: Saved = read_checkpoint(path, scene.physics())?;
    let Some(domain) = &scene.domain else {
        let problem = "its domain is the mesh of a solver; convert a frame of the run instead";
        return Err(Failure::bad_input(format!("{}: {problem}", path.display())));
    };
    let mut all = scene.particles.clone();
    all.append(&scene.feeds.grains);
    let particles = saved.state.particles(&all, domain).map_err(|error| Failure::at_start(&error))?;
    let mut snapshot = Snapshot::of(particles);
    snapshot.step = Some(saved.state.step_index());
    snapshot.time_s = Some(saved.state.time_s());
    snapshot.bounds = Some(bounds_of(domain));
    snapshot.materials = scene.materials.into_iter().map(|material| material.name).collect();
    snapshot.groups = scene.groups;
    Ok(snapshot)
}

/// Box of a domain.
fn bounds_of(domain: &Domain) -> SnapshotBox {
    SnapshotBox {
        min_m: domain.min(),
        max_m: domain.max(),
        is_periodic: Axis::ALL.map(|axis| domain.is_periodic(axis)),
    }
}
