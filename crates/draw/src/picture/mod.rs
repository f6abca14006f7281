//! A picture of the bed: grains as shaded spheres, coloured by charge, in the box that bounds the field.

mod camera;
mod depth_image;
mod grains;
mod legend;
mod surroundings;

use crate::DrawError;
use crate::raster::Raster;
use amberfield_core::{Domain, Particles, Wall};
use camera::Camera;
use depth_image::DepthImage;
use grains::ChargeRange;
use std::path::Path;

/// Contents of a picture.
#[derive(Clone, Copy, Debug)]
pub struct PictureScene<'a> {
    /// Heading.
    pub title: &'a str,
    /// Time [s], named below the heading when there is one.
    pub time_s: Option<f64>,
    /// The box; conductors among its faces are drawn as plates.
    pub domain: &'a Domain,
    /// Walls that grains touch; those that coincide with a face of the box are not drawn twice.
    pub walls: &'a [Wall],
    /// The grains; any number, also none.
    pub particles: &'a Particles,
}

/// Draws a scene and writes it as a PNG file.
///
/// The view is orthographic, from the front, a little from the right and above, z up. The colours' range is
/// symmetric, ± the 98th percentile of |q|, so that a few highly charged grains do not fade all others.
///
/// # Errors
/// When the file cannot be written.
pub fn write_picture(path: &Path, scene: &PictureScene<'_>) -> Result<(), DrawError> {
    render(scene).write_png(path)
}

fn render(scene: &PictureScene<'_>) -> Raster {
    let view = legend::Layout::new(scene.domain);
    let camera = Camera::new(scene.domain, view.centre, view.pixels_per_metre);
    let range = ChargeRange::new(&scene.particles.charge);
    let mut image = DepthImage::new(view.width, view.height);
    grains::draw(&mut image, &camera, scene.particles, range);
    surroundings::behind(&mut image, &camera, scene);
    surroundings::in_front(&mut image, &camera, scene);
    let mut raster = image.into_raster();
    legend::draw(&mut raster, &camera, &view, scene, range);
    raster
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::{Boundary, Grain, GroupId, MaterialId, Vector3};

    fn domain() -> Domain {
        let faces = [[Boundary::Periodic; 2], [Boundary::Periodic; 2], [Boundary::Grounded; 2]];
        Domain::new(Vector3::zeros(), Vector3::new(0.02, 0.02, 0.03), faces).unwrap()
    }

    fn grain(id: u64, position: Vector3<f64>, charge: f64) -> Grain {
        Grain {
            id,
            position,
            velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
            radius: 2e-3,
            density: 2500.0,
            charge,
            material: MaterialId(0),
            group: GroupId(0),
        }
    }

    fn picture(particles: &Particles) -> Vec<u8> {
        let domain = domain();
        render(&PictureScene { title: "Test", time_s: Some(0.1), domain: &domain, walls: &[], particles })
            .bytes()
    }

    fn strongly(bytes: &[u8], channel: usize, other: usize) -> usize {
        bytes.chunks(3).filter(|pixel| pixel[channel] > pixel[other].saturating_add(60)).count()
    }

    #[test]
    fn no_grain_no_charge_and_not_a_number_are_drawn() {
        let empty = picture(&Particles::default());
        let uncharged = picture(&Particles::from_iter([grain(1, Vector3::repeat(0.01), 0.0)]));
        assert_ne!(empty, uncharged);
        let broken = picture(&Particles::from_iter([grain(1, Vector3::repeat(f64::NAN), f64::NAN)]));
        assert_eq!(broken.len(), empty.len());
    }

    #[test]
    fn positive_grains_are_red_and_negative_ones_blue() {
        let place = Vector3::new(0.01, 0.01, 0.015);
        let none = picture(&Particles::default());
        let positive = picture(&Particles::from_iter([grain(1, place, 1e-12)]));
        let negative = picture(&Particles::from_iter([grain(1, place, -1e-12)]));
        // The colour bar has both colours already; the grain adds thousands of pixels of its own.
        assert!(strongly(&positive, 0, 2) > strongly(&negative, 0, 2) + 1000);
        assert!(strongly(&negative, 2, 0) > strongly(&positive, 2, 0) + 1000);
        assert_eq!(strongly(&none, 0, 2), 0);
    }

    #[test]
    fn file_is_a_png() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bed.png");
        let (domain, particles) = (domain(), Particles::default());
        let scene =
            PictureScene { title: "Empty", time_s: None, domain: &domain, walls: &[], particles: &particles };
        write_picture(&path, &scene).unwrap();
        assert!(std::fs::read(&path).unwrap().starts_with(b"\x89PNG"));
        assert!(write_picture(&folder.path().join("no/such/folder.png"), &scene).is_err());
    }
}
