//! Section `[particles]`.

use crate::SceneError;
use crate::generate::{GenerateContext, generate};
use crate::materials::Materials;
use crate::particles::{CsvContext, ReadParticles, read_particles};
use crate::source::SceneSource;
use crate::table::SceneTable;
use amberfield_core::{Domain, OnExit, Wall};

/// Content of `[particles]`.
#[derive(Debug)]
pub(super) struct ParticlesSection {
    pub(super) read: ReadParticles,
    /// Treatment of grains that leave the domain.
    pub(super) on_exit: OnExit,
    /// Switch for grains that overlap at the start.
    pub(super) allow_overlap: bool,
}

/// Reads `[particles]`, with the file that it names or the generator that it describes.
pub(super) fn read_section(
    document: &SceneTable<'_>,
    domain: Option<&Domain>,
    materials: &Materials,
    walls: &[Wall],
    allow_points: bool,
    source: &mut SceneSource,
) -> Result<ParticlesSection, SceneError> {
    let table = document.table("particles")?;
    let table = document.need(
        table,
        "particles",
        "add [particles] with file = \"grains.csv\" or generate = { … }",
    )?;
    let on_exit =
        table.word("on_exit", &[("stop", OnExit::Stop), ("delete", OnExit::Delete)])?.unwrap_or_default();
    let allow_overlap = table.boolean("allow_overlap")?.unwrap_or(false);
    let read = match (table.text("file")?, table.table("generate")?) {
        (Some(_), Some(_)) => {
            return Err(table.bad("generate", "file is given too; give exactly one of file, generate"));
        }
        (None, None) => return Err(table.missing("file", "give file = \"grains.csv\" or generate = { … }")),
        (Some(file), None) => {
            let mut bytes = source.open_file(&table, "file", file)?;
            let read = read_particles(file, &mut bytes, &CsvContext { domain, materials, allow_points });
            source.add(file, &bytes.print);
            // What is no text is no table either: that says more than the first cell that is odd.
            read.map_err(|error| source.not_text(file).unwrap_or(error))?
        }
        (None, Some(generator)) => {
            let Some(domain) = domain else {
                return Err(table.bad("generate", "a generator needs [domain]; add it"));
            };
            let mut context = GenerateContext { domain, materials, walls, source };
            generate(&generator, &mut context)?
        }
    };
    Ok(ParticlesSection { read, on_exit, allow_overlap })
}
