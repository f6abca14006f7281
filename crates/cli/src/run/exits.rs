//! Grains that left: `exits.csv` and `outlets_grains.csv`, a row for each, and a line of the log for each
//! face or outlet and file of the grains.

use super::folder::RunFolder;
use crate::failure::Failure;
use amberfield_core::{OnExit, Outlet};
use amberfield_dem::{Exit, Simulation, WayOut};
use amberfield_scene::files::{EXITS, FileTable, OUTLETS_GRAINS};
use amberfield_scene::{HistoryFile, HistoryValue, Scene};
use std::collections::BTreeMap;

/// Names of the files.
pub(crate) const FILES: [&str; 2] = [EXITS.path, OUTLETS_GRAINS.path];

/// Sums over the grains that left by one way.
#[derive(Clone, Copy, Debug, Default)]
struct Through {
    grains: u64,
    /// Charge [C].
    charge: f64,
}

/// Open files of grains that left.
#[derive(Debug)]
pub(crate) struct Exits {
    /// Rows of grains that left through faces; `None` where they end the run.
    by_face: Option<HistoryFile>,
    /// Rows of grains that left through outlets; `None` where no outlet lists each.
    by_outlet: Option<HistoryFile>,
    outlets: Vec<Outlet>,
    /// Names of the materials.
    materials: Vec<String>,
    /// Grains that left since the log was told, by way.
    untold: BTreeMap<String, Through>,
}

impl Exits {
    /// Creates the files of a new run.
    pub(crate) fn create(folder: &RunFolder, scene: &Scene) -> Result<Self, Failure> {
        let create = |file: &FileTable| HistoryFile::create(&folder.file(file.path), &file.heading());
        Self::of(scene, |file| Ok(create(file)?))
    }

    /// Opens the files of a run that is continued; rows after its step are removed.
    pub(crate) fn resume(
        folder: &RunFolder,
        scene: &Scene,
        simulation: &Simulation,
    ) -> Result<Self, Failure> {
        let step = simulation.step_index();
        let resume =
            |file: &FileTable| HistoryFile::resume(&folder.file(file.path), &file.heading(), step, |_| true);
        Self::of(scene, |file| Ok(resume(file)?))
    }

    fn of(scene: &Scene, open: impl Fn(&FileTable) -> Result<HistoryFile, Failure>) -> Result<Self, Failure> {
        let deletes = scene.time.as_ref().is_some_and(|time| time.on_exit == OnExit::Delete);
        let lists = scene.outlets.iter().any(|outlet| outlet.each);
        Ok(Self {
            by_face: deletes.then(|| open(&EXITS)).transpose()?,
            by_outlet: lists.then(|| open(&OUTLETS_GRAINS)).transpose()?,
            outlets: scene.outlets.clone(),
            materials: scene.materials.iter().map(|material| material.name.clone()).collect(),
            untold: BTreeMap::new(),
        })
    }

    /// Appends grains that left.
    pub(crate) fn append(&mut self, exits: &[Exit]) -> Result<(), Failure> {
        for exit in exits {
            let way = match exit.way {
                WayOut::Face(face) => {
                    self.append_at_face(exit, face)?;
                    face.to_owned()
                }
                WayOut::Outlet(number) => {
                    self.append_at_outlet(exit, usize::from(number))?;
                    format!("outlet \"{}\"", self.outlets[usize::from(number)].name)
                }
            };
            let through = self.untold.entry(way).or_default();
            through.grains += 1;
            through.charge += exit.charge;
        }
        Ok(())
    }

    fn append_at_face(&mut self, exit: &Exit, face: &str) -> Result<(), Failure> {
        let Some(rows) = &mut self.by_face else { return Ok(()) };
        let mut row = vec![HistoryValue::Count(exit.step), HistoryValue::Number(exit.time_s)];
        row.extend([HistoryValue::Count(exit.id), HistoryValue::Text(face.to_owned())]);
        row.extend(motion(exit));
        row.extend([exit.radius, exit.charge].map(HistoryValue::Number));
        Ok(rows.append(&row)?)
    }

    fn append_at_outlet(&mut self, exit: &Exit, number: usize) -> Result<(), Failure> {
        let Some(rows) = &mut self.by_outlet else { return Ok(()) };
        let outlet = &self.outlets[number];
        if !outlet.each {
            return Ok(());
        }
        let material = &self.materials[usize::from(exit.material.0)];
        let mut row = vec![HistoryValue::Count(exit.step), HistoryValue::Number(exit.time_s)];
        row.extend([
            HistoryValue::Text(outlet.name.clone()),
            HistoryValue::Count(exit.id),
            HistoryValue::Text(material.clone()),
        ]);
        row.extend(motion(exit));
        row.extend([exit.radius, exit.mass, exit.charge].map(HistoryValue::Number));
        Ok(rows.append(&row)?)
    }

    /// Tells the log how many grains left by each way since it was told last.
    pub(crate) fn tell(&mut self, time_s: f64) {
        for (way, Through { grains, charge }) in std::mem::take(&mut self.untold) {
            tracing::info!(
                "{grains} grain(s) left through {way} with {charge:.3e} C, up to t = {time_s:e} s"
            );
        }
    }
}

/// Place and velocity of a grain that left.
fn motion(exit: &Exit) -> [HistoryValue; 6] {
    let (x, v) = (exit.position, exit.velocity);
    [x.x, x.y, x.z, v.x, v.y, v.z].map(HistoryValue::Number)
}
