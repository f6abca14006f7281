//! Parts of a case, one for each process of a parallel solver.
//!
//! They count for a fingerprint of all that they were made from, written once they are there: mesh, fields,
//! what these include, the dictionary, the number of ranks. Times of files do not matter.

use super::contents::CaseContents;
use super::start_time::times;
use super::tools::{Stop, run_tool, tool_output};
use super::unusable;
use super::workplace::{Workplace, write_mark};
use crate::CouplingError;
use std::ffi::{OsStr, OsString};
use std::path::PathBuf;

/// Dictionary by which a case's author wants it to be cut. It is read, never written.
const OF_USER: &str = "system/decomposeParDict";
/// Dictionary of ours, there while the parts were cut by it.
const OURS: &str = "decomposeParDict.amberfield";
/// Fingerprint of what the parts were made from.
const MARK: &str = "parts.fingerprint";
/// Beginning of the names of parts: `processor0`, or `processors4` in one file each.
const PART: &str = "processor";
/// Words of OpenFOAM's errors about a method that was not built: of a name that is not known, and of a
/// library that only stands in for another.
const LACKING: [&str; 2] = ["Unknown decompositionMethod", "stub library"];
/// Words before the corners of the mesh's bounding box in what checkMesh prints.
const BOUNDING_BOX: &str = "bounding box";

/// Cuts a case into as many parts as there are ranks where that is due, by its own dictionary if that works.
/// Returns our dictionary if the parts are by it; the solver has to be told, since it looks into one.
pub(super) fn provide_parts(
    place: &Workplace,
    ranks: u32,
    stop: Stop,
) -> Result<Option<PathBuf>, CouplingError> {
    let ours = place.folder().join(OURS);
    let print = fingerprint(place, ranks)?;
    if !place.has_mark(MARK, print) || parts(place).is_empty() {
        place.remove_mark(MARK);
        clear(place)?;
        tracing::info!("cutting {} into {ranks} parts with decomposePar", place.case().display());
        match cut_by_dictionary_of_user(place, ranks, stop)? {
            Outcome::Cut => {
                // None is there where the user's has always been followed.
                let _ = std::fs::remove_file(&ours);
            }
            Outcome::NoDictionary => drop(cut_by_ours(place, ranks, stop)?),
            Outcome::Unfit(why) => {
                let [x, y, z] = cut_by_ours(place, ranks, stop)?;
                tracing::warn!(
                    "{OF_USER} of {} {why}; the case is cut into {x} x {y} x {z} parts instead, and the file \
                     stays as it is",
                    place.case().display()
                );
            }
        }
        write_mark(place, MARK, print)?;
    }
    Ok(ours.is_file().then(|| place.path().join(OURS)))
}

/// Fingerprint of all that parts for so many ranks are made from.
fn fingerprint(place: &Workplace, ranks: u32) -> Result<u64, CouplingError> {
    let mut print = amberfield_core::Fingerprint::new();
    print.add(&ranks.to_le_bytes());
    print.add(place.start_time().as_bytes());
    for contents in
        [CaseContents::of_fields_and_mesh(place.case())?, CaseContents::of_file(place.case(), OF_USER)?]
    {
        print.add(&contents.fingerprint().to_le_bytes());
    }
    Ok(print.value())
}

/// Folders of the parts that are there.
fn parts(place: &Workplace) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(place.folder()).into_iter().flatten().flatten();
    let is_part = |path: &PathBuf| {
        path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(PART)) && path.is_dir()
    };
    entries.map(|entry| entry.path()).filter(is_part).collect()
}

/// Removes parts, or sets them aside where a solver has written results into them.
fn clear(place: &Workplace) -> Result<(), CouplingError> {
    let parts = parts(place);
    let mut has_results = false;
    for part in &parts {
        let is_result = |name: &str| !place.times().iter().any(|time| time.name == name);
        has_results |= times(part)?.iter().any(|time| is_result(&time.name));
    }
    if has_results {
        let free = |number: &u32| !place.folder().join(format!("earlier-{number}")).exists();
        let number = (1..).find(free).expect("there are enough numbers");
        let aside = place.folder().join(format!("earlier-{number}"));
        let moved = std::fs::create_dir(&aside).and_then(|()| {
            parts.iter().try_for_each(|part| {
                let name = part.file_name().unwrap_or(OsStr::new(PART));
                std::fs::rename(part, aside.join(name))
            })
        });
        moved.map_err(|error| unusable(&aside, format!("cannot take earlier results: {error}")))?;
        tracing::info!("earlier parts of the case, with their results, are in {}", aside.display());
        return Ok(());
    }
    parts.iter().try_for_each(|part| {
        std::fs::remove_dir_all(part).map_err(|error| unusable(part, format!("cannot be removed: {error}")))
    })
}

/// Outcome of a cut by the dictionary of a case's author.
enum Outcome {
    Cut,
    NoDictionary,
    /// The reason why it cannot be followed, to be read behind the dictionary's name.
    Unfit(String),
}

