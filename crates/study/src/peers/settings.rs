//! Settings of the other programs that are swept, and the choice of the fastest.

use super::Script;

/// Cut-offs [diameters] and orders of a sweep over LAMMPS' settings, with commas.
#[must_use]
pub fn pppm_sweep(tolerance: f64) -> (&'static str, &'static str) {
    match tolerance {
        t if t > 2e-3 => ("1.5,2,2.5,3,4", "4,5"),
        t if t > 2e-4 => ("2,2.5,3,4", "5,6"),
        t if t > 2e-5 => ("2.5,3,4,5", "5,6"),
        _ => ("4,5,6,7", "7"),
    }
}

/// Shares of a tolerance asked of LAMMPS, whose estimate of its error is not its error.
pub const SHARES: &str = "0.8,1.1";

/// The line with the shortest time among those of the script's width whose error is at most a tolerance.
#[must_use]
pub fn fastest(script: Script, lines: &[Vec<f64>], tolerance: f64) -> Option<&[f64]> {
    let (width, error, seconds) = match script {
        Script::LammpsDem | Script::LammpsRest => (2, None, 1),
        Script::LammpsBed => (6, None, 3),
        Script::LammpsField => (7, Some(4), 5),
        Script::Fmm3d => (3, Some(1), 2),
    };
    let meets = |line: &&Vec<f64>| line.len() == width && error.is_none_or(|error| line[error] <= tolerance);
    lines.iter().filter(meets).min_by(|a, b| a[seconds].total_cmp(&b[seconds])).map(Vec::as_slice)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fastest_line_meets_the_tolerance() {
        let lines = [vec![0.1, 2e-2, 1.0], vec![0.01, 5e-3, 3.0], vec![0.001, 1e-3, 2.0], vec![1.0]];
        assert_eq!(fastest(Script::Fmm3d, &lines, 1e-2), Some(&[0.001, 1e-3, 2.0][..]));
        assert_eq!(fastest(Script::Fmm3d, &lines, 1e-4), None);
    }
}
