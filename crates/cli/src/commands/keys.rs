//! Command `keys`: what the keys of a scene take and mean, and what stands in the files of results.

use crate::arguments::KeysOptions;
use crate::failure::Failure;
use crate::print;
use amberfield_scene::{files, keys};

/// Prints one key with those below it, the columns of a file, or a line for each key.
pub(crate) fn keys(options: &KeysOptions) -> Result<(), Failure> {
    let path = options.path.as_deref().unwrap_or_default();
    match keys::section(path).or_else(|| files::section(path)) {
        Some(text) => print::line(format_args!("{}", text.trim_end())),
        None => return Err(Failure::bad_input(keys::advice(path))),
    }
    Ok(())
}
