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
    let mut worst = f64::INFINITY;
    let mut pushed = Vec::new();
    let mut awake = vec![true; radii.len()];
    for _ in 0..MOST_SWEEPS {
        grid.clear();
        for (index, (centre, radius)) in centres.iter().zip(radii).enumerate() {
            grid.insert(index, centre, *radius);
        }
        wake_neighbours(&pushed, radii, centres, grid, &mut awake);
        worst = sweep(region, radii, centres, grid, &mut awake, &mut pushed);
        if worst <= 0.0 {
            return Ok(());
        }
        for &(index, step) in &pushed {
            centres[index] = region.confine(centres[index] + step, radii[index]);
        }
    }
    Err(worst)
}

/// Wakes all that a pushed grain could touch where it is now. The others are as they were: nobody pushes them.
fn wake_neighbours(
    pushed: &[(usize, Vector3<f64>)],
    radii: &[f64],
    centres: &[Vector3<f64>],
    grid: &SizeGrid,
    awake: &mut [bool],
) {
    for &(index, _) in pushed {
        grid.visit_near(&centres[index], reach(radii[index]), |other| {
            awake[other] = true;
            true
        });
    }
}

/// Radius [m] with which a grain looks for others.
fn reach(radius: f64) -> f64 {
    radius * (1.0 + 2.0 * SWELLING)
}

/// Collects the moves that would undo each overlap of the grains that are awake, who sleep again; returns the
/// largest true overlap over the sum of the radii.
fn sweep(
    region: &Region,
    radii: &[f64],
    centres: &[Vector3<f64>],
    grid: &SizeGrid,
    awake: &mut [bool],
    pushed: &mut Vec<(usize, Vector3<f64>)>,
) -> f64 {
    pushed.clear();
    let mut worst: f64 = 0.0;
    for (index, (centre, radius)) in centres.iter().zip(radii).enumerate() {
        if !std::mem::take(&mut awake[index]) {
            continue;
        }
        let mut own = None;
        grid.visit_near(centre, reach(*radius), |other| {
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
                    *own.get_or_insert_with(Vector3::zeros) += away * (share * overlap);
                }
            }
            true
        });
        pushed.extend(own.map(|step| (index, step)));
    }
    worst
}
