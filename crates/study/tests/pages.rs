//! The recorded pages of studies are those of their recorded rows.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use amberfield_study::sweep::{Results, Study, write_report};
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Rows of the newest file of a name; none where there is no such file.
fn newest<R: DeserializeOwned>(name: &str) -> Vec<R> {
    const DATE: usize = 10;
    let ending = format!("-{name}.csv");
    let files = std::fs::read_dir(root().join("docs/reports/data")).unwrap();
    let file = files
        .map(|file| file.unwrap().path())
        .filter(|file| file.file_name().unwrap().to_str().unwrap().get(DATE..) == Some(&ending))
        .max();
    let rows =
        |file| csv::Reader::from_path(file).unwrap().into_deserialize().map(|row| row.unwrap()).collect();
    file.map_or_else(Vec::new, rows)
}

#[test]
fn recorded_pages_follow_from_recorded_rows() {
    let folder = tempfile::tempdir().unwrap();
    let studies = [
        "error-vs-runtime/study.toml",
        "error-vs-runtime/motion.toml",
        "error-vs-runtime/motion-openfoam.toml",
        "extremes/study.toml",
    ];
    for file in studies {
        let study = Study::read(&root().join("cases").join(file)).unwrap();
        let results = Results {
            points: newest(&study.name),
            motions: newest(&format!("{}-motions", study.name)),
            extremes: newest(&format!("{}-extremes", study.name)),
            energies: newest(&format!("{}-energies", study.name)),
        };
        let repeat = format!("amberfield study cases/{file}");
        let page = write_report(folder.path(), &study, &results, &repeat).unwrap();
        let recorded = root().join("docs/reports").join(page.file_name().unwrap());
        let [written, recorded] = [page, recorded].map(|page| std::fs::read_to_string(page).unwrap());
        for (written, recorded) in written.lines().zip(recorded.lines()) {
            assert_eq!(written, recorded, "{file}");
        }
        assert!(written == recorded, "{file}: other lines at the end");
    }
}
