//! SVG text.

use super::{Anchor, Surface, Text};
use crate::StudyError;
use crate::colour::{Colour, PAPER, hex};
use std::fmt::Write;
use std::path::Path;

/// A drawing of a given size in pixels.
pub(crate) struct Svg {
    width: usize,
    height: usize,
    body: String,
}

impl Svg {
    /// Blank paper of the given size [px].
    pub(crate) fn new(width: usize, height: usize) -> Self {
        let mut svg = Self { width, height, body: String::new() };
        svg.rectangle([0.0, 0.0], [width as f64, height as f64], PAPER);
        svg
    }

    /// The whole file.
    pub(crate) fn text_of_file(&self) -> String {
        let Self { width, height, body } = self;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" font-family=\"Noto Sans, DejaVu Sans, Helvetica, Arial, sans-serif\">\n{body}</svg>\n"
        )
    }

    /// Writes an SVG file.
    pub(crate) fn write(&self, path: &Path) -> Result<(), StudyError> {
        std::fs::write(path, self.text_of_file())
            .map_err(|source| StudyError::Write { path: path.to_owned(), source })
    }

    fn add(&mut self, element: std::fmt::Arguments<'_>) {
        self.body.write_fmt(element).expect("writing to a string cannot fail");
        self.body.push('\n');
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

impl Surface for Svg {
    fn line(&mut self, points: &[[f64; 2]], width: f64, colour: Colour) {
        let mut list = String::new();
        for [x, y] in points {
            let gap = if list.is_empty() { "" } else { " " };
            write!(list, "{gap}{x:.2},{y:.2}").expect("writing to a string cannot fail");
        }
        self.add(format_args!(
            "<polyline points=\"{list}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{width:.2}\" stroke-linejoin=\"round\" stroke-linecap=\"round\"/>",
            hex(colour)
        ));
    }

    fn rectangle(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2], colour: Colour) {
        self.add(format_args!(
            "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" fill=\"{}\"/>",
            hex(colour)
        ));
    }

    fn disc(&mut self, [x, y]: [f64; 2], radius: f64, colour: Colour) {
        self.add(format_args!(
            "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius:.2}\" fill=\"{}\"/>",
            hex(colour)
        ));
    }

    fn text(&mut self, [x, y]: [f64; 2], text: Text<'_>) {
        let anchor = match text.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let turn =
            if text.upwards { format!(" transform=\"rotate(-90 {x:.2} {y:.2})\"") } else { String::new() };
        self.add(format_args!(
            "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{:.1}\" text-anchor=\"{anchor}\" fill=\"{}\"{turn}>{}</text>",
            text.size,
            hex(text.colour),
            escaped(text.text)
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_of_markup_in_text_are_escaped() {
        let mut svg = Svg::new(100, 50);
        svg.text(
            [1.0, 2.0],
            Text { text: "a<b & c", size: 10.0, anchor: Anchor::End, colour: [0; 3], upwards: false },
        );
        let file = svg.text_of_file();
        assert!(file.contains(">a&lt;b &amp; c</text>") && file.ends_with("</svg>\n"));
    }
}
