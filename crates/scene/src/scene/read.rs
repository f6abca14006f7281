//! Reader from a scene file to its description.

use super::description::{Purpose, Scene};
use super::domain::read_domain;
use super::electric_field::read_electric_field;
use super::feeds::read_feeds;
use super::gas::read_gas;
use super::input::SceneInput;
use super::key_places::KeyPlaces;
use super::others::{read_charge_transfer, read_contacts, read_output, read_solver};
use super::outlets::read_outlets;
use super::pairs::read_pairs;
use super::particles::read_section;
use super::physics::Physics;
use super::time::read_time;
use super::together::{check_lists, check_reach, check_sections, check_together};
use super::wall_field::Surroundings;
use super::walls::read_walls;
use crate::SceneError;
use crate::error::Problems;
use crate::keys::SCENE;
use crate::materials::{Materials, read_materials};
use crate::source::{SceneSource, read_text};
use crate::table::{SceneTable, drop_empty_lists};
use crate::tree::{Entries, Node, Origin, Value, apply_overrides, parse_document};
use amberfield_core::{Domain, FieldSettings};
use std::path::Path;

/// Reads a scene file, applies `KEY=VALUE` overrides and reads the files that it names.
///
/// # Errors
/// All problems of the scene and its files that can be found independently of each other.
pub fn read_scene(path: &Path, overrides: &[String], purpose: Purpose) -> Result<Scene, SceneError> {
    SceneInput::File(path.to_path_buf()).read(overrides, purpose, None)
}

/// Reads a scene from its text. `file` is its name in messages, `folder` the folder of the files that it
/// names.
///
/// # Errors
/// The errors of [`read_scene`].
pub fn parse_scene(
    text: &str,
    file: &str,
    folder: &Path,
    overrides: &[String],
    purpose: Purpose,
) -> Result<Scene, SceneError> {
    parse(text, &Origin::File(file.into()), folder, overrides, (purpose, None))
}

/// Parts of a scene that give names and a box to the grains of its frames.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneOutline {
    /// Names of the materials.
    pub materials: Vec<String>,
    /// Box; `None` where the mesh of a solver gives it.
    pub domain: Option<Domain>,
}

/// Reads the names of the materials and the box of a scene file, and nothing else of it.
///
/// # Errors
/// Files that are no scene, bad materials and bad boxes.
pub fn read_outline(path: &Path) -> Result<SceneOutline, SceneError> {
    let text = read_text(path)?;
    let origin = Origin::File(path.display().to_string().into());
    let entries = parse_document(&origin, &text)?;
    let document = SceneTable::document(&entries, origin.line(0), SCENE)?;
    let materials = read_materials(&document)?.into_iter().map(|material| material.name).collect();
    let mut source = SceneSource::new(path.parent().unwrap_or(Path::new("")), None);
    Ok(SceneOutline { materials, domain: read_domain(&document, &mut source)? })
}

/// Reads the box and the settings of the electric field from a text that a program made: the sections
/// `[domain]` and `[electric_field]`, for charges that it has in memory.
///
/// # Errors
/// All problems of the two sections, and what they lack.
pub fn parse_field_settings(text: &str) -> Result<(Domain, FieldSettings), SceneError> {
    let entries = parse_document(&Origin::Program, text)?;
    let document = SceneTable::document(&entries, Origin::Program.line(0), SCENE)?;
    let mut problems = Problems::default();
    let mut source = SceneSource::new(Path::new(""), None);
    let domain = problems.keep(read_domain(&document, &mut source));
    let field = problems.keep(read_electric_field(&document, &mut source));
    problems.finish()?;
    let (Some(Some(domain)), Some(Some(field))) = (domain, field) else {
        return Err(document.missing("domain", "give the box and the settings of the field"));
    };
    check_reach(&document, &domain, &field.field)?;
    Ok((domain, field.field))
}

/// Reads a scene from its text, for a purpose, with the mesh of a case that has none of its own.
pub(super) fn parse(
    text: &str,
    origin: &Origin,
    folder: &Path,
    overrides: &[String],
    (purpose, mesh): (Purpose, Option<&Path>),
) -> Result<Scene, SceneError> {
    let mut entries = parse_document(origin, text.strip_prefix('\u{feff}').unwrap_or(text))?;
    apply_overrides(&mut entries, overrides)?;
    drop_empty_lists(&mut entries, SCENE);
    let document = SceneTable::document(&entries, origin.line(0), SCENE)?;
    let mut source = SceneSource::new(folder, mesh);
    let mut scene = read_sections(&document, &mut source, purpose)?;
    scene.physics = Physics::new(&entries, &source);
    scene.places = KeyPlaces::new(&entries);
    if let Some(filled) = &mut scene.filled {
        filled.is_same = scene.physics.goes_on_from(&filled.physics, filled.print);
        // A folder stands for its newest checkpoint, which may be another one later.
        let checkpoint = filled.checkpoint.to_string_lossy().into_owned();
        change_texts(&mut entries, FROM, &|_| checkpoint.clone());
    }
    scene.resolved = resolved(&entries, folder);
    Ok(scene)
}

