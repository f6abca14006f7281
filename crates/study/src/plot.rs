//! Curves with axes, written as PNG or SVG.

use crate::StudyError;
use crate::canvas::{Anchor, Raster, Surface, Svg, Text, text_width};
use crate::colour::{Colour, GRID, INK, SERIES, SOFT_INK};
use crate::ticks;
use std::path::Path;

/// How an axis counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AxisScale {
    /// Equal steps.
    #[default]
    Linear,
    /// Equal ratios; values that are not positive are left out.
    Log,
}

/// An axis: what it shows, with its unit, and how it counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlotAxis {
    /// Name and unit, as in `time [s]`.
    pub label: String,
    /// Linear or logarithmic.
    pub scale: AxisScale,
}

impl PlotAxis {
    /// Linear axis.
    #[must_use]
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: AxisScale::Linear }
    }

    /// Logarithmic axis.
    #[must_use]
    pub fn log(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: AxisScale::Log }
    }
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Marks {
    /// A line.
    #[default]
    Line,
    /// A dot at each point.
    Dots,
    /// A line and a dot at each point.
    Both,
}

/// Points that belong together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Name in the legend; an empty one is left out there.
    pub name: String,
    /// Abscissa and ordinate in the axes' units; points that are not finite interrupt the line.
    pub points: Vec<[f64; 2]>,
    /// Line, dots or both.
    pub marks: Marks,
}

/// A plot of several series over common axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// Heading.
    pub title: String,
    /// Horizontal axis.
    pub x: PlotAxis,
    /// Vertical axis.
    pub y: PlotAxis,
    /// Series, drawn in order.
    pub series: Vec<Series>,
}

const WIDTH: usize = 960;
const HEIGHT: usize = 620;
/// Left, top, right, bottom of the part with the curves [px].
const LEFT: f64 = 108.0;
const TOP: f64 = 76.0;
const BOTTOM: f64 = HEIGHT as f64 - 84.0;
const MARGIN: f64 = 36.0;
const TEXT_SIZE: f64 = 17.0;
const LINE_WIDTH: f64 = 2.4;

impl Plot {
    /// Writes the plot; the ending of the path, `.png` or `.svg`, decides the format.
    ///
    /// # Errors
    /// Another ending; a file that cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), StudyError> {
        match path.extension().and_then(|ending| ending.to_str()) {
            Some("png") => {
                let mut raster = Raster::new(WIDTH, HEIGHT);
                self.draw(&mut raster);
                raster.write_png(path)
            }
            Some("svg") => {
                let mut svg = Svg::new(WIDTH, HEIGHT);
                self.draw(&mut svg);
                svg.write(path)
            }
            _ => Err(StudyError::Ending { path: path.to_owned() }),
        }
    }

    fn draw(&self, surface: &mut impl Surface) {
        let names = self.series.iter().map(|series| text_width(&series.name, TEXT_SIZE)).fold(0.0, f64::max);
        let right = WIDTH as f64 - MARGIN - if names > 0.0 { names + 52.0 } else { 0.0 };
        let x = Mapping::new(self, 0, [LEFT, right]);
        let y = Mapping::new(self, 1, [BOTTOM, TOP]);
        write(surface, [LEFT, 44.0], &self.title, 24.0, Anchor::Start, INK);
        axes(surface, self, &x, &y);
        for (index, series) in self.series.iter().enumerate() {
            curve(surface, series, &x, &y, SERIES[index % SERIES.len()]);
        }
        legend(surface, self, right + 22.0);
    }
}

fn write(surface: &mut impl Surface, at: [f64; 2], text: &str, size: f64, anchor: Anchor, colour: Colour) {
    surface.text(at, Text { text, size, anchor, colour, upwards: false });
}

/// From an axis' values to pixels.
struct Mapping {
    scale: AxisScale,
    /// Ends of the axis (logarithms on a logarithmic one).
    low: f64,
    high: f64,
    pixels: [f64; 2],
}

impl Mapping {
    fn new(plot: &Plot, part: usize, pixels: [f64; 2]) -> Self {
        let scale = [&plot.x, &plot.y][part].scale;
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for point in plot.series.iter().flat_map(|series| &series.points) {
            if let Some(value) =
                inner(scale, point[part]).filter(|_| point.iter().all(|value| value.is_finite()))
            {
                (low, high) = (low.min(value), high.max(value));
            }
        }
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        // Room around the curves; a flat curve still needs an axis of some length.
        let least = if scale == AxisScale::Log { 1.0 } else { 1e-3 * low.abs().max(high.abs()).max(1e-300) };
        let room = if part == 1 { 0.05 * (high - low) } else { 0.0 };
        let more = (0.5 * (least - (high - low))).max(0.0);
        Self { scale, low: low - room - more, high: high + room + more, pixels }
    }

    fn pixel_of_inner(&self, value: f64) -> f64 {
        self.pixels[0] + (self.pixels[1] - self.pixels[0]) * (value - self.low) / (self.high - self.low)
    }

    fn pixel(&self, value: f64) -> Option<f64> {
        inner(self.scale, value).map(|value| self.pixel_of_inner(value))
    }

    /// Places [px] and labels of the ticks, and the power of ten taken out of all labels.
    fn ticks(&self, most: usize) -> (Vec<(f64, String)>, i32) {
        if self.scale == AxisScale::Log {
            let (low, high) = (10.0_f64.powf(self.low), 10.0_f64.powf(self.high));
            let few = self.high - self.low < 2.5;
            let places = if few { ticks::ratios(low, high) } else { ticks::decades(low, high, most) };
            let label = |value: f64| {
                if few {
                    ticks::ratio_label(value)
                } else {
                    ticks::power_of_ten(value.log10().round() as i32)
                }
            };
            return (
                places.iter().map(|value| (self.pixel_of_inner(value.log10()), label(*value))).collect(),
                0,
            );
        }
        let places = ticks::linear(self.low, self.high, most);
        let exponent = ticks::common_exponent(&places);
        let labels = ticks::labels(&places, exponent);
        (places.iter().map(|value| self.pixel_of_inner(*value)).zip(labels).collect(), exponent)
    }
}

