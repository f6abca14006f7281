//! The built-in font: Noto Sans (SIL Open Font License 1.1).

use ab_glyph::{Font, FontRef, Glyph, PxScale, ScaleFont, point};

fn font() -> FontRef<'static> {
    FontRef::try_from_slice(notosans::REGULAR_TTF).expect("the built-in font is a valid TrueType font")
}

/// Width of a text at the given em size, in the unit of the size.
pub(crate) fn width(text: &str, size: f64) -> f64 {
    let mut end = 0.0_f64;
    place(&font(), text, size, |_, advance| end = advance);
    end
}

/// Calls `paint(x, y, coverage)` for every pixel of a text that starts at the origin of its baseline.
pub(crate) fn rasterise(text: &str, size: f64, mut paint: impl FnMut(f64, f64, f64)) {
    let font = font();
    place(&font, text, size, |glyph, _| {
        if let Some(outline) = font.outline_glyph(glyph) {
            let bounds = outline.px_bounds();
            outline.draw(|column, row, coverage| {
                let (x, y) = (bounds.min.x + column as f32, bounds.min.y + row as f32);
                paint(f64::from(x), f64::from(y), f64::from(coverage));
            });
        }
    });
}

/// Calls `visit(glyph, end)` for every glyph in reading order.
fn place(font: &FontRef<'_>, text: &str, size: f64, mut visit: impl FnMut(Glyph, f64)) {
    let scaled = font.as_scaled(scale(font, size));
    let mut x = 0.0;
    let mut previous = None;
    for character in text.chars() {
        let glyph = scaled.glyph_id(character);
        if let Some(previous) = previous {
            x += f64::from(scaled.kern(previous, glyph));
        }
        let end = x + f64::from(scaled.h_advance(glyph));
        visit(glyph.with_scale_and_position(scaled.scale, point(x as f32, 0.0)), end);
        x = end;
        previous = Some(glyph);
    }
}

/// The font's own scale for an em of `size` pixels.
fn scale(font: &FontRef<'_>, size: f64) -> PxScale {
    let units = font.units_per_em().map_or(1.0, |units| font.height_unscaled() / units);
    PxScale::from(size as f32 * units)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sign_that_labels_use_has_a_glyph() {
        let font = font();
        for character in "0123456789\u{2212}+\u{2009}·µ%[].".chars() {
            assert_ne!(font.glyph_id(character).0, 0, "no glyph for {character:?}");
        }
    }

    #[test]
    fn width_grows_with_text_and_size() {
        assert!(width("charge", 20.0) > width("char", 20.0));
        assert!((width("charge", 40.0) / width("charge", 20.0) - 2.0).abs() < 1e-3);
        assert_eq!(width("", 20.0), 0.0);
    }
}
