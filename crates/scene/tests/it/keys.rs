//! Table of keys: its pages, its values, and what a stranger's guess is answered.

use crate::common::{Folder, SCENE};
use amberfield_scene::keys::{self, Form, Key, Without};
use amberfield_scene::{Purpose, check_keys, files, parse_scene};
use std::path::{Path, PathBuf};

/// Variable with which the test of the pages writes them.
const WRITE: &str = "AMBERFIELD_WRITE_KEYS";

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs")
}

#[test]
fn pages_are_those_of_the_table() {
    let pages =
        [("scene.md", keys::page()), ("files.md", files::page()), ("amberfield.schema.json", keys::schema())];
    for (name, text) in pages {
        let path = docs().join(name);
        if std::env::var_os(WRITE).is_some() {
            std::fs::write(&path, &text).unwrap();
        }
        let found = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(found == text, "docs/{name} is stale: run `cargo xtask keys`");
    }
}

/// Every key of scenes and studies with its path.
fn every_key() -> Vec<(String, &'static Key)> {
    fn gather(path: &str, keys: &'static [Key], list: &mut Vec<(String, &'static Key)>) {
        for key in keys {
            let path = format!("{path}.{}", key.name);
            list.push((path.clone(), key));
            gather(&path, key.form.keys(), list);
        }
    }
    let mut list = Vec::new();
    gather("scene", keys::SCENE, &mut list);
    gather("study", keys::STUDY, &mut list);
    list
}

#[test]
fn examples_and_defaults_are_values_that_their_keys_take() {
    for (path, key) in every_key() {
        let default = match key.without {
            Without::Value(value) => value,
            Without::Required | Without::Words(_) => "",
        };
        for value in [key.example, default].into_iter().filter(|value| !value.is_empty()) {
            let one: &'static [Key] = Box::leak(Box::new([*key]));
            let text = format!("{} = {value}", key.name);
            check_keys(&path, &text, one).unwrap_or_else(|error| panic!("{text}: {error}"));
        }
        assert!(
            !key.example.is_empty() || !key.form.keys().is_empty(),
            "{path} has neither an example nor keys below it"
        );
        assert!(key.meaning.ends_with('.') && !key.meaning.contains('\n'), "{path}: {}", key.meaning);
        let unit = key.name.rsplit_once('_').map_or("", |(_, unit)| unit);
        if ["m", "s", "C", "V", "Pa", "eV"].contains(&unit) {
            assert!(key.unit.contains(unit), "{path} is in {:?}", key.unit);
        }
    }
}

/// Scene whose sections all are there, so that every default can be set in it.
fn whole_scene() -> String {
    let file = "file = \"grains.csv\"";
    let generate = "generate = { material = \"glass\", count = 3, radius_m = 1e-4, charge_C = 0.0 }";
    let sections = "[contacts]\n[charge_transfer]\n[gas]\n";
    SCENE
        .replace(file, generate)
        .replace("tolerance = 1e-2", "enable_collision_charge_transfer = true")
        .replace("scale = 1e-3\n", "")
        .replace("formats = [\"vtk\", \"csv\"]\n", "")
        .replace("gravity_m_s2 = [0, 0, -9.81]\n", "")
        .replace("friction = 0.4", "friction = 0.4\nwork_function_eV = 4.3")
        + sections
}

#[test]
fn a_default_that_is_written_down_changes_nothing() {
    let folder = Folder::good();
    let read = |overrides: &[String]| {
        let scene = parse_scene(&whole_scene(), "s", folder.path(), overrides, Purpose::Run)
            .unwrap_or_else(|error| panic!("{overrides:?}: {error}"));
        // The last fields repeat the text of the scene.
        let shown = format!("{scene:?}");
        let (description, _) = shown.split_once(", resolved: ").expect("the field is there");
        description.to_owned()
    };
    let plain = read(&[]);
    let mut tried = 0;
    for (path, key) in keys::all() {
        let Without::Value(value) = key.without else { continue };
        let item = path.replace("[]", ".1");
        // Keys of a flow that is computed, of a solver and of shapes that the scene does not have.
        let alone = [
            "electric_field.enable_collision",
            "solver",
            "gas.model",
            "gas.viscous",
            "gas.saffman",
            "gas.overlap",
            "particles.generate.region.",
            "feeds",
            "outlets",
        ];
        if alone.iter().any(|start| item.starts_with(start)) {
            continue;
        }
        assert_eq!(read(&[format!("{item}={value}")]), plain, "{path} = {value}");
        tried += 1;
    }
    assert!(tried > 30, "{tried} defaults were tried");
}