/// Reads all sections in the order in which they need each other.
fn read_sections(
    document: &SceneTable<'_>,
    source: &mut SceneSource,
    purpose: Purpose,
) -> Result<Scene, SceneError> {
    check_lists(document)?;
    let mut problems = Problems::default();
    let motion = purpose == Purpose::Run || (purpose == Purpose::Explain && document.has("time"));
    let sections = problems.keep(check_sections(document, motion, purpose));
    let domain = problems.keep(read_domain(document, source));
    let list = problems.keep(read_materials(document));
    let contacts = problems.keep(read_contacts(document));
    let field = problems.keep(read_electric_field(document, source));
    let charge_transfer = problems.keep(read_charge_transfer(document));
    let solver = problems.keep(read_solver(document, source));
    let gas = problems.keep(read_gas(document));
    let outlets = problems.keep(read_outlets(document));
    let output = problems.keep(read_output(document));
    let time_alone = problems.keep(read_time(document, Default::default(), false));
    // The sections below read files and place grains. With a bad section above they would only repeat its
    // problems.
    let (
        Some(domain),
        Some(list),
        Some(contacts),
        Some(mut electric_field),
        Some(charge_transfer),
        Some(solver),
        Some(gas),
        Some(outlets),
        Some(output),
        Some(_),
        Some(()),
    ) = (domain, list, contacts, field, charge_transfer, solver, gas, outlets, output, time_alone, sections)
    else {
        return Err(problems.finish().expect_err("a section was refused"));
    };
    let materials = Materials { ignored: list.is_empty(), list };
    let pairs = read_pairs(document, &materials)?;
    let around =
        Surroundings { solver: solver.as_ref(), domain: domain.as_ref(), field: electric_field.as_ref() };
    let walls = read_walls(document, &materials, around, source)?;
    if let Some(settings) = &mut electric_field {
        settings.field.conductors = walls.conductors;
    }
    let mut section = read_section(document, domain.as_ref(), &materials, &walls.walls, !motion, source)?;
    let time = read_time(document, section.on_exit, section.allow_overlap)?;
    let of_motion = time.as_ref().filter(|_| motion);
    let fed = read_feeds(document, of_motion, &materials, &mut section.read, source)?;
    let has_charge = section.read.has_charge || fed.has_charge;
    let mut scene = Scene {
        title: "scene".to_owned(),
        domain,
        materials: materials.list,
        rolling_model: contacts.rolling,
        cohesion: contacts.cohesion,
        pairs,
        walls: walls.walls,
        wall_patches: walls.patches,
        particles: section.read.particles,
        filled: section.filled,
        feeds: fed.feeds,
        outlets,
        groups: section.read.groups,
        time,
        electric_field,
        charge_transfer,
        solver,
        gas,
        output,
        warnings: [walls.warnings, section.warnings].concat(),
        resolved: String::new(),
        physics: Physics::default(),
        places: KeyPlaces::default(),
    };
    check_together(document, &mut scene, has_charge)?;
    Ok(scene)
}

/// Key of the run from whose checkpoint grains are.
const FROM: &[&str] = &["particles", "from"];
/// Keys whose values are paths relative to the scene's folder.
const PATHS: [&[&str]; 9] = [
    &["particles", "file"],
    FROM,
    &["particles", "generate", "charge_C", "from_file"],
    &["solver", "openfoam_case"],
    &["walls", "*", "stl"],
    &["feeds", "*", "region", "stl"],
    &["walls", "*", "motion", "*", "table"],
    &["domain", "boundary", "*", "potential_V", "table"],
    &["electric_field", "external_field_V_m", "table"],
];

/// Text of the scene as TOML, with absolute paths of files so that it can be run from any folder.
fn resolved(entries: &Entries, folder: &Path) -> String {
    let mut entries = entries.clone();
    for path in PATHS {
        change_texts(&mut entries, path, &|name| {
            std::path::absolute(folder.join(name))
                .map_or_else(|_| name.to_owned(), |path| path.to_string_lossy().into_owned())
        });
    }
    let root = Node { value: Value::Table(entries), place: Origin::Program.line(0) };
    match root.to_toml() {
        toml::Value::Table(table) => toml::to_string(&table).unwrap_or_default(),
        _ => String::new(),
    }
}

/// Changes each text at a path of keys; `*` stands for each item of an array, or each key of a table.
fn change_texts(entries: &mut Entries, path: &[&str], change: &dyn Fn(&str) -> String) {
    let Some((first, rest)) = path.split_first() else { return };
    for (_, node) in entries.iter_mut().filter(|(key, _)| key == first || *first == "*") {
        match &mut node.value {
            Value::Text(text) if rest.is_empty() => *text = change(text),
            Value::Table(inner) => change_texts(inner, rest, change),
            Value::Array(items) if rest.first() == Some(&"*") => {
                for item in items {
                    if let Value::Table(inner) = &mut item.value {
                        change_texts(inner, &rest[1..], change);
                    }
                }
            }
            _ => {}
        }
    }
}
