//! Curves, by plotters.

use crate::error::DrawError;
use crate::raster::write_png;
use plotters::coord::Shift;
use plotters::coord::ranged1d::ValueFormatter;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};
use std::path::Path;

/// A curve.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name of the curve in the legend.
    pub name: String,
    /// (x, y); what a logarithmic axis cannot show is left out.
    pub points: Vec<(f64, f64)>,
}

/// Division of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// Powers of ten; only values above zero are shown.
    Logarithmic,
}

/// Curves in one frame.
#[derive(Clone, Debug)]
pub struct Plot<'a> {
    /// Title above the frame.
    pub title: &'a str,
    /// Label of the x axis, with its unit in brackets.
    pub x: &'a str,
    /// Label of the y axis, with its unit in brackets.
    pub y: &'a str,
    /// Divisions of x and y.
    pub scales: [Scale; 2],
    /// The curves.
    pub series: &'a [Series],
    /// Points to mark with a ring.
    pub ringed: &'a [(f64, f64)],
}

const SIZE: (u32, u32) = (720, 460);
/// Round-off in a position, over the width of an axis.
const ROUND_OFF: f64 = 1e-9;
const FONT: &str = "Noto Sans";
/// Told apart by people with any colour vision (Okabe and Ito, Color Universal Design, 2008).
const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];

/// Writes a plot as PNG where the file's name says so, else as SVG; the same plot gives the same file.
///
/// # Errors
/// A file that cannot be written; a plot without points.
pub fn write_plot(path: &Path, plot: &Plot<'_>) -> Result<(), DrawError> {
    let failed = |reason| DrawError::Plot { path: path.to_owned(), reason };
    if path.extension().is_some_and(|extension| extension == "png") {
        let mut pixels = vec![0; SIZE.0 as usize * SIZE.1 as usize * 3];
        draw(plot, BitMapBackend::with_buffer(&mut pixels, SIZE).into_drawing_area()).map_err(failed)?;
        return write_png(path, SIZE, &pixels);
    }
    let mut text = String::new();
    draw(plot, SVGBackend::with_string(&mut text, SIZE).into_drawing_area()).map_err(failed)?;
    std::fs::write(path, text).map_err(|source| DrawError::Write { path: path.to_owned(), source })
}

fn draw<B: DrawingBackend>(plot: &Plot<'_>, area: DrawingArea<B, Shift>) -> Result<(), String> {
    // A second registration of the same font is refused; the first one stays.
    let _registered = register_font(FONT, FontStyle::Normal, notosans::REGULAR_TTF);
    let (x, y) = (range(plot, 0)?, range(plot, 1)?);
    area.fill(&WHITE).map_err(failed::<B>)?;
    let mut builder = ChartBuilder::on(&area);
    builder.caption(plot.title, (FONT, 18)).margin(12).x_label_area_size(44).y_label_area_size(72);
    let (x, y) = (x.0..x.1, y.0..y.1);
    match plot.scales {
        [Scale::Linear, Scale::Linear] => curves(builder.build_cartesian_2d(x, y), plot)?,
        [Scale::Linear, Scale::Logarithmic] => curves(builder.build_cartesian_2d(x, y.log_scale()), plot)?,
        [Scale::Logarithmic, Scale::Linear] => curves(builder.build_cartesian_2d(x.log_scale(), y), plot)?,
        [Scale::Logarithmic, Scale::Logarithmic] => {
            curves(builder.build_cartesian_2d(x.log_scale(), y.log_scale()), plot)?;
        }
    }
    area.present().map_err(failed::<B>)
}

type BackendError<B> = DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>;

fn failed<B: DrawingBackend>(error: BackendError<B>) -> String {
    error.to_string()
}

/// Draws the axes, the curves and their names.
fn curves<'s, B, X, Y>(
    chart: Result<ChartContext<'s, B, Cartesian2d<X, Y>>, BackendError<B>>,
    plot: &Plot<'_>,
) -> Result<(), String>
where
    B: DrawingBackend + 's,
    X: Ranged<ValueType = f64> + ValueFormatter<f64>,
    Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    let mut chart = chart.map_err(failed::<B>)?;
    let widths = [0, 1].map(|axis| range(plot, axis).map_or(0.0, |(low, high)| high - low));
    let label = |value: &f64, axis: usize| {
        // A tick at zero comes with round-off.
        let linear = plot.scales[axis] == Scale::Linear;
        number(if linear && value.abs() < ROUND_OFF * widths[axis] { 0.0 } else { *value })
    };
    chart
        .configure_mesh()
        .x_desc(plot.x)
        .y_desc(plot.y)
        .label_style((FONT, 13))
        .axis_desc_style((FONT, 14))
        .x_label_formatter(&|value| label(value, 0))
        .y_label_formatter(&|value| label(value, 1))
        .light_line_style(WHITE)
        .draw()
        .map_err(failed::<B>)?;
    for (series, colour) in plot.series.iter().zip(COLOURS.into_iter().cycle()) {
        let points: Vec<_> = shown(plot, series).collect();
        let style = colour.stroke_width(2);
        chart
            .draw_series(LineSeries::new(points.iter().copied(), style))
            .map_err(failed::<B>)?
            .label(series.name.as_str())
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], style));
        chart
            .draw_series(points.iter().map(|&point| Circle::new(point, 3, colour.filled())))
            .map_err(failed::<B>)?;
    }
    chart
        .draw_series(plot.ringed.iter().map(|&point| Circle::new(point, 7, BLACK.stroke_width(1))))
        .map_err(failed::<B>)?;
    chart
        .configure_series_labels()
        .label_font((FONT, 13))
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(200, 203, 210))
        .position(emptiest_corner(plot))
        .draw()
        .map_err(failed::<B>)
}

