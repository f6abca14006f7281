//! The grains and the range of their colours.

use super::camera::Camera;
use super::depth_image::DepthImage;
use crate::colour::diverging;
use amberfield_core::Particles;

/// Share of grains whose |q| lies within the range of the colours.
const WITHIN_RANGE: f64 = 0.98;
/// Darkness of the deepest gaps.
const GAP_DARKNESS: f64 = 0.85;

/// Symmetric range of the colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ChargeRange {
    /// Charge with the full colour [C]; 0 when no grain has a charge.
    pub(super) limit: f64,
    /// Whether some grains lie beyond the limit.
    pub(super) some_beyond: bool,
}

impl ChargeRange {
    pub(super) fn new(charges: &[f64]) -> Self {
        let mut sizes: Vec<f64> =
            charges.iter().map(|charge| charge.abs()).filter(|size| size.is_finite()).collect();
        sizes.sort_by(f64::total_cmp);
        let largest = sizes.last().copied().unwrap_or(0.0);
        let rank = ((sizes.len() as f64 * WITHIN_RANGE).ceil() as usize).clamp(1, sizes.len().max(1)) - 1;
        let limit = sizes.get(rank).copied().filter(|limit| *limit > 0.0).unwrap_or(largest);
        Self { limit, some_beyond: largest > limit }
    }

    /// −1 to 1 within the range.
    fn relative(self, charge: f64) -> f64 {
        if self.limit > 0.0 { charge / self.limit } else { 0.0 }
    }
}

/// Draws every grain as a sphere.
pub(super) fn draw(image: &mut DepthImage, camera: &Camera, particles: &Particles, range: ChargeRange) {
    let scale = camera.pixels_per_metre();
    for index in 0..particles.len() {
        let centre = camera.project(&particles.position[index]);
        let colour = diverging(range.relative(particles.charge[index]));
        image.sphere(centre, particles.radius[index] * scale, colour);
    }
    let mut radii = particles.radius.clone();
    if !radii.is_empty() {
        let middle = radii.len() / 2;
        let (_, median, _) = radii.select_nth_unstable_by(middle, f64::total_cmp);
        image.occlude(1.6 * *median * scale, GAP_DARKNESS);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_large_charges_do_not_set_the_range() {
        let mut charges = vec![1.0; 99];
        charges.push(-50.0);
        assert_eq!(ChargeRange::new(&charges), ChargeRange { limit: 1.0, some_beyond: true });
    }

    #[test]
    fn one_charged_grain_among_many_is_still_seen() {
        let mut charges = vec![0.0; 99];
        charges.push(-2.0);
        assert_eq!(ChargeRange::new(&charges).limit, 2.0);
    }

    #[test]
    fn no_charge_has_no_range() {
        assert_eq!(ChargeRange::new(&[]).limit, 0.0);
        assert_eq!(ChargeRange::new(&[0.0, 0.0]).relative(0.0), 0.0);
    }
}