#[test]
fn a_key_is_found_by_its_path_however_items_are_counted() {
    for path in ["materials.poisson", "materials[0].poisson", "materials.1.poisson"] {
        assert_eq!(keys::find(path).expect("it is there").name, "poisson");
    }
    assert!(keys::find("materials.nothing").is_none());
    assert!(matches!(keys::find("walls").expect("it is there").form, Form::Tables(_)));
    let text = keys::section("domain.boundary.x").expect("it is there");
    assert!(text.contains("potential_V") && text.contains("periodic"), "{text}");
}

/// Guesses of strangers, in the text or as an override, and what the answer must tell.
const GUESSES: &[(&str, &str, &[&str])] = &[
    ("x = \"periodic\"", "x = \"potential\"", &["x = { potential_V = 1000.0 }"]),
    ("x = \"periodic\"", "x = { potential = 5.0 }", &["potential_V", "write potential_V = 1000.0"]),
    ("x = \"periodic\"", "x = \"conductor\"", &["\"grounded\""]),
    ("x = \"periodic\"", "x = \"cyclic\"", &["\"periodic\""]),
    ("x = \"periodic\"", "x = 1000.0", &["a table { potential_V", "\"grounded\"", "got a number"]),
    ("poisson = 0.3", "poissons_ratio = 0.3", &["materials[1].poisson is", "poisson = 0.25"]),
    ("work_function_eV = 4.5", "work_function_J = 7e-19", &["work_function_eV", "1.602e-19 J"]),
    ("young_Pa = 1e9", "youngs_modulus = 1e9", &["young_Pa"]),
    ("gravity_m_s2 = [0, 0, -9.81]", "gravity_m_s2 = 9.81", &["[x, y, z]", "[0.0, 0.0, -9.81]"]),
    ("gravity_m_s2 = [0, 0, -9.81]", "g = [0, 0, -9.81]", &["time.gravity_m_s2"]),
    ("step_s = 1e-6", "dt = 1e-6", &["time.step_s"]),
    ("tolerance = 1e-2", "accuracy = 1e-2", &["electric_field.tolerance"]),
    ("tolerance = 1e-2", "end_s = 1.0", &["time.end_s"]),
    ("tolerance = 1e-2", "charging = true", &["enable_collision_charge_transfer"]),
    ("scale = 1e-3", "units = \"mm\"", &["walls[1].scale", "1e-3"]),
    (
        "file = \"grains.csv\"",
        "generate = { material = \"glass\", count = 3, diameter_m = 1e-4 }",
        &["radius_m", "half the diameter"],
    ),
    (
        "file = \"grains.csv\"",
        "generate = { material = \"glass\", count = 3, radius_m = { lognormal = 1 } }",
        &["log_normal", "median"],
    ),
    (
        "file = \"grains.csv\"",
        "generate = { material = \"glass\", count = 3, radius_m = 1e-4, velocity = [0, 0, 1] }",
        &["particles.generate.velocity_m_s"],
    ),
    (
        "file = \"grains.csv\"",
        "generate = { material = \"glass\", count = 3, radius_m = 1e-4, region = { cylinder = { from_m = \
         [0, 0, 0], to_m = [0, 0, 0.01], radius_m = 0.01 } } }",
        &["base_m", "top_m"],
    ),
];

#[test]
fn a_strangers_guess_is_answered_by_what_it_means() {
    for (from, to, words) in GUESSES {
        let folder = Folder::good();
        assert!(SCENE.contains(from), "{from}");
        folder.write("scene.toml", SCENE.replacen(from, to, 1));
        let said = folder.refusal(&[]);
        for word in *words {
            assert!(said.contains(word), "{to}: {said}");
        }
    }
}

#[test]
fn items_of_lists_are_counted_with_dots_or_brackets() {
    for path in ["materials.0.friction", "materials[0].friction"] {
        let scene = Folder::good().read(&[&format!("{path}=0.7")]).unwrap();
        assert_eq!(scene.materials[0].friction, 0.7);
    }
}
