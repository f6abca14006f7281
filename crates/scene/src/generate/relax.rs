//! Overlap removal: grains that overlap push each other apart until none does.

use super::fill::GAP;
use super::grid::SizeGrid;
use super::region::Region;
use nalgebra::Vector3;

/// Sweeps before the fill counts as impossible.
const MOST_SWEEPS: usize = 6000;
/// Grains push as if they were this share larger, so that the last overlaps vanish in finitely many sweeps.
const SWELLING: f64 = 2e-3;

/// Moves centres until no two grains overlap.
///
/// # Errors
/// The largest overlap that is left, over the sum of the radii.
pub(super) fn relax(
    region: &Region,
    radii: &[f64],
    centres: &mut [Vector3<f64>],
    grid: &mut SizeGrid,
) -> Result<(), f64> {
    let mut moves = vec![Vector3::zeros(); centres.len()];
    let mut worst = f64::INFINITY;
    for _ in 0..MOST_SWEEPS {
        worst = sweep(region, radii, centres, grid, &mut moves);
        if worst <= 0.0 {
            return Ok(());
        }
        for ((centre, step), radius) in centres.iter_mut().zip(&moves).zip(radii) {
            *centre = region.confine(*centre + step, *radius);
        }
    }
    Err(worst)
}

/// Collects the moves that would undo each overlap; returns the largest true overlap over the sum of the radii.
fn sweep(
    region: &Region,
    radii: &[f64],
    centres: &[Vector3<f64>],
    grid: &mut SizeGrid,
    moves: &mut [Vector3<f64>],
) -> f64 {
    moves.fill(Vector3::zeros());
    grid.clear();
    for (index, (centre, radius)) in centres.iter().zip(radii).enumerate() {
        grid.insert(index, centre, *radius);
    }
    let mut worst: f64 = 0.0;
    for (index, (centre, radius)) in centres.iter().zip(radii).enumerate() {
        let mut own = Vector3::zeros();
        grid.visit_near(centre, radius * (1.0 + 2.0 * SWELLING), |other| {
            if other != index {
                let sum = radius + radii[other];
                let apart = region.shortest(centre - centres[other]);
                let distance = apart.norm();
                let overlap = sum * (1.0 + SWELLING) - distance;
                if overlap > 0.0 {
                    worst = worst.max(1.0 + GAP - distance / sum);
                    // Larger grains move less; coincident centres part along an axis, each its own way.
                    let (own_weight, other_weight) = (radius.powi(3), radii[other].powi(3));
                    let share = other_weight / (own_weight + other_weight);
                    let away = if distance > 0.0 {
                        apart / distance
                    } else {
                        Vector3::x() * if index < other { 1.0 } else { -1.0 }
                    };
                    own += away * (share * overlap);
                }
            }
            true
        });
        moves[index] = own;
    }
    worst
}
