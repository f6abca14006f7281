//! File `.pvd`: ParaView's list of files over time.

use super::atomic::write_text;
use crate::SceneError;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Series of files; the `.pvd` file is rewritten as a whole, so that it is valid at any moment.
#[derive(Clone, Debug)]
pub struct PvdSeries {
    path: PathBuf,
    frames: Vec<Frame>,
}

/// Frame of a series.
#[derive(Clone, Debug)]
struct Frame {
    time_s: f64,
    /// Number of the file among those of its time.
    part: u32,
    /// Path from the folder of the `.pvd` file.
    file: String,
}

impl PvdSeries {
    /// Empty series.
    #[must_use]
    pub fn new(path: &Path) -> Self {
        Self { path: path.to_path_buf(), frames: Vec::new() }
    }

    /// Series of a run that is continued: only frames for whose file `is_kept` holds are kept.
    ///
    /// Without a `.pvd` file the series is empty.
    #[must_use]
    pub fn resume(path: &Path, is_kept: impl Fn(&str) -> bool) -> Self {
        let mut series = Self::new(path);
        let text = std::fs::read_to_string(path).unwrap_or_default();
        for line in text.lines() {
            if let (Some(time), Some(file)) = (attribute(line, "timestep"), attribute(line, "file"))
                && let Ok(time_s) = time.parse::<f64>()
                && is_kept(file)
            {
                let part = attribute(line, "part").and_then(|part| part.parse().ok()).unwrap_or(0);
                series.frames.push(Frame { time_s, part, file: file.to_owned() });
            }
        }
        series
    }

    /// Appends a frame: its time [s] and the path of its file from the folder of the `.pvd` file.
    ///
    /// A frame of the same file is replaced.
    ///
    /// # Errors
    /// Errors of the operating system.
    pub fn append(&mut self, time_s: f64, file: &str) -> Result<(), SceneError> {
        self.append_part(time_s, 0, file)
    }

    /// Appends a file as a part of a frame that has several.
    ///
    /// # Errors
    /// Errors of the operating system.
    pub fn append_part(&mut self, time_s: f64, part: u32, file: &str) -> Result<(), SceneError> {
        self.frames.retain(|other| other.file != file);
        self.frames.push(Frame { time_s, part, file: file.to_owned() });
        let mut text = String::from(
            "<?xml version=\"1.0\"?>\n\
             <VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n",
        );
        for Frame { time_s, part, file } in &self.frames {
            // Writing to a String cannot fail.
            let _ = writeln!(
                text,
                "<DataSet timestep=\"{time_s:?}\" group=\"\" part=\"{part}\" file=\"{file}\"/>"
            );
        }
        text.push_str("</Collection>\n</VTKFile>\n");
        write_text(&self.path, &text)
    }
}

/// Value of an attribute in a line of XML.
fn attribute<'l>(line: &'l str, name: &str) -> Option<&'l str> {
    let (_, rest) = line.split_once(&format!(" {name}=\""))?;
    rest.split('"').next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_after_the_checkpoint_are_forgotten() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("particles.pvd");
        let mut series = PvdSeries::new(&path);
        for step in 0..4_u32 {
            series.append(f64::from(step) * 0.1, &format!("particles/{step}.vtu")).unwrap();
        }
        let mut series = PvdSeries::resume(&path, |file| file < "particles/2");
        assert_eq!(series.frames.len(), 2);
        series.append(0.15, "particles/x.vtu").unwrap();
        assert_eq!(PvdSeries::resume(&path, |_| true).frames.len(), 3);
    }
}
