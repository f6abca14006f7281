//! Command `new`: a small scene with comments, to start from.

use crate::arguments::NewOptions;
use crate::failure::Failure;
use crate::print::line;
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

/// Scene to start from.
struct Template {
    name: &'static str,
    /// Question that it asks, in a line.
    question: &'static str,
    /// Files by their names.
    files: &'static [(&'static str, &'static str)],
}

/// File of a template.
macro_rules! template {
    ($name:literal) => {
        ("scene.toml", include_str!(concat!("../../templates/", $name, ".toml")))
    };
}

/// File of the case of a fluidised bed, which is that of `cases`.
macro_rules! case {
    ($name:literal) => {
        (
            concat!("foam/", $name),
            include_str!(concat!("../../../../cases/fluidised-charged-bed/foam/", $name)),
        )
    };
}

const TEMPLATES: &[Template] = &[
    Template {
        name: "bed",
        question: "charged beads settle between grounded plates",
        files: &[template!("bed")],
    },
    Template {
        name: "separator",
        question: "grains of both signs fall between two electrodes",
        files: &[template!("separator")],
    },
    Template {
        name: "chute",
        question: "grains slide down a metal chute and charge on it",
        files: &[template!("chute")],
    },
    Template {
        name: "fluidised-bed",
        question: "air fluidises a charged bed; over OpenFOAM",
        files: &[
            template!("fluidised-bed"),
            case!("0/U"),
            case!("0/p"),
            case!("0/phiE"),
            case!("constant/transportProperties"),
            case!("constant/turbulenceProperties"),
            case!("system/blockMeshDict"),
            case!("system/controlDict"),
            case!("system/fvSchemes"),
            case!("system/fvSolution"),
        ],
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
    let file = match fs::File::create_new(path) {
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {
            return Err(Failure::bad_input(format!(
                "{}: is there already, and is left as it is; name another folder with --out",
                path.display()
            )));
        }
        file => file.map_err(|error| cannot(&error))?,
    };
    std::io::Write::write_all(&mut &file, text.as_bytes()).map_err(|error| cannot(&error))
}
