//! Section `[particles]`.

use super::description::Filled;
use super::filled::read_filled;
use super::fixed::fix_groups;
use crate::SceneError;
use crate::generate::{GenerateContext, generate};
use crate::materials::Materials;
use crate::particles::{
    FileChoices, GrainContext, MaterialNames, ReadParticles, SnapshotBox, Units, read_grains,
};
use crate::source::SceneSource;
use crate::table::SceneTable;
use amberfield_core::{Axis, Domain, OnExit, Particles, Wall};

/// Relative difference of two periods that are one: files may have six digits.
const SAME_PERIOD: f64 = 1e-5;

/// Content of `[particles]`.
#[derive(Debug)]
pub(super) struct ParticlesSection {
    pub(super) read: ReadParticles,
    /// Run from whose checkpoint they are.
    pub(super) filled: Option<Filled>,
    /// Treatment of grains that leave the domain.
    pub(super) on_exit: OnExit,
    /// Switch for grains that overlap at the start.
    pub(super) allow_overlap: bool,
    /// Facts about the file that the user should know.
    pub(super) warnings: Vec<String>,
}

/// Keys that say how a file is read.
const KEYS_OF_FILES: [&str; 3] = ["units", "step", "materials_by_type"];

/// Reads `[particles]`, with the file that it names or the generator that it describes.
pub(super) fn read_section(
    document: &SceneTable<'_>,
    domain: Option<&Domain>,
    materials: &Materials,
    walls: &[Wall],
    allow_points: bool,
    source: &mut SceneSource,
) -> Result<ParticlesSection, SceneError> {
    let has_feeds = document.has("feeds") && !allow_points;
    let nothing = || ReadParticles {
        particles: Particles::default(),
        groups: vec!["all".to_owned()],
        has_charge: false,
    };
    let table = match document.table("particles")? {
        Some(table) => table,
        None if has_feeds => {
            let (filled, on_exit, allow_overlap, warnings) = Default::default();
            return Ok(ParticlesSection { read: nothing(), filled, on_exit, allow_overlap, warnings });
        }
        None => {
            let advice = "add [particles] with file = \"grains.csv\" or generate = { … }";
            return Err(document.missing("particles", advice));
        }
    };
    let on_exit =
        table.word("on_exit", &[("stop", OnExit::Stop), ("delete", OnExit::Delete)])?.unwrap_or_default();
    let allow_overlap = table.boolean("allow_overlap")?.unwrap_or(false);
    let mut warnings = Vec::new();
    let mut filled = None;
    refuse_keys_of_files(&table)?;
    let mut read = match origin(&table)? {
        None if has_feeds => nothing(),
        None => return Err(table.missing("file", "give file = \"grains.csv\" or generate = { … }")),
        Some(Origin::File(file)) => {
            let context = GrainContext { domain, materials: names(&table, materials)?, allow_points };
            read_file(&table, file, &context, source, &mut warnings)?
        }
        Some(Origin::Run(from)) => {
            let (grains, run) = read_filled(&table, from, domain, materials, source)?;
            filled = Some(run);
            grains
        }
        Some(Origin::Generator(generator)) => {
            let Some(domain) = domain else {
                return Err(table.bad("generate", "a generator needs [domain]; add it"));
            };
            let mut context = GenerateContext { domain, materials, walls, source };
            generate(&generator, &mut context)?
        }
    };
    fix_groups(&table, &mut read, filled.is_some())?;
    Ok(ParticlesSection { read, filled, on_exit, allow_overlap, warnings })
}

