//! Records of a run: rows of the history and files of the grains.

use super::exits::Exits;
use super::folder::RunFolder;
use super::histogram::Histogram;
use super::picture::draw;
use super::schedule::Schedule;
use super::wall_forces::WallForces;
use super::walls::faces;
use crate::failure::Failure;
use amberfield_core::WallCharging;
use amberfield_dem::{Book, ChargedSpot, Energies, FeedAccount, Simulation, Tally};
use amberfield_field::ConductorValues;
use amberfield_scene::files::{ELECTRIC_FORCE, HISTORY, When, in_heading};
use amberfield_scene::{
    ChargedSquare, HistoryFile, HistoryValue, PvdSeries, Scene, write_charge_vtu, write_particles_csv,
    write_vtu, write_walls_vtu,
};

/// Open files of a run.
#[derive(Debug)]
pub(crate) struct Record {
    history: HistoryFile,
    columns: HistoryColumns,
    /// Files of the grains.
    series: PvdSeries,
    /// Files of walls; `None` where no wall takes charge or moves.
    walls: Option<PvdSeries>,
    /// Forces on walls; `None` where there are no walls.
    wall_forces: Option<WallForces>,
    /// Grains that left.
    exits: Exits,
    /// Histograms of the charges; `None` where charges do not change.
    histogram: Option<Histogram>,
    /// Step of the last files of the grains.
    last_frame: Option<u64>,
}

/// Columns of the history that not every run has.
#[derive(Clone, Debug)]
struct HistoryColumns {
    gravity: bool,
    field: bool,
    transfer: bool,
    walls: bool,
    moving: bool,
    limited: bool,
    solver: bool,
    feeds: bool,
    /// Names of the materials, as they stand in columns, where grains come or go; else none.
    materials: Vec<String>,
    /// Names of the outlets, as they stand in columns.
    outlets: Vec<String>,
    /// Names of the walls that are conductors, as they stand in columns.
    conductors: Vec<String>,
    /// Names of the stages that are timed.
    stages: Vec<&'static str>,
}

impl HistoryColumns {
    fn new(scene: &Scene, simulation: &Simulation) -> Self {
        Self {
            gravity: scene.time.as_ref().is_some_and(|time| time.gravity_m_s2.norm() > 0.0),
            field: simulation.plan().has("field"),
            transfer: simulation.ledger().is_some(),
            walls: simulation.ledger().is_some()
                && scene.walls.iter().any(|wall| wall.charging != WallCharging::None),
            moving: simulation.wall_work().is_some(),
            limited: simulation.plan().has("field")
                && scene.electric_field.as_ref().is_some_and(|field| field.limit_field_force),
            solver: simulation.plan().has("field") && scene.solver.is_some(),
            feeds: !simulation.feeds().is_empty(),
            materials: if simulation.books().is_some() { materials_of(scene) } else { Vec::new() },
            outlets: scene.outlets.iter().map(|outlet| in_heading(&outlet.name)).collect(),
            conductors: if simulation.plan().has("field") { conductors_of(scene) } else { Vec::new() },
            stages: simulation.stage_seconds().into_iter().map(|(name, _)| name).collect(),
        }
    }

    /// Names of all columns, in the order of the table of files.
    fn names(&self) -> Vec<String> {
        let names = HISTORY.names(|when| self.holds(when)).flat_map(|name| {
            let of_stages = || self.stages.iter().map(|stage| name.replace("STAGE", stage)).collect();
            let of_materials = || self.materials.iter().map(|of| name.replace("NAME", of)).collect();
            let of_outlets = || self.outlets.iter().map(|of| name.replace("OUTLET", of)).collect();
            let of_conductors = || self.conductors.iter().map(|of| name.replace("WALL", of)).collect();
            match name {
                name if name.contains("WALL") => of_conductors(),
                name if name.contains("OUTLET") => of_outlets(),
                name if name.contains("STAGE") => of_stages(),
                name if name.contains("NAME") => of_materials(),
                name => vec![name.to_owned()],
            }
        });
        names.collect()
    }

