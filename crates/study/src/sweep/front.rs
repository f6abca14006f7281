//! The points that no other beats.

/// Indices of the points (error, seconds) for which no other is as exact and as fast and better in one, by
/// error. Points that are not numbers are on no front.
pub(super) fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> =
        (0..points.len()).filter(|&i| points[i].0.is_finite() && points[i].1.is_finite()).collect();
    order.sort_by(|&a, &b| points[a].0.total_cmp(&points[b].0).then(points[a].1.total_cmp(&points[b].1)));
    let mut fastest = f64::INFINITY;
    order.retain(|&i| {
        let better = points[i].1 < fastest;
        fastest = fastest.min(points[i].1);
        better
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn front_has_what_nobody_beats() {
        let points =
            [(1e-2, 1.0), (1e-3, 2.0), (1e-3, 3.0), (2e-3, 2.5), (1e-1, 1.0), (f64::NAN, 0.1), (0.5, 0.5)];
        assert_eq!(front(&points), [1, 0, 6]);
        assert_eq!(front(&[]), Vec::<usize>::new());
    }
}
