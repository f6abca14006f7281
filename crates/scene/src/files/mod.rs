//! Table of all files that the program writes: columns, arrays and keys with their units and meanings.
//!
//! Writers take their headings from it; `docs/files.md` and the terminal (`amberfield keys FILE`) show it.

mod column;
mod field;
mod file;
mod history;
mod page;
mod run;
mod study;

pub use column::{Column, When, in_heading};
pub use field::{FIELD, FIELD_REPORT, TUNE};
pub use file::{FileTable, Form};
pub use history::HISTORY;
pub use page::{page, section};
pub use run::{
    CHARGE_HISTOGRAM, ELECTRIC_FORCE, EXITS, GRAINS_CSV, GRAINS_VTU, LOG, OUTLETS_GRAINS, SUMMARY, TUNING,
    WALL_CHARGE, WALL_FORCES, WALL_SURFACES,
};
pub use study::{ENERGIES, EXTREMES, MOTIONS, POINTS};

/// Files that the commands write, with a headline for each command.
pub static FILES: &[(&str, &[&FileTable])] = &[
    ("amberfield run", run::FILES),
    ("amberfield field and tune", field::FILES),
    ("amberfield study", study::FILES),
];

/// Table of the file at a path such as `out/particles/grains_000000000100.vtu`; folders before it do not
/// matter. Where several names fit, as those of a study do, the longest counts.
#[must_use]
pub fn find(path: &str) -> Option<&'static FileTable> {
    let files = FILES.iter().flat_map(|(_, files)| files.iter()).copied().filter(|file| file.is_at(path));
    files.max_by_key(|file| file.path.len())
}
