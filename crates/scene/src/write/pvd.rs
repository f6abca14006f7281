//! ParaView's list of files over time.

use super::atomic::write_text;
use crate::SceneError;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// A `.pvd` file; rewritten whole, so that it is valid at any moment.
#[derive(Clone, Debug)]
pub struct PvdSeries {
    path: PathBuf,
    frames: Vec<(f64, String)>,
}

impl PvdSeries {
    /// An empty series.
    #[must_use]
    pub fn new(path: &Path) -> Self {
        Self { path: path.to_path_buf(), frames: Vec::new() }
    }

    /// The series of a run that is continued: only frames whose file `is_kept` are remembered. A file that is not
    /// there is an empty series.
    #[must_use]
    pub fn resume(path: &Path, is_kept: impl Fn(&str) -> bool) -> Self {
        let mut series = Self::new(path);
        let text = std::fs::read_to_string(path).unwrap_or_default();
        for line in text.lines() {
            if let (Some(time), Some(file)) = (attribute(line, "timestep"), attribute(line, "file"))
                && let Ok(time) = time.parse::<f64>()
                && is_kept(file)
            {
                series.frames.push((time, file.to_owned()));
            }
        }
        series
    }

    /// Appends a frame: its time [s] and its file, from the `.pvd` file's folder. A frame of the same file is
    /// replaced.
    ///
    /// # Errors
    /// What the system says.
    pub fn append(&mut self, time_s: f64, file: &str) -> Result<(), SceneError> {
        self.frames.retain(|(_, other)| other != file);
        self.frames.push((time_s, file.to_owned()));
        let mut text = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n",
        );
        for (time, file) in &self.frames {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "<DataSet timestep=\"{time:?}\" group=\"\" part=\"0\" file=\"{file}\"/>");
        }
        text.push_str("</Collection>\n</VTKFile>\n");
        write_text(&self.path, &text)
    }
}

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
