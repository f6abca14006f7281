//! Round numbers for scales, and how numbers are written.

/// Steps that people count in.
const STEPS: [f64; 4] = [1.0, 2.0, 5.0, 10.0];

/// Round values within [low, high], at most `most` + 1 of them.
pub(crate) fn linear(low: f64, high: f64, most: usize) -> Vec<f64> {
    let raw = (high - low) / most as f64;
    if !(raw.is_finite() && raw > 0.0) {
        return vec![low];
    }
    let decade = 10.0_f64.powf(raw.log10().floor());
    let step = STEPS
        .iter()
        .map(|step| step * decade)
        .find(|step| *step >= raw * (1.0 - 1e-9))
        .unwrap_or(10.0 * decade);
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last).map(|index| index as f64 * step).collect()
}

/// Tick labels with just as many decimals as tell neighbours apart.
pub(crate) fn labels(ticks: &[f64]) -> Vec<String> {
    let step = ticks.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(f64::INFINITY, f64::min);
    let decimals =
        if step.is_finite() && step > 0.0 { (-(step.log10() + 1e-9).floor()).max(0.0) as usize } else { 2 };
    ticks.iter().map(|value| number(*value, decimals)).collect()
}

/// A number with fixed decimals and a true minus sign; never minus zero.
pub(crate) fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    if is_zero { text.trim_start_matches('-').to_owned() } else { text.replace('-', "\u{2212}") }
}

/// An integer with thin spaces between groups of three digits.
pub(crate) fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push('\u{2009}');
        }
        text.push(digit);
    }
    text
}

/// Factor and letter of the SI prefix that puts the value between 1 and 1000; (1, "") for zero.
pub(crate) fn si_prefix(value: f64) -> (f64, &'static str) {
    const PREFIXES: [(i32, &str); 11] = [
        (-24, "y"),
        (-21, "z"),
        (-18, "a"),
        (-15, "f"),
        (-12, "p"),
        (-9, "n"),
        (-6, "µ"),
        (-3, "m"),
        (0, ""),
        (3, "k"),
        (6, "M"),
    ];
    let size = value.abs();
    if size == 0.0 || !size.is_finite() {
        return (1.0, "");
    }
    let exponent = ((size.log10() / 3.0 + 1e-12).floor() as i32 * 3).clamp(-24, 6);
    let letter = PREFIXES.iter().find(|(power, _)| *power == exponent).map_or("", |(_, letter)| letter);
    (10.0_f64.powi(exponent), letter)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_ticks_are_round_and_inside() {
        assert_eq!(linear(0.0, 1.0, 5), [0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0]);
        assert_eq!(linear(-7.0, 7.0, 4), [-5.0, 0.0, 5.0]);
        assert_eq!(linear(3.0, 3.0, 4), [3.0]);
    }

    #[test]
    fn labels_tell_neighbours_apart() {
        assert_eq!(labels(&[0.0, 0.2, 0.4]), ["0.0", "0.2", "0.4"]);
        assert_eq!(labels(&[-2.0, 0.0, 2.0]), ["\u{2212}2", "0", "2"]);
    }

    #[test]
    fn zero_has_no_sign_and_minus_is_a_minus() {
        assert_eq!(number(-0.001, 1), "0.0");
        assert_eq!(number(-2.5, 1), "\u{2212}2.5");
    }

    #[test]
    fn prefixes_and_groups() {
        assert_eq!(si_prefix(2.5e-14), (1e-15, "f"));
        assert_eq!(si_prefix(1e-12).1, "p");
        assert_eq!(si_prefix(0.0), (1.0, ""));
        assert_eq!(grouped(20_000), "20\u{2009}000");
    }
}
