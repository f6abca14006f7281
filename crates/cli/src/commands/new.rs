//! Command `new`: a small scene with comments, to start from.

use crate::arguments::NewOptions;
use crate::failure::Failure;
use crate::print::line;
use std::fs;
use std::path::Path;

/// Scene to start from.
struct Template {
    name: &'static str,
    /// Question that it asks, in a line.
    question: &'static str,
    /// Files by their names.
    files: &'static [(&'static str, &'static str)],
}

macro_rules! files {
    ($folder:literal: $($name:literal),+ $(,)?) => {
        &[$(($name, include_str!(concat!("../../templates/", $folder, "/", $name)))),+]
    };
}

const TEMPLATES: &[Template] = &[
    Template {
        name: "bed",
        question: "charged beads settle between grounded plates",
        files: files!("bed": "scene.toml"),
    },
    Template {
        name: "separator",
        question: "grains of both signs fall between two electrodes",
        files: files!("separator": "scene.toml"),
    },
    Template {
        name: "chute",
        question: "grains slide down a metal chute and charge on it",
        files: files!("chute": "scene.toml"),
    },
    Template {
        name: "fluidised-bed",
        question: "air fluidises a charged bed; over OpenFOAM",
        files: files!("fluidised-bed": "scene.toml", "foam/0/U", "foam/0/p", "foam/0/phiE",
            "foam/constant/transportProperties", "foam/constant/turbulenceProperties",
            "foam/system/blockMeshDict", "foam/system/controlDict", "foam/system/fvSchemes",
            "foam/system/fvSolution"),
    },
];

/// Writes the files of a scene into a new folder, or lists the scenes.
pub(crate) fn new(options: &NewOptions) -> Result<(), Failure> {
    let Some(name) = &options.name else {
        for Template { name, question, .. } in TEMPLATES {
            line(format_args!("{name:<16} {question}"));
        }
        return Ok(());
    };
    let Some(template) = TEMPLATES.iter().find(|template| template.name == name) else {
        let names: Vec<&str> = TEMPLATES.iter().map(|template| template.name).collect();
        return Err(Failure::bad_input(format!("no scene {name}; give one of {}", names.join(", "))));
    };
    let folder = options.out.as_deref().unwrap_or(Path::new(template.name));
    for (file, text) in template.files {
        write(&folder.join(file), text)?;
    }
    line(format_args!("{}: amberfield run {0}", folder.join("scene.toml").display()));
    Ok(())
}

/// Writes a file that is not there yet.
fn write(path: &Path, text: &str) -> Result<(), Failure> {
    let cannot = |error: &std::io::Error| {
        Failure::bad_input(format!(
            "{}: cannot be written: {error}; name another folder with --out",
            path.display()
        ))
    };
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(|error| cannot(&error))?;
    }
    let file = fs::File::create_new(path).map_err(|error| cannot(&error))?;
    std::io::Write::write_all(&mut &file, text.as_bytes()).map_err(|error| cannot(&error))
}
