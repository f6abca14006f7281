//! Grains that lie together across a periodic face, put side by side.

use amberfield_core::{Axis, Domain};
use nalgebra::Vector3;

/// Pieces of a period among which empty ones are looked for.
const PIECES: usize = 128;

/// Moves positions inside the domain [m] by one period where they then lie in a smaller box: along each
/// periodic axis the widest gap between them comes to lie outside.
pub(crate) fn uncut(domain: &Domain, positions: &mut [Vector3<f64>]) {
    for axis in Axis::ALL.into_iter().filter(|&axis| domain.is_periodic(axis)) {
        let axis = axis.index();
        let (low, length) = (domain.min()[axis], domain.extent()[axis]);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below the pieces")]
        let piece = |at: f64| (((at - low) / length * PIECES as f64).max(0.0) as usize).min(PIECES - 1);
        let mut is_full = [false; PIECES];
        for position in positions.iter() {
            is_full[piece(position[axis])] = true;
        }
        let Some(cut) = end_of_widest_gap(&is_full) else { continue };
        for position in positions.iter_mut().filter(|position| piece(position[axis]) < cut) {
            position[axis] += length;
        }
    }
}

/// The full piece behind the longest run of empty ones, which may go on over the end; `None` without a run.
fn end_of_widest_gap(is_full: &[bool; PIECES]) -> Option<usize> {
    let full: Vec<usize> = (0..PIECES).filter(|&piece| is_full[piece]).collect();
    let gap = |(number, &piece): (usize, &usize)| {
        let before = if number > 0 { full[number - 1] } else { *full.last().expect("there is one") };
        ((piece + PIECES - before - 1) % PIECES, piece)
    };
    let widest = full.iter().enumerate().map(gap).max_by_key(|(width, piece)| (*width, PIECES - piece));
    widest.filter(|(width, _)| *width > 0).map(|(_, piece)| piece)
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::Boundary;

    fn moved(at: &[f64]) -> Vec<f64> {
        let domain = Domain::new(Vector3::repeat(1.0), Vector3::repeat(3.0), [[Boundary::Periodic; 2]; 3]);
        let mut positions: Vec<_> = at.iter().map(|&x| Vector3::new(x, 2.0, 2.0)).collect();
        uncut(&domain.unwrap(), &mut positions);
        positions.iter().map(|position| position.x).collect()
    }

    #[test]
    fn grains_on_both_sides_of_a_face_come_together() {
        assert_eq!(moved(&[1.1, 2.9, 2.8, 1.0]), [3.1, 2.9, 2.8, 3.0]);
    }

    #[test]
    fn grains_that_lie_together_or_everywhere_stay() {
        assert_eq!(moved(&[1.1, 1.5, 1.9]), [1.1, 1.5, 1.9]);
        assert_eq!(moved(&[2.999]), [2.999]);
        let everywhere: Vec<f64> = (0..1000).map(|i| 1.0 + 0.002 * f64::from(i)).collect();
        assert_eq!(moved(&everywhere), everywhere);
        assert!(moved(&[]).is_empty());
    }
}