/// Corner in which the names of the curves hide the fewest points.
fn emptiest_corner(plot: &Plot<'_>) -> SeriesLabelPosition {
    /// Share of the frame that they take.
    const SHARE: f64 = 0.4;
    let ranges = [0, 1].map(|axis| range(plot, axis).unwrap_or((0.0, 1.0)));
    let place = |value: f64, axis: usize| {
        let (low, high) = ranges[axis];
        match plot.scales[axis] {
            Scale::Linear => (value - low) / (high - low),
            Scale::Logarithmic => (value / low).ln() / (high / low).ln(),
        }
    };
    let points: Vec<[f64; 2]> = plot
        .series
        .iter()
        .flat_map(|series| shown(plot, series))
        .map(|(x, y)| [place(x, 0), place(y, 1)])
        .collect();
    let hidden = |[right, upper]: [bool; 2]| {
        let near = |share: f64, far: bool| if far { share > 1.0 - SHARE } else { share < SHARE };
        points.iter().filter(|[x, y]| near(*x, right) && near(*y, upper)).count()
    };
    let corners = [
        ([true, true], SeriesLabelPosition::UpperRight),
        ([false, true], SeriesLabelPosition::UpperLeft),
        ([true, false], SeriesLabelPosition::LowerRight),
        ([false, false], SeriesLabelPosition::LowerLeft),
    ];
    let best = corners.into_iter().min_by_key(|(corner, _)| hidden(*corner));
    best.map_or(SeriesLabelPosition::UpperRight, |(_, position)| position)
}

/// The points that the axes can show.
fn shown<'p>(plot: &Plot<'_>, series: &'p Series) -> impl Iterator<Item = (f64, f64)> + use<'p> {
    let positive = plot.scales.map(|scale| scale == Scale::Logarithmic);
    series.points.iter().copied().filter(move |point| {
        let values = [point.0, point.1].into_iter().zip(positive);
        values.into_iter().all(|(value, positive)| value.is_finite() && (!positive || value > 0.0))
    })
}

/// The range of x (0) or y (1) with a margin.
fn range(plot: &Plot<'_>, axis: usize) -> Result<(f64, f64), String> {
    let points = plot.series.iter().flat_map(|series| shown(plot, series));
    let values = points.map(|point| if axis == 0 { point.0 } else { point.1 });
    let all = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = values.fold(all, |(low, high), value| (low.min(value), high.max(value)));
    if low > high {
        return Err("it has no points".to_owned());
    }
    Ok(match plot.scales[axis] {
        Scale::Logarithmic => (low / 1.4, high * 1.4),
        Scale::Linear => {
            let margin = 0.05 * if high > low { high - low } else { high.abs().max(1.0) };
            (low - margin, high + margin)
        }
    })
}

/// A tick's label: short, powers of ten as 1e-4.
fn number(value: f64) -> String {
    if value == 0.0 || (1e-2..1e4).contains(&value.abs()) {
        format!("{}", (value * 1e6).round() / 1e6)
    } else {
        // Ticks are round numbers: what is beyond four digits is round-off.
        let text = format!("{value:.3e}");
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        format!("{}e{power}", digits.trim_end_matches('0').trim_end_matches('.'))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(points: Vec<(f64, f64)>) -> Vec<Series> {
        vec![Series { name: "p3m".to_owned(), points }]
    }

    #[test]
    fn a_plot_names_its_axes_and_curves_and_repeats() {
        let series = plot(vec![(1e-4, 2000.0), (1e-2, 500.0), (0.0, 3.0)]);
        let plot = Plot {
            title: "Cost and error",
            x: "error",
            y: "time per grain [ns]",
            scales: [Scale::Logarithmic; 2],
            series: &series,
            ringed: &[(1e-2, 500.0)],
        };
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str| {
            let path = folder.path().join(name);
            write_plot(&path, &plot).unwrap();
            std::fs::read(path).unwrap()
        };
        assert_eq!(write("a.svg"), write("b.svg"));
        assert_eq!(write("a.png"), write("b.png"));
        assert!(write("a.png").starts_with(b"\x89PNG"));
        let first = String::from_utf8(write("a.svg")).unwrap();
        for word in ["Cost and error", "time per grain [ns]", "p3m"] {
            assert!(first.contains(word), "no {word}");
        }
    }

    #[test]
    fn a_plot_without_points_is_refused() {
        let series = plot(vec![(0.0, 1.0)]);
        let plot =
            Plot { title: "", x: "", y: "", scales: [Scale::Logarithmic; 2], series: &series, ringed: &[] };
        let folder = tempfile::tempdir().unwrap();
        assert!(write_plot(&folder.path().join("none.svg"), &plot).is_err());
    }
}