/// Origin of the grains at the start.
enum Origin<'a> {
    /// File of grains.
    File(&'a str),
    /// Generator.
    Generator(SceneTable<'a>),
    /// Another run.
    Run(&'a str),
}

/// Origin that a section names; `None` where it names none.
fn origin<'a>(table: &SceneTable<'a>) -> Result<Option<Origin<'a>>, SceneError> {
    let file = table.text("file")?.map(Origin::File);
    let generator = table.table("generate")?.map(Origin::Generator);
    let run = table.text("from")?.map(Origin::Run);
    let named = [("file", file.is_some()), ("generate", generator.is_some()), ("from", run.is_some())];
    let mut named = named.into_iter().filter(|(_, given)| *given).map(|(key, _)| key);
    if let (Some(first), Some(second)) = (named.next(), named.next()) {
        let problem = format!("{first} is given too; give exactly one of file, generate, from");
        return Err(table.bad(second, problem));
    }
    Ok(file.or(generator).or(run))
}

/// Refuses keys that say how a file is read where there is none.
fn refuse_keys_of_files(table: &SceneTable<'_>) -> Result<(), SceneError> {
    let key = KEYS_OF_FILES.into_iter().find(|key| table.has(key) && !table.has("file"));
    let Some((key, _)) = key.zip(["generate", "from"].into_iter().find(|other| table.has(other))) else {
        return Ok(());
    };
    Err(table.bad(key, "says how a file is read, but there is none; leave it out"))
}

/// Materials that a file's names, or the numbers of its types, stand for.
fn names<'a>(table: &SceneTable<'_>, materials: &'a Materials) -> Result<MaterialNames<'a>, SceneError> {
    let bad = |problem: String| table.bad("materials_by_type", problem);
    let by_type = match table.words("materials_by_type")? {
        Some(names) if names.is_empty() => {
            return Err(bad("name the materials of types 1, 2, … in order".to_owned()));
        }
        Some(names) => {
            Some(names.into_iter().map(|name| materials.find(name)).collect::<Result<_, _>>().map_err(bad)?)
        }
        None => None,
    };
    Ok(MaterialNames::Scene { materials, by_type })
}

/// Reads the file that `[particles]` names.
fn read_file(
    table: &SceneTable<'_>,
    file: &str,
    context: &GrainContext<'_>,
    source: &mut SceneSource,
    warnings: &mut Vec<String>,
) -> Result<ReadParticles, SceneError> {
    let choices = FileChoices {
        units: table.word("units", &Units::ALL.map(|units| (units.name(), units)))?,
        step: table.integer("step")?.map(i64::unsigned_abs),
    };
    let mut bytes = source.open_file(table, "file", file)?;
    let read = read_grains(file, &mut bytes, &choices, context);
    // A reader may stop before the end, and what is behind counts for the fingerprint too.
    let rest = std::io::copy(&mut bytes, &mut std::io::sink());
    source.add(file, &bytes.print);
    // What is no text is no table either: that says more than the first cell that is odd.
    let snapshot = read.map_err(|error| match error {
        SceneError::Data { .. } => source.not_text(file).unwrap_or(error),
        error => error,
    })?;
    rest.map_err(|error| table.bad("file", format!("{file} cannot be read to its end: {error}")))?;
    if let (Some(domain), Some(bounds)) = (context.domain, &snapshot.bounds) {
        warnings.extend(other_period(file, domain, bounds));
    }
    let unused = snapshot.unused_quantities();
    if !unused.is_empty() {
        warnings.push(format!("{file}: columns that are not read: {}", unused.join(", ")));
    }
    Ok(snapshot.into())
}

/// Warning of an axis along which the file's box and the domain repeat differently.
fn other_period(file: &str, domain: &Domain, bounds: &SnapshotBox) -> Option<String> {
    Axis::ALL.into_iter().find_map(|axis| {
        let index = axis.index();
        let (length, theirs) = (domain.extent()[index], bounds.max_m[index] - bounds.min_m[index]);
        let is_other = domain.is_periodic(axis)
            && bounds.is_periodic[index]
            && (length - theirs).abs() > SAME_PERIOD * length;
        is_other.then(|| {
            format!(
                "{file}: its box repeats along {axis} every {theirs} m, the domain every {length} m; grains \
                 at the faces have other neighbours than they had"
            )
        })
    })
}
