//! Round numbers for axes, and how they are written.

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

/// Powers of ten within [low, high], thinned to at most `most`; both ends positive.
pub(crate) fn decades(low: f64, high: f64, most: usize) -> Vec<f64> {
    let first = (low.log10() - 1e-9).ceil() as i32;
    let last = (high.log10() + 1e-9).floor() as i32;
    let stride = ((last - first).max(0) as usize / most + 1) as i32;
    (first..=last).filter(|power| power.rem_euclid(stride) == 0).map(|power| 10.0_f64.powi(power)).collect()
}

/// 1, 2 and 5 times powers of ten within [low, high]; both ends positive.
pub(crate) fn ratios(low: f64, high: f64) -> Vec<f64> {
    let first = (low.log10() - 1e-9).floor() as i32;
    let last = (high.log10() + 1e-9).floor() as i32;
    let all = (first..=last).flat_map(|power| STEPS[..3].iter().map(move |step| step * 10.0_f64.powi(power)));
    all.filter(|value| *value >= low * (1.0 - 1e-9) && *value <= high * (1.0 + 1e-9)).collect()
}

/// A round value of a logarithmic axis: plain while short, else with a power of ten.
pub(crate) fn ratio_label(value: f64) -> String {
    let exponent = (value.log10() + 1e-9).floor() as i32;
    let factor = (value / 10.0_f64.powi(exponent)).round();
    if (-2..=3).contains(&exponent) {
        number(value, (-exponent).max(0) as usize)
    } else if factor == 1.0 {
        power_of_ten(exponent)
    } else {
        format!("{factor}·{}", power_of_ten(exponent))
    }
}

/// A common power of ten for tick labels: 0 when the numbers read well as they are.
pub(crate) fn common_exponent(ticks: &[f64]) -> i32 {
    let largest = ticks.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    if largest == 0.0 || (1e-2..1e4).contains(&largest) {
        return 0;
    }
    // Engineering exponents, so that metres become millimetres and not hundredths.
    (largest.log10() / 3.0).floor() as i32 * 3
}

/// Tick labels with just as many decimals as tell neighbours apart, after division by 10^`exponent`.
pub(crate) fn labels(ticks: &[f64], exponent: i32) -> Vec<String> {
    let scaled: Vec<f64> = ticks.iter().map(|tick| tick / 10.0_f64.powi(exponent)).collect();
    let step = scaled.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(f64::INFINITY, f64::min);
    let decimals =
        if step.is_finite() && step > 0.0 { (-(step.log10() + 1e-9).floor()).max(0.0) as usize } else { 2 };
    scaled.iter().map(|value| number(*value, decimals)).collect()
}

/// A number with fixed decimals and a true minus sign; never minus zero.
pub(crate) fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    if is_zero { text.trim_start_matches('-').to_owned() } else { text.replace('-', "\u{2212}") }
}

/// 10ⁿ in raised digits.
pub(crate) fn power_of_ten(exponent: i32) -> String {
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = exponent
        .to_string()
        .chars()
        .map(|c| c.to_digit(10).map_or('⁻', |digit| digits[digit as usize]))
        .collect::<String>();
    format!("10{raised}")
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
        assert_eq!(labels(&[0.0, 0.2, 0.4], 0), ["0.0", "0.2", "0.4"]);
        assert_eq!(labels(&[-2e-3, 0.0, 2e-3], -3), ["\u{2212}2", "0", "2"]);
    }

    #[test]
    fn zero_has_no_sign_and_minus_is_a_minus() {
        assert_eq!(number(-0.001, 1), "0.0");
        assert_eq!(number(-2.5, 1), "\u{2212}2.5");
    }

    #[test]
    fn powers_and_prefixes() {
        assert_eq!(power_of_ten(-12), "10⁻¹²");
        assert_eq!(si_prefix(2.5e-14), (1e-15, "f"));
        assert_eq!(si_prefix(1e-12).1, "p");
        assert_eq!(si_prefix(0.0), (1.0, ""));
        assert_eq!(grouped(20_000), "20\u{2009}000");
    }

    #[test]
    fn ratios_are_one_two_five() {
        let values = ratios(0.5, 20.0);
        assert_eq!(values, [0.5, 1.0, 2.0, 5.0, 10.0, 20.0]);
        assert_eq!(
            values.iter().map(|value| ratio_label(*value)).collect::<Vec<_>>().join(" "),
            "0.5 1 2 5 10 20"
        );
        assert_eq!(ratio_label(2e-7), "2·10⁻⁷");
    }

    #[test]
    fn decades_are_thinned() {
        assert_eq!(decades(1e-3, 1e1, 10), [1e-3, 1e-2, 1e-1, 1.0, 1e1]);
        assert!(decades(1e-30, 1.0, 8).len() <= 9);
    }
}
