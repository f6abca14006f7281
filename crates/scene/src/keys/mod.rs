//! Table of all keys of a scene: what each one takes, what holds without it, and what it is for.
//!
//! Readers check by this table, and messages, the terminal (`amberfield keys`), `docs/scene.md` and the JSON
//! Schema come from it.

mod advice;
mod charge_transfer;
mod contacts;
mod course;
mod domain;
mod electric_field;
mod feeds;
mod form;
mod gas;
mod key;
mod materials;
mod outlets;
mod output;
mod page;
mod pairs;
mod particles;
mod schema;
mod solver;
mod study;
mod time;
mod walls;

pub use advice::advice;
pub(crate) use advice::{unknown_key, unknown_word};
pub use form::Form;
pub use key::{Key, Without};
pub use page::{page, section};
pub use schema::schema;

/// Keys of a scene file.
pub static SCENE: &[Key] = &[
    Key::new("domain", Form::Table(domain::KEYS), "Box of the scene and the conditions on its six faces.")
        .without("open space; a run needs it"),
    Key::new("materials", Form::Tables(materials::KEYS), "Materials of grains and walls.")
        .without("none; a run needs one"),
    Key::new("pairs", Form::Tables(pairs::KEYS), "Values of two materials, in the place of mixed ones.")
        .without("each value is mixed from the two materials"),
    Key::new("particles", Form::Table(particles::KEYS), "Grains at the start.")
        .without("none; there must be [[feeds]] then"),
    Key::new("walls", Form::Tables(walls::KEYS), "Walls that grains touch.").without("none"),
    Key::new("contacts", Form::Table(contacts::KEYS), "Models of contacts.").without("the defaults below"),
    Key::new("time", Form::Table(time::KEYS), "Time step, end and gravity of a run.")
        .without("no run, but a field can be computed"),
    Key::new("electric_field", Form::Table(electric_field::KEYS), "Electric field of the grains' charges.")
        .without("no field"),
    Key::new("charge_transfer", Form::Table(charge_transfer::KEYS), "Refinements of charging by contact.")
        .without("the defaults below"),
    Key::new("solver", Form::Table(solver::KEYS), "OpenFOAM case that computes the far field or a flow.")
        .without("the internal grid computes the field"),
    Key::new("gas", Form::Table(gas::KEYS), "Gas around the grains.").without("no gas"),
    Key::new("feeds", Form::Tables(feeds::KEYS), "Grains that come while a run goes on.").without("none"),
    Key::new("outlets", Form::Tables(outlets::KEYS), "Places at which grains leave and are counted.")
        .without("none")
        .also(&["bins", "sinks", "exits", "collectors"]),
    Key::new("output", Form::Table(output::KEYS), "What a run writes, and how often.")
        .without("the defaults below"),
];

/// Keys of a study.
pub static STUDY: &[Key] = study::KEYS;

/// Key of a scene at a path such as `domain.boundary.x` or `walls[0].stl`; the number of an item does not
/// matter.
#[must_use]
pub fn find(path: &str) -> Option<&'static Key> {
    let mut keys = SCENE;
    let mut found = None;
    for part in parts(path) {
        let key = keys.iter().find(|key| key.name == part)?;
        keys = key.form.keys();
        found = Some(key);
    }
    found
}

/// Names along a path, without the numbers of items.
fn parts(path: &str) -> impl Iterator<Item = &str> {
    path.split(['.', '[', ']']).filter(|part| !part.is_empty() && part.parse::<usize>().is_err())
}

/// Every key of a scene with its path, tables before what is in them.
pub fn all() -> impl Iterator<Item = (String, &'static Key)> {
    let mut list = Vec::new();
    gather("", SCENE, &mut list);
    list.into_iter()
}

fn gather(before: &str, keys: &'static [Key], list: &mut Vec<(String, &'static Key)>) {
    for key in keys {
        let path = if before.is_empty() { key.name.to_owned() } else { format!("{before}.{}", key.name) };
        let below = if key.form.is_list() { format!("{path}[]") } else { path.clone() };
        list.push((path, key));
        gather(&below, key.form.keys(), list);
    }
}
