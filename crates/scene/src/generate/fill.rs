//! Random fill without overlaps: random sequential addition, largest grains first. Where that jams (above a
//! volume fraction of about 0.35), overlaps are removed from a random start.

use super::grid::SizeGrid;
use super::region::Region;
use super::relax::relax;
use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;

/// Number of places tried for a grain before the fill counts as jammed.
const MOST_TRIES: usize = 300;
/// Number of places tried for a grain that may overlap others, so that only walls refuse a place.
const MOST_WALL_TRIES: usize = 10_000;
/// Highest volume fraction that is tried; random packings of equal spheres jam at 0.64.
const HIGHEST_FRACTION: f64 = 0.62;
/// Share of the radii by which grains are apart, so that rounding makes no contact.
pub(super) const GAP: f64 = 1e-6;

/// Volume fraction of grains of the given radii [m] in a region, walls not subtracted.
pub(super) fn volume_fraction(region: &Region, radii: &[f64]) -> f64 {
    radii.iter().map(|radius| 4.0 / 3.0 * PI * radius.powi(3)).sum::<f64>() / region.volume()
}

/// Checks that the grains are neither too large nor too many for the region.
fn check_that_grains_fit(region: &Region, radii: &[f64]) -> Result<(), String> {
    let largest = radii.iter().copied().fold(0.0, f64::max);
    if largest > region.largest_radius() {
        return Err(format!(
            "a grain of radius {largest:e} m does not fit into the region, whose largest sphere has {:e} m; \
             make the grains smaller or the region larger",
            region.largest_radius()
        ));
    }
    let fraction = volume_fraction(region, radii);
    if fraction > HIGHEST_FRACTION {
        return Err(format!(
            "{} grains fill the fraction {fraction:.3} of the region's {:e} m3, above the {HIGHEST_FRACTION} \
             that a random fill reaches; take fewer or smaller grains, or a larger region",
            radii.len(),
            region.volume()
        ));
    }
    Ok(())
}

/// Finds centres [m] for grains of the given radii [m].
///
/// # Errors
/// A text with numbers: grains larger than the region, or volume fractions that cannot be reached.
pub(super) fn fill(
    region: &Region,
    radii: &[f64],
    random: &mut ChaCha8Rng,
) -> Result<Vec<Vector3<f64>>, String> {
    check_that_grains_fit(region, radii)?;
    let largest = radii.iter().copied().fold(0.0, f64::max);
    let smallest = radii.iter().copied().fold(f64::INFINITY, f64::min);
    let mut order: Vec<usize> = (0..radii.len()).collect();
    order.sort_by(|a, b| radii[*b].total_cmp(&radii[*a]));
    let mut grid = SizeGrid::new(region, smallest, largest, radii.len());
    let mut centres = vec![Vector3::zeros(); radii.len()];
    let mut jammed = false;

    // Large grains first: small ones still find room between them.
    for &index in &order {
        let radius = radii[index];
        let free = |point: &Vector3<f64>| {
            grid.visit_near(point, radius * (1.0 + GAP), |other| {
                let apart = (radius + radii[other]) * (1.0 + GAP);
                region.shortest(centres[other] - point).norm_squared() >= apart * apart
            })
        };
        // Once jammed, free places are not worth the search: overlaps are removed at the end.
        let found = if jammed {
            None
        } else {
            (0..MOST_TRIES).filter_map(|_| region.draw(radius, random)).find(free)
        };
        let point = match found {
            Some(point) => point,
            None => {
                jammed = true;
                (0..MOST_WALL_TRIES).find_map(|_| region.draw(radius, random)).ok_or_else(|| {
                    format!(
                        "no place in the region is a radius of {radius:e} m away from every wall; \
                         move the region or the walls"
                    )
                })?
            }
        };
        centres[index] = point;
        grid.insert(index, &point, radius);
    }

    if jammed {
        let fraction = volume_fraction(region, radii);
        relax(region, radii, &mut centres, &mut grid).map_err(|overlap| {
            format!(
                "{} grains at the volume fraction {fraction:.3} still overlap by {overlap:.1e} \
                 of their radius; take fewer or smaller grains, or a larger region",
                radii.len()
            )
        })?;
    }
    Ok(centres)
}