    /// Whether columns with a condition are there.
    fn holds(&self, when: When) -> bool {
        match when {
            When::Always | When::Stage => true,
            When::Gravity => self.gravity,
            When::Motion => self.moving,
            When::Field => self.field,
            When::Transfer => self.transfer,
            When::ChargedWalls => self.walls,
            When::Limit => self.limited,
            When::Solver => self.solver,
            When::Feeds => self.feeds,
            When::Books => !self.materials.is_empty(),
            When::Outlets => !self.outlets.is_empty(),
            When::Conductors => !self.conductors.is_empty(),
            When::Components => false,
        }
    }
}

/// Times that a run took, with earlier parts of it.
#[derive(Clone, Debug)]
pub(crate) struct Clock {
    /// Wall time [s].
    pub(crate) wall_s: f64,
    /// Wall time of each stage [s].
    pub(crate) stages: Vec<f64>,
}

impl Record {
    /// Creates the records of a new run.
    pub(crate) fn create(
        folder: &RunFolder,
        scene: &Scene,
        simulation: &Simulation,
    ) -> Result<Self, Failure> {
        let columns = HistoryColumns::new(scene, simulation);
        let history = HistoryFile::create(&folder.file(HISTORY.path), &columns.names())?;
        let series = PvdSeries::new(&folder.file("particles.pvd"));
        let walls = (columns.walls || columns.moving).then(|| PvdSeries::new(&folder.file("walls.pvd")));
        if walls.is_some() {
            folder.make("walls")?;
        }
        let histogram = columns.transfer.then(|| Histogram::create(folder)).transpose()?;
        let wall_forces = WallForces::create(folder, simulation)?;
        let exits = Exits::create(folder, scene)?;
        let last_frame = None;
        Ok(Self { history, columns, series, walls, wall_forces, exits, histogram, last_frame })
    }

    /// Opens the records of a run that is continued.
    ///
    /// What was written after its checkpoint or outside of the schedule is removed.
    pub(crate) fn resume(
        folder: &RunFolder,
        scene: &Scene,
        simulation: &Simulation,
        schedule: &Schedule,
    ) -> Result<Self, Failure> {
        let columns = HistoryColumns::new(scene, simulation);
        let reached = simulation.step_index();
        let history = HistoryFile::resume(&folder.file(HISTORY.path), &columns.names(), reached, |step| {
            schedule.history.is_due(step)
        })?;
        let wall_forces = WallForces::resume(folder, simulation, |step| schedule.history.is_due(step))?;
        let is_kept =
            |name: &str| step_of(name).is_some_and(|step| step <= reached && schedule.frame_is_due(step));
        let series = PvdSeries::resume(&folder.file("particles.pvd"), is_kept);
        let has_walls = columns.walls || columns.moving;
        let walls = has_walls.then(|| PvdSeries::resume(&folder.file("walls.pvd"), is_kept));
        let frame_is_due = |step| schedule.frame_is_due(step);
        let histogram =
            columns.transfer.then(|| Histogram::resume(folder, reached, frame_is_due)).transpose()?;
        let files = |name: &str| std::fs::read_dir(folder.file(name)).into_iter().flatten().flatten();
        let files = files("particles").chain(files("walls"));
        for file in files.filter(|file| !is_kept(&file.file_name().to_string_lossy())) {
            // A file that cannot be removed does no harm, since the series does not name it.
            let _ = std::fs::remove_file(file.path());
        }
        let exits = Exits::resume(folder, scene, simulation)?;
        let last_frame = None;
        Ok(Self { history, columns, series, walls, wall_forces, exits, histogram, last_frame })
    }

    /// Writes down the grains that left in a step.
    pub(crate) fn exits(&mut self, simulation: &mut Simulation) -> Result<(), Failure> {
        self.exits.append(&simulation.take_exits())
    }

