//! Orthographic projection.

use amberfield_core::{Domain, Vector3};

/// Turn of the viewer around z, from the front (−y) towards +x [degrees].
const AZIMUTH_DEGREES: f64 = 27.0;
/// Height of the viewer over the horizon [degrees].
const ELEVATION_DEGREES: f64 = 17.0;

/// Unit vectors of the view: right, up, towards the viewer.
pub(super) fn axes() -> [Vector3<f64>; 3] {
    let (sine, cosine) = AZIMUTH_DEGREES.to_radians().sin_cos();
    let (rise, level) = ELEVATION_DEGREES.to_radians().sin_cos();
    [
        Vector3::new(cosine, sine, 0.0),
        Vector3::new(-rise * sine, rise * cosine, level),
        Vector3::new(level * sine, -level * cosine, rise),
    ]
}

/// The eight corners of a box, bit k of the number choosing the upper end of axis k.
pub(super) fn corners(min: &Vector3<f64>, max: &Vector3<f64>) -> [Vector3<f64>; 8] {
    std::array::from_fn(|number| {
        Vector3::from_fn(|axis, _| if number >> axis & 1 == 1 { max[axis] } else { min[axis] })
    })
}

/// Width and height that a box covers in the view [m].
pub(super) fn span(domain: &Domain) -> [f64; 2] {
    let [right, up, _] = axes();
    [right, up].map(|axis| domain.extent().component_mul(&axis.abs()).sum())
}

/// Metres to pixels.
pub(super) struct Camera {
    axes: [Vector3<f64>; 3],
    target: Vector3<f64>,
    centre: [f64; 2],
    pixels_per_metre: f64,
}

impl Camera {
    /// Looks at the centre of the box, which appears at the pixel `centre`.
    pub(super) fn new(domain: &Domain, centre: [f64; 2], pixels_per_metre: f64) -> Self {
        Self { axes: axes(), target: domain.centre(), centre, pixels_per_metre }
    }

    /// Pixel column, pixel row and nearness (in pixels, greater is nearer) of a point [m].
    pub(super) fn project(&self, point: &Vector3<f64>) -> [f64; 3] {
        let offset = (point - self.target) * self.pixels_per_metre;
        let [right, up, near] = self.axes.map(|axis| axis.dot(&offset));
        [self.centre[0] + right, self.centre[1] - up, near]
    }

    /// Pixels for a metre across the view.
    pub(super) fn pixels_per_metre(&self) -> f64 {
        self.pixels_per_metre
    }

    /// Whether a face with this outward normal shows its outside.
    pub(super) fn sees_outside(&self, normal: &Vector3<f64>) -> bool {
        self.axes[2].dot(normal) > 0.0
    }

    /// Cosine between a normal and the direction of the light, which comes from above the viewer's left
    /// shoulder.
    pub(super) fn light_on(&self, normal: &Vector3<f64>) -> f64 {
        let in_view = self.axes.map(|axis| axis.dot(normal));
        in_view.iter().zip(super::depth_image::LIGHT).map(|(a, b)| a * b).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_orthonormal_and_right_handed() {
        let [right, up, near] = axes();
        assert!((right.cross(&up) - near).norm() < 1e-15);
        assert!(up.z > 0.9 && near.y < 0.0, "z is up, the viewer stands in front");
    }
}
