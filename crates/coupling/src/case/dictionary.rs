//! Entries of OpenFOAM's dictionaries, and the files that these include.

use super::alias::Alias;
use super::tools::tool_output;
use super::unusable;
use crate::CouplingError;
use flate2::read::MultiGzDecoder;
use std::io::Read as _;
use std::path::{Path, PathBuf};

/// Ending of a compressed file.
const COMPRESSED: &str = ".gz";
/// Directives before the name of another file.
const INCLUDES: [&str; 5] =
    ["#include", "#includeIfPresent", "#sinclude", "#sIncludeIfPresent", "#includeOptional"];

/// Value of an entry at the top of a dictionary in a case, if it is there.
///
/// Plain values are read here, those with variables or behind includes by OpenFOAM.
pub(super) fn entry(case: &Path, file: &str, key: &str) -> Result<Option<String>, CouplingError> {
    let path = case.join(file);
    let bytes = std::fs::read(&path).map_err(|error| unusable(&path, error))?;
    let text = without_comments(&String::from_utf8_lossy(&bytes));
    let found = top_entries(&text).filter(|(name, _)| *name == key).last().map(|(_, value)| value.to_owned());
    let is_plain = |value: &str| !value.is_empty() && !value.contains(['$', '#', '"', '(', ' ']);
    match found {
        Some(value) if is_plain(&value) => Ok(Some(value)),
        None if !text.contains("#include") => Ok(None),
        _ => {
            let alias = Alias::of(case).map_err(|error| unusable(case, error))?;
            let path = alias.path().join(file);
            let options = [path.as_os_str(), "-entry".as_ref(), key.as_ref(), "-value".as_ref()];
            let said = tool_output("foamDictionary", alias.path(), &options);
            // An entry that is not there is no error here; what is wrong with the file its reader says.
            Ok(said.and_then(|said| Some(said.lines().last()?.trim().to_owned())))
        }
    }
}

/// Text of a dictionary without its comments.
fn without_comments(text: &str) -> String {
    let mut rest = text;
    let mut kept = String::with_capacity(text.len());
    while let Some(at) = rest.find(['/', '"']) {
        let (before, from) = rest.split_at(at);
        kept += before;
        let length = if from.starts_with("//") {
            from.find('\n').unwrap_or(from.len())
        } else if let Some(inside) = from.strip_prefix("/*") {
            inside.find("*/").map_or(from.len(), |end| end + 4)
        } else {
            let quoted = from.strip_prefix('"').and_then(|inside| inside.find('"')).map(|end| end + 2);
            let length = quoted.unwrap_or(1);
            kept += &from[..length];
            length
        };
        rest = &from[length..];
    }
    kept + rest
}

/// Entries `key value;` at the top of a dictionary.
fn top_entries(text: &str) -> impl Iterator<Item = (&str, &str)> {
    let mut depth = 0_i32;
    let mut from = 0;
    let mut entries = Vec::new();
    for (at, c) in text.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => {
                depth -= 1;
                from = at + 1;
            }
            ';' if depth == 0 => {
                if let Some((key, value)) = text[from..at].trim().split_once(char::is_whitespace) {
                    entries.push((key, value.trim()));
                }
                from = at + 1;
            }
            _ => {}
        }
    }
    entries.into_iter()
}

/// Bytes of a file, decompressed where its name says so.
pub(super) fn content(path: &Path) -> std::io::Result<Vec<u8>> {
    let bytes = std::fs::read(path)?;
    if !path.as_os_str().as_encoded_bytes().ends_with(COMPRESSED.as_bytes()) {
        return Ok(bytes);
    }
    let mut content = Vec::new();
    MultiGzDecoder::new(&bytes[..]).read_to_end(&mut content)?;
    Ok(content)
}

/// Paths of the files that a file of a case includes, whether they are there or not.
pub(super) fn included(case: &Path, file: &Path, content: &[u8]) -> Vec<PathBuf> {
    if !content.windows(2).any(|pair| pair == b"#i" || pair == b"#s") {
        return Vec::new();
    }
    let text = String::from_utf8_lossy(content);
    let folder = file.parent().unwrap_or(case);
    let name_of = |line: &str| {
        let line = line.trim_start();
        let rest =
            INCLUDES.iter().filter_map(|word| line.strip_prefix(word)).min_by_key(|rest| rest.len())?;
        let quoted = rest.trim_start().strip_prefix('"')?;
        let (name, _) = quoted.split_once('"')?;
        Some(folder.join(expanded(name, case)?))
    };
    without_comments(&text).lines().filter_map(name_of).collect()
}

/// Name of a file with its variables and tags, such as `$FOAM_CASE` and `<system>`, put in; `None` where one
/// is not known.
fn expanded(name: &str, case: &Path) -> Option<String> {
    let case = case.to_str()?;
    let mut rest = name.replace("<case>", case);
    for folder in ["constant", "system"] {
        rest = rest.replace(&format!("<{folder}>"), &format!("{case}/{folder}"));
    }
    let mut whole = String::new();
    while let Some((before, after)) = rest.split_once('$') {
        let braced = after.strip_prefix('{').and_then(|inside| inside.split_once('}'));
        let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let end = after.find(|c| !is_name(c)).unwrap_or(after.len());
        let (variable, after) = braced.unwrap_or_else(|| after.split_at(end));
        let value = if variable == "FOAM_CASE" { case.to_owned() } else { std::env::var(variable).ok()? };
        whole += before;
        whole += &value;
        rest = after.to_owned();
    }
    Some(whole + &rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_inner_dictionaries_are_no_entries() {
        let text = "/* startFrom a; */ FoamFile { startFrom b; }\n// startFrom c;\nstartFrom  startTime; \
                    functions { f { startFrom d; } }\nurl \"http://x\"; startTime 0.5;";
        let text = without_comments(text);
        let entries: Vec<_> = top_entries(&text).collect();
        assert_eq!(entries, [("startFrom", "startTime"), ("url", "\"http://x\""), ("startTime", "0.5")]);
    }

    #[test]
    fn files_that_a_file_includes_are_found_where_openfoam_looks() {
        let case = Path::new("/a/case");
        let content = b"#include \"include/voltage\"\n  #includeIfPresent \"$FOAM_CASE/x\"\n\
                        // #include \"not\"\n#include \"<system>/y\"\n#includeEtc \"caseDicts/z\"\n\
                        value ${A}; #calc \"1\";\n#include \"../../up\"\n";
        let found = included(case, Path::new("/a/case/0/phiE"), content);
        let expected = ["/a/case/0/include/voltage", "/a/case/x", "/a/case/system/y", "/a/case/0/../../up"];
        assert_eq!(found, expected.map(PathBuf::from));
    }
}
