//! Removal of overlaps: grains that overlap push each other apart until none overlaps.

use super::fill::GAP;
use super::grid::SizeGrid;
use super::region::Region;
use nalgebra::Vector3;

/// Largest number of sweeps; a fill that still has overlaps counts as impossible.
const MOST_SWEEPS: usize = 6000;
/// Share by which radii are enlarged while grains push, so that the last overlaps vanish in finitely many
/// sweeps.
const SWELLING: f64 = 2e-3;

/// Move of one grain in a sweep.
struct Push {
    /// Index of the grain.
    grain: usize,
    /// Displacement [m].
    step: Vector3<f64>,
}

/// Moves centres [m] until no two grains overlap.
///
/// A grain is awake while it may overlap another; sleeping grains are left out of a sweep.
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
        for &Push { grain, step } in &pushed {
            centres[grain] = region.confine(centres[grain] + step, radii[grain]);
        }
    }
    Err(worst)
}

/// Wakes all grains that a pushed grain could touch at its new place.
///
/// The others have not moved and overlap no grain that moved, so nothing pushes them.
fn wake_neighbours(
    pushed: &[Push],
    radii: &[f64],
    centres: &[Vector3<f64>],
    grid: &SizeGrid,
    awake: &mut [bool],
) {
    for &Push { grain, .. } in pushed {
        grid.visit_near(&centres[grain], reach(radii[grain]), |other| {
            awake[other] = true;
            true
        });
    }
}

/// Radius [m] within which a grain of a radius [m] looks for others.
fn reach(radius: f64) -> f64 {
    radius * (1.0 + 2.0 * SWELLING)
}

/// Collects the moves that would undo each overlap of the grains that are awake, and puts those grains to
/// sleep.
///
/// Returns the largest overlap, without the enlargement, over the sum of the radii.
fn sweep(
    region: &Region,
    radii: &[f64],
    centres: &[Vector3<f64>],
    grid: &SizeGrid,
    awake: &mut [bool],
    pushed: &mut Vec<Push>,
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
                    // The heavier grain moves less. Coincident centres have no direction: they part along x.
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
        pushed.extend(own.map(|step| Push { grain: index, step }));
    }
    worst
}