fn cut_by_dictionary_of_user(place: &Workplace, ranks: u32, stop: Stop) -> Result<Outcome, CouplingError> {
    if !place.case().join(OF_USER).is_file() {
        return Ok(Outcome::NoDictionary);
    }
    match number_of_parts(place) {
        Some(number) if number != ranks => {
            return Ok(Outcome::Unfit(format!("asks for {number} parts, and the scene for {ranks} ranks")));
        }
        // What is wrong with a dictionary without a number decomposePar says.
        _ => {}
    }
    match cut(place, &[], stop) {
        Ok(()) => Ok(Outcome::Cut),
        Err(error) if LACKING.iter().any(|words| error.to_string().contains(words)) => {
            clear(place)?;
            Ok(Outcome::Unfit(format!("asks for a method that this OpenFOAM lacks ({error})")))
        }
        Err(error) => Err(error),
    }
}

/// Number of parts for which a dictionary asks, as OpenFOAM reads it: it may include other files.
fn number_of_parts(place: &Workplace) -> Option<u32> {
    let dictionary = place.path().join(OF_USER);
    let options =
        [dictionary.as_os_str(), "-entry".as_ref(), "numberOfSubdomains".as_ref(), "-value".as_ref()];
    let printed = tool_output("foamDictionary", place.path(), &options)?;
    // Warnings may stand before it.
    printed.lines().last()?.trim().parse().ok()
}

/// Cuts a case by a dictionary of ours. Returns the number of parts along each axis.
fn cut_by_ours(place: &Workplace, ranks: u32, stop: Stop) -> Result<[u32; 3], CouplingError> {
    let counts @ [x, y, z] = parts_along_axes(ranks, extent(place).unwrap_or([1.0, 0.0, 0.0]));
    let text = format!(
        "FoamFile {{ version 2.0; format ascii; class dictionary; object decomposeParDict; }}\n\
         numberOfSubdomains {ranks};\nmethod hierarchical;\n\
         hierarchicalCoeffs {{ n ({x} {y} {z}); delta 0.001; order xyz; }}\n"
    );
    let ours = place.folder().join(OURS);
    std::fs::write(&ours, text).map_err(|error| unusable(&ours, format!("cannot be written: {error}")))?;
    cut(place, &["-decomposeParDict".into(), place.path().join(OURS).into()], stop)?;
    Ok(counts)
}

/// Cuts the mesh, and the fields of the times up to the start.
fn cut(place: &Workplace, options: &[OsString], stop: Stop) -> Result<(), CouplingError> {
    let names: Vec<&str> = place.times().iter().map(|time| time.name.as_str()).collect();
    let mut all: Vec<OsString> = vec!["-time".into(), names.join(",").into()];
    all.extend(options.iter().cloned());
    let outcome = run_tool("decomposePar", place.path(), &place.log("decomposePar"), &all, stop);
    if outcome.is_err() {
        // Nothing of a failed cut counts.
        clear(place)?;
    }
    outcome
}

/// Edges of the mesh's bounding box [m], as OpenFOAM says; `None` where it does not.
fn extent(place: &Workplace) -> Option<[f64; 3]> {
    let options = ["-constant", "-noTopology", "-case"].map(OsStr::new);
    let said = tool_output("checkMesh", place.path(), &[&options[..], &[place.path().as_os_str()]].concat())?;
    let (_, corners) = said.lines().find_map(|line| line.split_once(BOUNDING_BOX))?;
    let numbers: Vec<f64> = corners
        .split(|c: char| c.is_whitespace() || "()".contains(c))
        .filter_map(|word| word.parse().ok())
        .collect();
    let [x0, y0, z0, x1, y1, z1] = numbers[..] else { return None };
    Some([x1 - x0, y1 - y0, z1 - z0])
}

/// Numbers of parts along the axes whose product is `ranks`, such that parts of a box with these edges are
/// as near to cubes as the factors of `ranks` allow.
fn parts_along_axes(ranks: u32, edges: [f64; 3]) -> [u32; 3] {
    let (mut rest, mut factors) = (ranks, Vec::new());
    let mut factor = 2;
    while rest > 1 {
        while rest.is_multiple_of(factor) {
            factors.push(factor);
            rest /= factor;
        }
        factor += 1;
    }
    let mut counts = [1; 3];
    // Large factors first: small ones even out what they leave.
    for factor in factors.into_iter().rev() {
        let length = |axis: &usize| edges[*axis] / f64::from(counts[*axis]);
        // Of equal edges the first is cut.
        let longest = (0..3).rev().max_by(|a, b| length(a).total_cmp(&length(b))).expect("three axes");
        counts[longest] *= factor;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::parts_along_axes;

    #[test]
    fn parts_are_cut_across_the_longest_edges() {
        for (ranks, edges, expected) in [
            (1, [1.0; 3], [1, 1, 1]),
            (2, [1.0; 3], [2, 1, 1]),
            (4, [1.0; 3], [2, 2, 1]),
            (8, [1.0; 3], [2, 2, 2]),
            (12, [1.0; 3], [3, 2, 2]),
            (5, [1.0, 3.0, 2.0], [1, 5, 1]),
            (6, [0.1, 0.1, 9.0], [1, 1, 6]),
            (4, [1.0, 0.0, 0.0], [4, 1, 1]),
        ] {
            assert_eq!(parts_along_axes(ranks, edges), expected, "{ranks} ranks, {edges:?}");
        }
    }
}