    /// Appends a row to the history, at most once for each step.
    pub(crate) fn row(
        &mut self,
        simulation: &mut Simulation,
        energies: &Energies,
        clock: &Clock,
    ) -> Result<(), Failure> {
        let step = simulation.step_index();
        if self.history.last_step() == Some(step) {
            return Ok(());
        }
        let mut row = vec![
            HistoryValue::Count(step),
            HistoryValue::Number(simulation.time_s()),
            HistoryValue::Number(energies.kinetic),
            HistoryValue::Number(energies.contact),
        ];
        row.extend(self.columns.gravity.then_some(HistoryValue::Number(energies.gravity)));
        row.extend(simulation.wall_work().map(HistoryValue::Number));
        if self.columns.field {
            row.push(HistoryValue::Number(energies.electric.unwrap_or_default()));
            row.push(HistoryValue::Number(simulation.particles().net_charge()));
        }
        if let Some(ledger) = simulation.ledger() {
            row.push(HistoryValue::Number(ledger.moved));
            row.extend(self.columns.walls.then(|| HistoryValue::Number(ledger.walls.iter().sum())));
        }
        if self.columns.limited {
            row.push(HistoryValue::Count(simulation.limited().unwrap_or_default().grains));
        }
        row.push(HistoryValue::Count(simulation.contacts() as u64));
        row.extend(simulation.ledger().map(|ledger| HistoryValue::Count(ledger.collisions)));
        if let Some(books) = simulation.books() {
            books_of(&books, &mut row);
            if self.columns.feeds {
                feeds_of(&books, &simulation.feeds(), &mut row);
            }
            outlets_of(simulation.outlets(), &mut row);
        }
        if !self.columns.conductors.is_empty() {
            let found = simulation.conductors().map_err(|error| Failure::while_running(&error))?;
            conductors_in(&found, &mut row);
        }
        row.extend(self.columns.solver.then(|| HistoryValue::Count(simulation.solver_iterations())));
        row.push(HistoryValue::Number(clock.wall_s));
        row.extend(clock.stages.iter().map(|seconds| HistoryValue::Number(*seconds)));
        if let Some(forces) = &mut self.wall_forces {
            forces.append(simulation)?;
        }
        Ok(self.history.append(&row)?)
    }

    /// Writes the files of the grains, at most once for each step. Tells whether it did.
    pub(crate) fn frame(
        &mut self,
        folder: &RunFolder,
        scene: &Scene,
        simulation: &Simulation,
    ) -> Result<bool, Failure> {
        let step = simulation.step_index();
        if self.last_frame.replace(step) == Some(step) {
            return Ok(false);
        }
        self.exits.tell(simulation.time_s());
        let particles = simulation.particles();
        let name = format!("particles/grains_{step:012}");
        if scene.output.csv {
            let path = folder.file(&format!("{name}.csv"));
            write_particles_csv(&path, &particles, &scene.materials, &scene.groups)?;
        }
        if scene.output.png {
            draw(&folder.file(&format!("{name}.png")), scene, simulation);
        }
        if scene.output.vtk {
            let file = format!("{name}.vtu");
            let forces = simulation.electric_forces();
            let vectors: Vec<_> = forces.iter().map(|forces| (ELECTRIC_FORCE, &forces[..])).collect();
            write_vtu(&folder.file(&file), &particles, &vectors)?;
            self.series.append(simulation.time_s(), &file)?;
            self.walls_frame(folder, scene, simulation)?;
        }
        if let Some(histogram) = &mut self.histogram {
            histogram.append(step, simulation.time_s(), &particles)?;
        }
        Ok(true)
    }

    /// Writes the files of the walls: their charge, and where those are that move.
    fn walls_frame(
        &mut self,
        folder: &RunFolder,
        scene: &Scene,
        simulation: &Simulation,
    ) -> Result<(), Failure> {
        let (step, time_s) = (simulation.step_index(), simulation.time_s());
        let Some(walls) = &mut self.walls else { return Ok(()) };
        if self.columns.walls {
            let file = format!("walls/charge_{step:012}.vtu");
            let square = |(spot, density): (&ChargedSpot, f64)| ChargedSquare {
                wall: spot.wall,
                corners: spot.square(),
                charge_c: spot.charge,
                density_c_m2: density,
            };
            let squares: Vec<_> = simulation.charged_spots().map(square).collect();
            write_charge_vtu(&folder.file(&file), &squares)?;
            walls.append(time_s, &file)?;
        }
        if self.columns.moving {
            let file = format!("walls/surface_{step:012}.vtu");
            write_walls_vtu(&folder.file(&file), &faces(scene, simulation))?;
            walls.append_part(time_s, 1, &file)?;
        }
        Ok(())
    }
}

