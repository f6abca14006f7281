//! Points on a boundary face's polygon.

use nalgebra::Vector3;

/// Whether a point of a face's plane lies on the face, which need not be convex, or beside it by no more than
/// `slack` [m]; corners are in order around the face.
pub(in crate::levels) fn holds(
    corners: &[Vector3<f64>],
    normal: &Vector3<f64>,
    point: &Vector3<f64>,
    slack: f64,
) -> bool {
    // Seen along the axis that the face stands most across.
    let across = normal.iamax();
    let (u, v) = ((across + 1) % 3, (across + 2) % 3);
    let mut inside = false;
    for from in 0..corners.len() {
        let (a, b) = (corners[from] - point, corners[(from + 1) % corners.len()] - point);
        let edge = b - a;
        let share = (-a.dot(&edge) / edge.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let beside = a + edge * share;
        if (beside - normal * normal.dot(&beside)).norm() <= slack {
            return true;
        }
        if (a[v] > 0.0) != (b[v] > 0.0) && a[u] + (b[u] - a[u]) * a[v] / (a[v] - b[v]) > 0.0 {
            inside = !inside;
        }
    }
    inside
}

/// Share of the way from a point of a face to another of its plane that lies on the face; corners are in
/// order around it.
pub(in crate::levels) fn share_within(
    corners: &[Vector3<f64>],
    normal: &Vector3<f64>,
    from: &Vector3<f64>,
    way: &Vector3<f64>,
) -> f64 {
    let area = |a: &Vector3<f64>, b: &Vector3<f64>| normal.dot(&a.cross(b));
    let mut share: f64 = 1.0;
    for first in 0..corners.len() {
        let corner = corners[first] - from;
        let edge = corners[(first + 1) % corners.len()] - corners[first];
        let across = area(way, &edge);
        let (along, at) = (area(&corner, &edge) / across, area(&corner, way) / across);
        if (0.0..1.0).contains(&along) && (0.0..=1.0).contains(&at) {
            share = share.min(along);
        }
    }
    share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn way_ends_at_the_first_side_of_a_face() {
        let outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.5], [0.0, 2.0]];
        let corners = outline.map(|[x, y]| Vector3::new(x, y, 3.0));
        let from = Vector3::new(0.5, 0.25, 3.0);
        for (way, expected) in
            [([0.5, 0.0], 1.0), ([-1.0, 0.0], 0.5), ([0.0, 2.0], 0.5), ([0.0, -1.0], 0.25), ([0.0, 0.0], 1.0)]
        {
            let share = share_within(&corners, &Vector3::z(), &from, &Vector3::new(way[0], way[1], 0.0));
            assert!((share - expected).abs() < 1e-12, "{way:?}: {share}");
        }
    }

    #[test]
    fn points_in_the_notch_of_a_face_are_beside_it() {
        let outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.5], [0.0, 2.0]];
        let corners = outline.map(|[x, y]| Vector3::new(x, y, 3.0));
        let on = |x: f64, y: f64| holds(&corners, &Vector3::z(), &Vector3::new(x, y, 3.0), 1e-9);
        assert!(on(1.0, 0.3) && on(0.2, 1.5) && on(1.9, 1.5) && on(2.0, 1.0) && on(1.0, 0.5));
        assert!(!on(1.0, 0.7) && !on(2.1, 1.0) && !on(1.0, -0.1));
    }
}