/// The value along the axis, if it has a place there.
fn inner(scale: AxisScale, value: f64) -> Option<f64> {
    match scale {
        AxisScale::Linear => Some(value),
        AxisScale::Log => (value > 0.0).then(|| value.log10()),
    }
    .filter(|value| value.is_finite())
}

fn with_exponent(label: &str, exponent: i32) -> String {
    if exponent == 0 { label.to_owned() } else { format!("{label}  × {}", ticks::power_of_ten(exponent)) }
}

fn axes(surface: &mut impl Surface, plot: &Plot, x: &Mapping, y: &Mapping) {
    let [left, right] = x.pixels;
    let (x_ticks, x_exponent) = x.ticks(8);
    for (place, label) in &x_ticks {
        surface.line(&[[*place, TOP], [*place, BOTTOM]], 1.0, GRID);
        write(surface, [*place, BOTTOM + 26.0], label, TEXT_SIZE, Anchor::Middle, SOFT_INK);
    }
    let (y_ticks, y_exponent) = y.ticks(7);
    for (place, label) in &y_ticks {
        surface.line(&[[left, *place], [right, *place]], 1.0, GRID);
        write(surface, [left - 12.0, place + 6.0], label, TEXT_SIZE, Anchor::End, SOFT_INK);
    }
    surface.line(&[[left, TOP], [left, BOTTOM], [right, BOTTOM]], 1.4, INK);
    let x_label = with_exponent(&plot.x.label, x_exponent);
    write(surface, [0.5 * (left + right), BOTTOM + 60.0], &x_label, TEXT_SIZE + 1.0, Anchor::Middle, INK);
    let y_label = with_exponent(&plot.y.label, y_exponent);
    let at = [36.0, 0.5 * (TOP + BOTTOM)];
    let size = TEXT_SIZE + 1.0;
    surface.text(at, Text { text: &y_label, size, anchor: Anchor::Middle, colour: INK, upwards: true });
}

fn curve(surface: &mut impl Surface, series: &Series, x: &Mapping, y: &Mapping, colour: Colour) {
    let place = |point: &[f64; 2]| Some([x.pixel(point[0])?, y.pixel(point[1])?]);
    let places: Vec<Option<[f64; 2]>> = series.points.iter().map(place).collect();
    if series.marks != Marks::Dots {
        for run in places.split(Option::is_none).filter(|run| run.len() > 1) {
            let run: Vec<[f64; 2]> = run.iter().flatten().copied().collect();
            surface.line(&run, LINE_WIDTH, colour);
        }
    }
    if series.marks != Marks::Line {
        for place in places.iter().flatten() {
            surface.disc(*place, 4.2, colour);
        }
    }
}

fn legend(surface: &mut impl Surface, plot: &Plot, left: f64) {
    let named = plot.series.iter().enumerate().filter(|(_, series)| !series.name.is_empty());
    for (row, (index, series)) in named.enumerate() {
        let (y, colour) = (TOP + 14.0 + 28.0 * row as f64, SERIES[index % SERIES.len()]);
        if series.marks != Marks::Dots {
            surface.line(&[[left, y], [left + 22.0, y]], LINE_WIDTH, colour);
        }
        if series.marks != Marks::Line {
            surface.disc([left + 11.0, y], 4.2, colour);
        }
        write(surface, [left + 30.0, y + 6.0], &series.name, TEXT_SIZE, Anchor::Start, INK);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(points: Vec<[f64; 2]>, scale: AxisScale) -> Plot {
        let axis = PlotAxis { label: "q [C]".to_owned(), scale };
        let series = vec![Series { name: "a".to_owned(), points, marks: Marks::Both }];
        Plot { title: "Test".to_owned(), x: axis.clone(), y: axis, series }
    }

    fn svg(plot: &Plot) -> String {
        let mut svg = Svg::new(WIDTH, HEIGHT);
        plot.draw(&mut svg);
        svg.text_of_file()
    }

    #[test]
    fn empty_flat_and_broken_data_are_drawn() {
        for points in [vec![], vec![[1.0, 5.0]], vec![[0.0, 0.0], [1.0, f64::NAN], [2.0, 0.0]]] {
            for scale in [AxisScale::Linear, AxisScale::Log] {
                let text = svg(&plot(points.clone(), scale));
                assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
            }
        }
    }

    #[test]
    fn logarithmic_axes_leave_out_what_has_no_logarithm() {
        let text = svg(&plot(vec![[-1.0, 1.0], [0.0, 1.0], [1.0, 1.0], [100.0, 10.0]], AxisScale::Log));
        // Two dots in the curve and one in the legend.
        assert_eq!(text.matches("<circle").count(), 3);
        assert!(text.contains(">100<"));
    }

    #[test]
    fn ending_decides_the_format() {
        let folder = tempfile::tempdir().unwrap();
        let plot = plot(vec![[0.0, 1.0], [1.0, 2.0]], AxisScale::Linear);
        plot.write(&folder.path().join("a.png")).unwrap();
        plot.write(&folder.path().join("a.svg")).unwrap();
        assert!(std::fs::read(folder.path().join("a.png")).unwrap().starts_with(b"\x89PNG"));
        assert!(matches!(plot.write(&folder.path().join("a.gif")), Err(StudyError::Ending { .. })));
    }
}
