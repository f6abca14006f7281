//! Distribution of charge over the grains: `charge_histogram.csv`, and a plot of it at the end.

use super::folder::RunFolder;
use crate::failure::Failure;
use amberfield_core::Particles;
use amberfield_scene::files::CHARGE_HISTOGRAM;
use amberfield_scene::{HistoryFile, HistoryValue};

/// Number of equal bins between the smallest and the largest value of a frame.
const BINS: usize = 40;
/// Name of the file.
pub(crate) const FILE: &str = CHARGE_HISTOGRAM.path;
/// Names of the plots of charge and of charge over mass.
pub(crate) const PLOTS: [&str; 2] = ["charge_histogram.svg", "charge_to_mass_histogram.svg"];

/// Open file of histograms.
#[derive(Debug)]
pub(crate) struct Histogram {
    rows: HistoryFile,
}

impl Histogram {
    /// Creates the file of a new run.
    pub(crate) fn create(folder: &RunFolder) -> Result<Self, Failure> {
        Ok(Self { rows: HistoryFile::create(&folder.file(FILE), &CHARGE_HISTOGRAM.heading())? })
    }

    /// Opens the file of a run that is continued after a step; frames that are not due are removed.
    pub(crate) fn resume(
        folder: &RunFolder,
        step: u64,
        is_due: impl Fn(u64) -> bool,
    ) -> Result<Self, Failure> {
        Ok(Self { rows: HistoryFile::resume(&folder.file(FILE), &CHARGE_HISTOGRAM.heading(), step, is_due)? })
    }

    /// Appends the histograms of a frame at a step and a time [s], once for each step.
    pub(crate) fn append(&mut self, step: u64, time_s: f64, particles: &Particles) -> Result<(), Failure> {
        if self.rows.last_step() == Some(step) {
            return Ok(());
        }
        let per_mass: Vec<f64> =
            particles.charge.iter().enumerate().map(|(i, charge)| charge / particles.mass(i)).collect();
        let (charges, ratios) = (HistogramBins::of(&particles.charge), HistogramBins::of(&per_mass));
        for bin in 0..BINS {
            let mut row = vec![HistoryValue::Count(step), HistoryValue::Number(time_s)];
            for bins in [&charges, &ratios] {
                row.extend([bins.edge(bin), bins.edge(bin + 1)].map(HistoryValue::Number));
                row.push(HistoryValue::Count(bins.counts[bin]));
            }
            self.rows.append(&row)?;
        }
        Ok(())
    }
}

/// Histogram of one quantity.
struct HistogramBins {
    /// Lower edge of the first bin.
    low: f64,
    /// Width of a bin; 0 when all values are equal.
    width: f64,
    counts: [u64; BINS],
}

impl HistogramBins {
    /// Counts values.
    fn of(values: &[f64]) -> Self {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let (low, width) = if low < high { (low, (high - low) / BINS as f64) } else { (low.min(high), 0.0) };
        let mut counts = [0; BINS];
        for value in values {
            let bin = if width > 0.0 { ((value - low) / width) as usize } else { 0 };
            counts[bin.min(BINS - 1)] += 1;
        }
        Self { low: if low.is_finite() { low } else { 0.0 }, width, counts }
    }

    /// Lower edge of a bin.
    fn edge(&self, bin: usize) -> f64 {
        self.low + self.width * bin as f64
    }
}

/// Plots some of the frames. A plot that fails causes a warning only, since the results are complete.
#[cfg(feature = "plots")]
pub(crate) fn plot(folder: &RunFolder) {
    use amberfield_draw::{Plot, Scale, Series, write_plot};
    /// Number of frames in a plot.
    const CURVES: usize = 5;
    let text = std::fs::read_to_string(folder.file(FILE)).unwrap_or_default();
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect())
        .filter(|row: &Vec<f64>| row.len() == CHARGE_HISTOGRAM.heading().len())
        .collect();
    let frames: Vec<&[Vec<f64>]> = rows.chunks(BINS).collect();
    let Some(last) = frames.len().checked_sub(1) else { return };
    let mut shown: Vec<usize> = (0..CURVES).map(|n| last * n / (CURVES - 1)).collect();
    shown.dedup();
    let axes = [(2, "charge [C]"), (5, "charge over mass [C/kg]")];
    for (name, (first, x)) in PLOTS.into_iter().zip(axes) {
        let curve = |frame: usize| {
            let rows = frames[frame];
            let points = rows.iter().map(|row| (0.5 * (row[first] + row[first + 1]), row[first + 2]));
            let name = format!("t = {:.4} s", rows[0][1]);
            Series { name, points: points.collect() }
        };
        // Where all grains are equal there is no curve to draw.
        let differ = |frame: &usize| frames[*frame][0][first] != frames[*frame][0][first + 1];
        let series: Vec<Series> = shown.iter().copied().filter(differ).map(curve).collect();
        if series.is_empty() {
            continue;
        }
        let plot = Plot {
            title: "Charge of the grains",
            x,
            y: "grains in a bin",
            scales: [Scale::Linear; 2],
            series: &series,
            ringed: &[],
        };
        if let Err(error) = write_plot(&folder.file(name), &plot) {
            tracing::warn!("no plot: {error}");
        }
    }
}

/// Plots nothing in a build without the feature.
#[cfg(not(feature = "plots"))]
pub(crate) fn plot(_: &RunFolder) {}
