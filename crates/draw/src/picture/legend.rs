//! Heading, colour bar, scale and axes.

use super::PictureScene;
use super::camera::{Camera, axes, span};
use super::grains::ChargeRange;
use super::regions::{FEED, OUTLET, WIDTH};
use crate::colour::{Colour, INK, SOFT_INK, diverging};
use crate::font;
use crate::raster::{Anchor, Raster, Text};
use crate::ticks;
use amberfield_core::{Axis, Boundary, Domain, Side};

/// Largest size of the box in the picture [px].
const LARGEST: [f64; 2] = [820.0, 980.0];
/// Smallest size that the heading and the colour bar need [px].
const SMALLEST: [f64; 2] = [460.0, 420.0];
const TOP: f64 = 120.0;
const BOTTOM: f64 = 112.0;
const LEFT: f64 = 56.0;
/// Room for the colour bar.
const RIGHT: f64 = 190.0;
/// A net charge below this share of all charges is rounding.
const NET_ROUNDING: f64 = 1e-9;
const TITLE_SIZE: f64 = 30.0;
const TEXT_SIZE: f64 = 19.0;

/// Places of the parts of a picture [px].
pub(super) struct Layout {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Place of the box's centre.
    pub(super) centre: [f64; 2],
    pub(super) pixels_per_metre: f64,
    /// Size of the part for the box.
    area: [f64; 2],
}

impl Layout {
    pub(super) fn new(domain: &Domain) -> Self {
        let span = span(domain);
        let pixels_per_metre = (LARGEST[0] / span[0]).min(LARGEST[1] / span[1]);
        let area = [0, 1].map(|axis| (span[axis] * pixels_per_metre).max(SMALLEST[axis]).round());
        Self {
            width: (LEFT + area[0] + RIGHT) as usize,
            height: (TOP + area[1] + BOTTOM) as usize,
            centre: [LEFT + 0.5 * area[0], TOP + 0.5 * area[1]],
            pixels_per_metre,
            area,
        }
    }
}

fn write(raster: &mut Raster, at: [f64; 2], text: &str, size: f64, anchor: Anchor, colour: Colour) {
    raster.text(at, Text { text, size, anchor, colour });
}

/// Draws everything around the box.
pub(super) fn draw(
    raster: &mut Raster,
    camera: &Camera,
    layout: &Layout,
    scene: &PictureScene<'_>,
    range: ChargeRange,
) {
    heading(raster, layout, scene);
    let below = colour_bar(raster, layout, range);
    regions_key(raster, layout, scene, below);
    let base = layout.height as f64 - 40.0;
    axis_cross(raster, [LEFT + 18.0, base - 14.0]);
    let end = scale_bar(raster, camera, layout, [LEFT + 96.0, base]);
    let note = boundaries(scene.domain);
    if end + 24.0 + font::width(&note, 16.0) < layout.width as f64 - 24.0 {
        write(raster, [layout.width as f64 - 28.0, base], &note, 16.0, Anchor::End, SOFT_INK);
    } else {
        write(raster, [LEFT + 96.0, base + 26.0], &note, 16.0, Anchor::Start, SOFT_INK);
    }
}

fn heading(raster: &mut Raster, layout: &Layout, scene: &PictureScene<'_>) {
    let room = layout.width as f64 - LEFT - 24.0;
    let size = TITLE_SIZE.min(TITLE_SIZE * room / font::width(scene.title, TITLE_SIZE).max(1.0));
    write(raster, [LEFT, 52.0], scene.title, size, Anchor::Start, INK);
    let particles = scene.particles;
    let count = if particles.len() == 1 {
        "1 grain".to_owned()
    } else {
        format!("{} grains", ticks::grouped(particles.len()))
    };
    let mut parts = vec![count];
    if let Some(time) = scene.time_s {
        let (factor, prefix) = ticks::si_prefix(time);
        parts.push(format!("t = {} {prefix}s", trimmed(time / factor)));
    }
    let total: f64 = particles.charge.iter().map(|charge| charge.abs()).sum();
    if total > 0.0 {
        let net = particles.net_charge();
        parts.push(if net.abs() < NET_ROUNDING * total {
            "no net charge".to_owned()
        } else {
            let (factor, prefix) = ticks::si_prefix(net);
            let sign = if net > 0.0 { "+" } else { "" };
            format!("net charge {sign}{} {prefix}C", trimmed(net / factor))
        });
    }
    write(raster, [LEFT, 84.0], &parts.join("  ·  "), TEXT_SIZE, Anchor::Start, SOFT_INK);
}

