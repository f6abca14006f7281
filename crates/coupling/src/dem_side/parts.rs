//! Parts of a case, one for each process of a parallel solver.

use super::tools::{run_tool, tool_output};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Dictionary by which a case's author wants it to be cut. It is read, never written.
const OF_USER: &str = "system/decomposeParDict";
/// Dictionary of ours, there while the parts were cut by it.
const OURS: &str = "system/decomposeParDict.amberfield";
/// Words of OpenFOAM's errors about a method that was not built: of a name that is not known, and of a
/// library that only stands in for another.
const LACKING: [&str; 2] = ["Unknown decompositionMethod", "stub library"];
/// Words before the corners of the mesh's bounding box in what checkMesh prints.
const BOUNDING_BOX: &str = "bounding box";

/// Cuts a case into as many parts as there are ranks where that is due, by its own dictionary if that works.
/// Returns our dictionary if the parts are by it; the solver has to be told, since it looks into one.
pub(super) fn provide_parts(case: &Path, ranks: u32) -> Result<Option<PathBuf>, String> {
    let ours = case.join(OURS);
    if !are_current(case, ranks) {
        match cut_by_dictionary_of_user(case, ranks)? {
            Outcome::Cut => {
                // None is there where the user's has always been followed.
                let _ = std::fs::remove_file(&ours);
            }
            Outcome::NoDictionary => drop(cut_by_ours(case, ranks)?),
            Outcome::Unfit(why) => {
                let [x, y, z] = cut_by_ours(case, ranks)?;
                tracing::warn!(
                    "{OF_USER} of {} {why}; the case is cut into {x} x {y} x {z} parts instead, and the file \
                     stays as it is",
                    case.display()
                );
            }
        }
    }
    Ok(ours.is_file().then_some(ours))
}

/// Whether there are as many parts as ranks, newer than what they are made from.
fn are_current(case: &Path, ranks: u32) -> bool {
    let time_of =
        |path: PathBuf| -> Option<SystemTime> { path.metadata().and_then(|data| data.modified()).ok() };
    let part = |rank: u32| time_of(case.join(format!("processor{rank}/constant/polyMesh/points")));
    let newest = ["constant/polyMesh/points", "0/phiE", "0/U", "0/p", OF_USER];
    let newest = newest.iter().filter_map(|path| time_of(case.join(path))).max();
    part(ranks).is_none() && (0..ranks).all(|rank| part(rank) > newest)
}

/// Outcome of a cut by the dictionary of a case's author.
enum Outcome {
    Cut,
    NoDictionary,
    /// The reason why it cannot be followed, to be read behind the dictionary's name.
    Unfit(String),
}

fn cut_by_dictionary_of_user(case: &Path, ranks: u32) -> Result<Outcome, String> {
    let dictionary = case.join(OF_USER);
    if !dictionary.is_file() {
        return Ok(Outcome::NoDictionary);
    }
    match number_of_parts(&dictionary, case) {
        Some(number) if number != ranks => {
            return Ok(Outcome::Unfit(format!("asks for {number} parts, and the scene for {ranks} ranks")));
        }
        // What is wrong with a dictionary without a number decomposePar says.
        _ => {}
    }
    match run_tool("decomposePar", case, &["-force"]) {
        Ok(()) => Ok(Outcome::Cut),
        Err(error) if LACKING.iter().any(|words| error.contains(words)) => {
            Ok(Outcome::Unfit(format!("asks for a method that this OpenFOAM lacks ({error})")))
        }
        Err(error) => Err(error),
    }
}

/// Number of parts for which a dictionary asks, as OpenFOAM reads it: it may include other files.
fn number_of_parts(dictionary: &Path, case: &Path) -> Option<u32> {
    let dictionary = dictionary.display().to_string();
    let options = [dictionary.as_str(), "-entry", "numberOfSubdomains", "-value"];
    let printed = tool_output("foamDictionary", case, &options).ok()?;
    // Warnings may stand before it.
    printed.lines().last()?.trim().parse().ok()
}

/// Cuts a case by a dictionary of ours. Returns the number of parts along each axis.
fn cut_by_ours(case: &Path, ranks: u32) -> Result<[u32; 3], String> {
    let counts @ [x, y, z] = parts_along_axes(ranks, extent(case).unwrap_or([1.0, 0.0, 0.0]));
    let text = format!(
        "FoamFile {{ version 2.0; format ascii; class dictionary; object decomposeParDict; }}\n\
         numberOfSubdomains {ranks};\nmethod hierarchical;\n\
         hierarchicalCoeffs {{ n ({x} {y} {z}); delta 0.001; order xyz; }}\n"
    );
    let ours = case.join(OURS);
    std::fs::write(&ours, text).map_err(|error| format!("cannot write {}: {error}", ours.display()))?;
    run_tool("decomposePar", case, &["-force", "-decomposeParDict", OURS])?;
    Ok(counts)
}

/// Edges of the mesh's bounding box [m], as OpenFOAM says; `None` where it does not.
fn extent(case: &Path) -> Option<[f64; 3]> {
    let said = tool_output("checkMesh", case, &["-constant", "-noTopology"]).ok()?;
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
