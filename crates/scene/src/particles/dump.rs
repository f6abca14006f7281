//! Text dumps of LAMMPS and LIGGGHTS (`dump custom`, `dump atom`): frames, each a header and a row for each
//! grain.
//!
//! The form is described on the page `dump` of the manual of LAMMPS.

use super::dump_header::{FrameBox, FrameHeader, units};
use super::grains::{Gathering, GrainContext};
use super::row::{DecimalSign, TextRow};
use super::snapshot::{FileChoices, Snapshot, SnapshotBox};
use super::units::Units;
use super::words::{Lines, Words};
use crate::SceneError;
use crate::error::shorten;
use csv::StringRecord;
use nalgebra::Vector3;
use std::io::BufRead;

/// Frame with the text of its rows.
#[derive(Debug, Default)]
struct Frame {
    header: FrameHeader,
    rows: Vec<u8>,
}

/// Reader of the frames of a dump.
struct Dump<R> {
    file: String,
    lines: Lines<R>,
    /// Units that the file names.
    units: Option<Units>,
    /// Line that was read but belongs to the next section.
    pending: bool,
}

impl<R: BufRead> Dump<R> {
    fn new(file: &str, reader: R) -> Self {
        Self { file: file.to_owned(), lines: Lines::new(file, reader), units: None, pending: false }
    }

    /// Reads the header of the next frame; `None` at the end of the file.
    fn header(&mut self) -> Result<Option<FrameHeader>, SceneError> {
        let mut header = FrameHeader::default();
        let mut has_begun = false;
        loop {
            if !std::mem::take(&mut self.pending) && !self.lines.advance()? {
                if has_begun {
                    return Err(self.cut_short("the header of its last frame"));
                }
                return Ok(None);
            }
            let text = self.lines.text()?;
            if text.is_empty() {
                continue;
            }
            let Some(item) = text.strip_prefix("ITEM:") else {
                let text = shorten(text);
                return Err(self.lines.error(format!(
                    "\"{text}\" where a section ITEM: … should begin; atoms and rows may differ in number"
                )));
            };
            has_begun = true;
            let item = item.trim().to_owned();
            if let Some(columns) = item.strip_prefix("ATOMS") {
                header.columns = columns.split_ascii_whitespace().map(ToOwned::to_owned).collect();
                header.line = self.lines.number();
                return Ok(Some(header));
            }
            self.section(&item, &mut header)?;
        }
    }

    /// Reads a section of a header.
    fn section(&mut self, item: &str, header: &mut FrameHeader) -> Result<(), SceneError> {
        match item.split_ascii_whitespace().next().unwrap_or_default() {
            "UNITS" => {
                let name = self.value("the units")?;
                self.units = Some(Units::named(&name).map_err(|problem| {
                    self.lines.error(format!("units \"{}\": {problem}", shorten(&name)))
                })?);
            }
            "TIMESTEP" => header.step = Some(self.parsed("the step", "a whole number")?),
            "TIME" => header.time = Some(self.parsed("the time", "a number")?),
            "NUMBER" => header.count = Some(self.parsed("the number of atoms", "a whole number")?),
            "BOX" => header.bounds = Some(self.bounds(item)?),
            "ENTRIES" | "GRID" => {
                let problem = "a dump of pairs or of a grid, not of grains; dump with the style custom";
                return Err(self.lines.error(problem));
            }
            _ => {
                // Sections that are not known here belong to no grain.
                while self.lines.advance()? {
                    if self.lines.bytes().starts_with(b"ITEM:") {
                        self.pending = true;
                        break;
                    }
                }
            }
        }
        Ok(())
    }

    /// Reads a line of a header.
    fn value(&mut self, what: &str) -> Result<String, SceneError> {
        if !self.lines.advance()? {
            return Err(self.cut_short(what));
        }
        Ok(self.lines.text()?.to_owned())
    }

    fn parsed<T: std::str::FromStr>(&mut self, what: &str, form: &str) -> Result<T, SceneError> {
        let text = self.value(what)?;
        text.parse().map_err(|_| {
            self.lines.error(format!("{what} is \"{}\", not {form}; check the file", shorten(&text)))
        })
    }

    /// Reads the box; one with oblique axes is refused.
    fn bounds(&mut self, item: &str) -> Result<FrameBox, SceneError> {
        const FORM: &str = "the box";
        if item.contains("abc") {
            return Err(self.lines.error("a box with oblique axes; only boxes along x, y and z are read"));
        }
        let flags: Vec<&str> = item
            .split_ascii_whitespace()
            .skip(2)
            .filter(|word| word.len() == 2 && word.bytes().all(|byte| b"pfsm".contains(&byte)))
            .collect();
        let mut bounds = FrameBox { min: [0.0; 3], max: [0.0; 3], is_periodic: [None; 3] };
        for axis in 0..3 {
            let text = self.value(FORM)?;
            let numbers: Vec<f64> =
                text.split_ascii_whitespace().filter_map(|word| word.parse().ok()).collect();
            let words = text.split_ascii_whitespace().count();
            let good = words == numbers.len()
                && matches!(words, 2 | 3)
                && numbers.iter().all(|number| number.is_finite())
                && numbers[0] <= numbers[1];
            if !good {
                let problem = format!("{FORM} is \"{}\"; it needs a lower and an upper end", shorten(&text));
                return Err(self.lines.error(problem));
            }
            if numbers.get(2).is_some_and(|tilt| *tilt != 0.0) {
                let problem =
                    "a box with oblique axes (xy, xz or yz is not 0); only boxes along x, y and z are read";
                return Err(self.lines.error(problem));
            }
            bounds.min[axis] = numbers[0];
            bounds.max[axis] = numbers[1];
            bounds.is_periodic[axis] = flags.get(axis).map(|flag| *flag == "pp");
        }
        Ok(bounds)
    }