/// Number in at most three significant digits, without zeros at the end.
fn trimmed(value: f64) -> String {
    let decimals = if value.abs() >= 100.0 {
        0
    } else if value.abs() >= 10.0 {
        1
    } else {
        2
    };
    let text = ticks::number(value, decimals);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Says which outlines are feeds and which are outlets, at a height and below it.
fn regions_key(raster: &mut Raster, layout: &Layout, scene: &PictureScene<'_>, top: f64) {
    let left = LEFT + layout.area[0] + 62.0;
    let entries = [("feed", scene.feeds.len(), FEED), ("outlet", scene.outlets.len(), OUTLET)];
    let there = entries.into_iter().filter(|(_, count, _)| *count > 0);
    for (row, (word, count, colour)) in (0..).zip(there) {
        let y = top + 24.0 * f64::from(row);
        raster.line(&[[left, y - 6.0], [left + 24.0, y - 6.0]], WIDTH, colour);
        let plural = if count == 1 { "" } else { "s" };
        write(raster, [left + 34.0, y], &format!("{word}{plural}"), 16.0, Anchor::Start, INK);
    }
}

/// Draws the bar; returns where there is room below it.
fn colour_bar(raster: &mut Raster, layout: &Layout, range: ChargeRange) -> f64 {
    let left = LEFT + layout.area[0] + 62.0;
    let height = (layout.area[1] * 0.62).min(420.0);
    let top = TOP + 0.5 * (layout.area[1] - height);
    if range.limit == 0.0 {
        let middle = TOP + 0.5 * layout.area[1];
        write(raster, [left - 12.0, middle], "no charge", TEXT_SIZE, Anchor::Start, SOFT_INK);
        return middle + 40.0;
    }
    let width = 24.0;
    let slices = (height * raster.fineness()) as usize;
    for slice in 0..slices {
        let part = slice as f64 / slices as f64;
        let corner = [left, top + part * height];
        raster.rectangle(
            corner,
            [width, height / slices as f64 + 1.0 / raster.fineness()],
            diverging(1.0 - 2.0 * part),
        );
    }
    let frame =
        [[left, top], [left + width, top], [left + width, top + height], [left, top + height], [left, top]];
    raster.line(&frame, 1.2, INK);
    let (factor, prefix) = ticks::si_prefix(range.limit);
    write(raster, [left - 4.0, top - 22.0], &format!("charge [{prefix}C]"), TEXT_SIZE, Anchor::Start, INK);
    let limit = range.limit / factor;
    let values = ticks::linear(-limit, limit, 8);
    let mut labels = ticks::labels(&values);
    for (label, _) in labels.iter_mut().zip(&values).filter(|(_, value)| **value > 0.0) {
        label.insert(0, '+');
    }
    // Right-aligned, so that signs stand left of a common column of digits.
    let widest = labels.iter().map(|label| font::width(label, TEXT_SIZE)).fold(0.0, f64::max);
    for (value, label) in values.iter().zip(&labels) {
        let y = top + 0.5 * height * (1.0 - value / limit);
        raster.line(&[[left + width, y], [left + width + 6.0, y]], 1.2, INK);
        write(raster, [left + width + 14.0 + widest, y + 6.5], label, TEXT_SIZE, Anchor::End, INK);
    }
    if range.some_beyond {
        write(raster, [left - 4.0, top + height + 26.0], "2 % beyond", 15.0, Anchor::Start, SOFT_INK);
    }
    top + height + 56.0
}

fn axis_cross(raster: &mut Raster, origin: [f64; 2]) {
    const LENGTH: f64 = 38.0;
    let [right, up, _] = axes();
    for axis in Axis::ALL {
        let direction = [right[axis.index()], -up[axis.index()]];
        let tip = [origin[0] + direction[0] * LENGTH, origin[1] + direction[1] * LENGTH];
        raster.line(&[origin, tip], 2.0, INK);
        let length = direction[0].hypot(direction[1]).max(1e-9);
        let label = [0, 1].map(|part| tip[part] + direction[part] / length * 12.0);
        write(raster, [label[0], label[1] + 5.0], &axis.to_string(), 16.0, Anchor::Middle, INK);
    }
}

/// A bar of a round length; returns where its text ends.
fn scale_bar(raster: &mut Raster, camera: &Camera, layout: &Layout, at: [f64; 2]) -> f64 {
    let longest = 0.24 * layout.area[0] / camera.pixels_per_metre();
    let decade = 10.0_f64.powf(longest.log10().floor());
    let length =
        [5.0, 2.0, 1.0].iter().map(|step| step * decade).find(|length| *length <= longest).unwrap_or(decade);
    let pixels = length * camera.pixels_per_metre();
    raster.rectangle([at[0], at[1] - 8.0], [pixels, 4.0], INK);
    let (factor, prefix) = ticks::si_prefix(length * (1.0 + 1e-9));
    let text = format!("{} {prefix}m", trimmed(length / factor));
    write(raster, [at[0] + pixels + 10.0, at[1]], &text, TEXT_SIZE, Anchor::Start, INK);
    at[0] + pixels + 10.0 + font::width(&text, TEXT_SIZE)
}

/// The field's boundary conditions in words: equal ones together. Potentials that change say so.
fn boundaries(domain: &Domain) -> String {
    let mut groups: Vec<(String, String)> = Vec::new();
    for axis in Axis::ALL {
        let [lower, upper] = [Side::Min, Side::Max].map(|side| {
            let changes = domain.courses().iter().any(|face| face.axis == axis && face.side == side);
            word(domain.face(axis, side)) + if changes { " now, changing" } else { "" }
        });
        let word = if lower == upper { lower } else { format!("{lower} to {upper}") };
        match groups.iter_mut().find(|(_, known)| *known == word) {
            Some((axes, _)) => axes.push_str(&format!(", {axis}")),
            None => groups.push((axis.to_string(), word)),
        }
    }
    groups.iter().map(|(axes, word)| format!("{axes} {word}")).collect::<Vec<_>>().join("  ·  ")
}

fn word(boundary: Boundary) -> String {
    match boundary {
        Boundary::Grounded => "grounded".to_owned(),
        Boundary::Potential(volts) => {
            let (factor, prefix) = ticks::si_prefix(volts);
            format!("{} {prefix}V", trimmed(volts / factor))
        }
        Boundary::Insulating { .. } => "insulating".to_owned(),
        Boundary::Periodic => "periodic".to_owned(),
        _ => "open".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::{Course, FaceCourse, Vector3};

    #[test]
    fn boundaries_are_grouped() {
        let faces = [
            [Boundary::Periodic; 2],
            [Boundary::Periodic; 2],
            [Boundary::Grounded, Boundary::Potential(2000.0)],
        ];
        let domain = Domain::new(Vector3::zeros(), Vector3::repeat(1.0), faces).unwrap();
        assert_eq!(boundaries(&domain), "x, y periodic  ·  z grounded to 2 kV");
    }

    #[test]
    fn potentials_that_change_are_said_to() {
        let mut faces = [[Boundary::Open; 2]; 3];
        faces[0] = [Boundary::Grounded, Boundary::Potential(0.0)];
        let course = Course::Sine { amplitude: 2000.0, frequency_hz: 50.0, phase: 0.0, offset: 0.0 };
        let course = FaceCourse { axis: Axis::X, side: Side::Max, course };
        let domain = Domain::new(Vector3::zeros(), Vector3::repeat(1.0), faces).unwrap();
        let mut domain = domain.with_courses(vec![course]);
        domain.set_time(5e-3);
        assert_eq!(boundaries(&domain), "x grounded to 2 kV now, changing  ·  y, z open");
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(trimmed(2.5), "2.5");
        assert_eq!(trimmed(123.4), "123");
        assert_eq!(trimmed(-0.0), "0");
    }

    #[test]
    fn flat_and_tall_boxes_leave_room_for_the_legend() {
        for extent in [Vector3::new(1.0, 1.0, 1e-3), Vector3::new(1e-3, 1e-3, 1.0)] {
            let domain = Domain::new(Vector3::zeros(), extent, [[Boundary::Open; 2]; 3]).unwrap();
            let layout = Layout::new(&domain);
            assert!(layout.width < 1200 && layout.height < 1300);
            assert!(layout.width > 500 && layout.height > 500);
        }
    }
}
