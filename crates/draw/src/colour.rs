//! Colours, and the map from charge to colour.

/// Red, green, blue, each 0 to 255 (sRGB).
pub(crate) type Colour = [u8; 3];

/// Text and lines.
pub(crate) const INK: Colour = [38, 42, 51];
/// Second-rank text.
pub(crate) const SOFT_INK: Colour = [104, 110, 122];
/// Paper.
pub(crate) const PAPER: Colour = [255, 255, 255];

/// The map's ends and middle in Oklab (lightness, green–red, blue–yellow): blue, near-white, red of equal
/// lightness.
const NEGATIVE: [f64; 3] = [0.56, -0.040, -0.155];
const NEUTRAL: [f64; 3] = [0.925, 0.0, 0.0];
const POSITIVE: [f64; 3] = [0.56, 0.175, 0.085];

/// Diverging map: −1 blue, 0 near-white, +1 red; lightness falls evenly to both sides, so that equal steps
/// of charge look equal. Values beyond ±1 have the end's colour.
pub(crate) fn diverging(value: f64) -> Colour {
    let value = if value.is_finite() { value.clamp(-1.0, 1.0) } else { 0.0 };
    let end = if value < 0.0 { NEGATIVE } else { POSITIVE };
    let weight = value.abs();
    from_oklab(std::array::from_fn(|index| NEUTRAL[index] + (end[index] - NEUTRAL[index]) * weight))
}

/// Oklab to sRGB (Ottosson, 2020).
fn from_oklab([lightness, a, b]: [f64; 3]) -> Colour {
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    let linear = [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ];
    linear.map(|value| {
        let encoded =
            if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 };
        (encoded.clamp(0.0, 1.0) * 255.0).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn map_is_blue_white_red() {
        let [red, _, blue] = diverging(-1.0);
        assert!(blue > red + 80);
        let [red, _, blue] = diverging(1.0);
        assert!(red > blue + 80);
        let [red, green, blue] = diverging(0.0);
        assert!(red.abs_diff(green) <= 1 && green.abs_diff(blue) <= 1 && red > 220);
        assert_eq!(diverging(7.0), diverging(1.0));
        assert_eq!(diverging(f64::NAN), diverging(0.0));
    }

    #[test]
    fn oklab_white_and_black_are_white_and_black() {
        assert_eq!(from_oklab([1.0, 0.0, 0.0]), [255; 3]);
        assert_eq!(from_oklab([0.0, 0.0, 0.0]), [0; 3]);
    }
}