/// Names of a scene's materials, without what would part columns.
fn materials_of(scene: &Scene) -> Vec<String> {
    scene.materials.iter().map(|material| in_heading(&material.name)).collect()
}

/// Names of walls that are conductors of the field, with a number where one has come before.
fn conductors_of(scene: &Scene) -> Vec<String> {
    let conductors = scene.electric_field.iter().flat_map(|field| &field.field.conductors);
    let mut names: Vec<String> = Vec::new();
    for conductor in conductors {
        let name = in_heading(&conductor.name);
        let number = (2..).map(|number| format!("{name}_{number}"));
        let free = std::iter::once(name.clone()).chain(number).find(|name| !names.contains(name));
        names.extend(free);
    }
    names
}

/// Adds the states of conductors to a row of the history.
fn conductors_in(conductors: &[ConductorValues], row: &mut Vec<HistoryValue>) {
    row.extend(conductors.iter().map(|of| HistoryValue::Number(of.potential_v)));
    row.extend(conductors.iter().map(|of| HistoryValue::Number(of.charge_c)));
    row.extend(conductors.iter().map(|of| HistoryValue::Number(of.current_a)));
}

/// Adds the books of what is there and what left to a row of the history.
fn books_of(books: &[Book], row: &mut Vec<HistoryValue>) {
    let Book { left, inside, .. } = Book::sum(books);
    let (count, number) = (HistoryValue::Count, HistoryValue::Number);
    row.extend([count(inside.grains), number(inside.mass)]);
    row.extend([count(left.grains), number(left.mass), number(left.charge)]);
    let tallies: [fn(&Book) -> Tally; 2] = [|book| book.inside, |book| book.left];
    row.extend(tallies.iter().flat_map(|of| books.iter().map(|book| count(of(book).grains))));
    row.extend(tallies.iter().flat_map(|of| books.iter().map(|book| number(of(book).mass))));
    row.extend(tallies.iter().flat_map(|of| books.iter().map(|book| number(of(book).charge))));
    row.extend(books.iter().map(|book| number(book.gained)));
}

/// Adds the books of what feeds brought, and what they owe, to a row of the history.
fn feeds_of(books: &[Book], feeds: &[FeedAccount], row: &mut Vec<HistoryValue>) {
    let fed = Book::sum(books).fed;
    let owed = Tally::sum(feeds.iter().map(|feed| &feed.owed));
    let (count, number) = (HistoryValue::Count, HistoryValue::Number);
    row.extend([count(fed.grains), number(fed.mass), number(fed.charge)]);
    row.extend([count(owed.grains), number(owed.mass)]);
    row.extend(books.iter().map(|book| count(book.fed.grains)));
    row.extend(books.iter().map(|book| number(book.fed.mass)));
    row.extend(books.iter().map(|book| number(book.fed.charge)));
}

/// Adds the books of outlets to a row of the history.
fn outlets_of(outlets: &[Vec<Tally>], row: &mut Vec<HistoryValue>) {
    let sums: Vec<Tally> = outlets.iter().map(Tally::sum).collect();
    row.extend(sums.iter().map(|sum| HistoryValue::Count(sum.grains)));
    row.extend(sums.iter().map(|sum| HistoryValue::Number(sum.mass)));
    row.extend(sums.iter().map(|sum| HistoryValue::Number(sum.charge)));
}

/// Step in the name of a file.
fn step_of(name: &str) -> Option<u64> {
    name.rsplit(['/', '_']).next()?.split('.').next()?.parse().ok()
}