    /// Reads the rows of a frame into a buffer, or over them.
    fn rows(&mut self, header: &FrameHeader, mut buffer: Option<&mut Vec<u8>>) -> Result<(), SceneError> {
        let Some(count) = header.count else {
            return Err(self.lines.error("no ITEM: NUMBER OF ATOMS before the rows; check the file"));
        };
        if let Some(buffer) = &mut buffer {
            buffer.clear();
        }
        for row in 0..count {
            if !self.lines.advance()? {
                return Err(self.cut_short(&format!("row {} of {count} of its last frame", row + 1)));
            }
            let bytes = self.lines.bytes();
            if bytes.starts_with(b"ITEM:") {
                let problem = format!("a section begins after {row} of {count} rows; check the file");
                return Err(self.lines.error(problem));
            }
            if let Some(buffer) = &mut buffer {
                buffer.extend_from_slice(bytes);
            }
        }
        Ok(())
    }

    /// Error of a file that ends too early.
    fn cut_short(&self, what: &str) -> SceneError {
        SceneError::file(
            &self.file,
            format!("the dump ends before {what}: cut short; choose an earlier frame by step, or dump again"),
        )
    }
}

/// Reads the grains of a frame: that of the step that was chosen, else the last one.
///
/// # Errors
/// A step that is not in the file, units that nobody names, and bad values with their line.
pub(super) fn read_dump(
    file: &str,
    reader: impl BufRead,
    choices: &FileChoices,
    context: &GrainContext<'_>,
) -> Result<Snapshot, SceneError> {
    let mut dump = Dump::new(file, reader);
    let mut chosen: Option<Frame> = None;
    let mut rows = Vec::new();
    let mut steps = Vec::new();
    loop {
        let header = match dump.header() {
            Ok(Some(header)) => header,
            Ok(None) => break,
            // What is behind the chosen frame does not matter, were it cut short.
            Err(_) if chosen.is_some() && choices.step.is_some() => break,
            Err(error) => return Err(error),
        };
        steps.extend(header.step);
        let is_wanted = choices.step.is_none_or(|step| header.step == Some(step));
        match dump.rows(&header, is_wanted.then_some(&mut rows)) {
            Ok(()) if is_wanted => {
                let frame = chosen.get_or_insert_default();
                frame.header = header;
                std::mem::swap(&mut frame.rows, &mut rows);
            }
            Ok(()) => {}
            Err(_) if !is_wanted && chosen.is_some() => break,
            Err(error) => return Err(error),
        }
    }
    match chosen {
        Some(frame) => frame.grains(file, dump.units, choices, context),
        None => {
            let step = choices.step.unwrap_or_default();
            Err(SceneError::file(file, format!("no frame of step {step}; {}", listed(&steps))))
        }
    }
}

/// Words for the steps of a file.
fn listed(steps: &[u64]) -> String {
    const SHOWN: usize = 12;
    let shown = |steps: &[u64]| steps.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
    match steps {
        [] => "it has no frame that names its step".to_owned(),
        [first, .., last] if steps.len() > SHOWN => {
            format!("its {} frames are of steps {first}, {}, …, {last}", steps.len(), steps[1])
        }
        steps => format!("its frames are of steps {}", shown(steps)),
    }
}

impl Frame {
    /// Reads the rows.
    fn grains(
        &self,
        file: &str,
        named: Option<Units>,
        choices: &FileChoices,
        context: &GrainContext<'_>,
    ) -> Result<Snapshot, SceneError> {
        let header = &self.header;
        let factors = units(file, named, choices.units)?.factors();
        let columns = header.known_columns(file, &factors)?;
        if header.count == Some(0) {
            let step = header.step.map_or_else(String::new, |step| format!(" of step {step}"));
            let problem = format!("the frame{step} has no grains; choose another by step");
            return Err(SceneError::file(file, problem));
        }
        let count = header.columns.len();
        let mut grains = Gathering::new(columns, context, 1)?;
        grains.wrap(header.periods(&factors));
        let lines = Lines::from(file, &self.rows[..], header.line);
        let mut words = Words::new(lines, None, Some(count));
        let mut record = StringRecord::new();
        while words.read(&mut record)? {
            grains.add(&TextRow { record: &record, decimal: &DecimalSign::Point })?;
        }
        let bounds = header.bounds.map(|bounds| SnapshotBox {
            min_m: Vector3::from(bounds.min) * factors.length,
            max_m: Vector3::from(bounds.max) * factors.length,
            is_periodic: bounds.is_periodic.map(|periodic| periodic == Some(true)),
        });
        let time_s = header.time.map(|time| time * factors.time);
        Ok(Snapshot { step: header.step, time_s, bounds, ..grains.finish()? })
    }
}
