//! A picture of the bed: grains as shaded spheres, coloured by charge, in the box that bounds the field.

mod camera;
mod depth_image;
mod grains;
mod legend;
mod regions;
mod surroundings;

use crate::DrawError;
use crate::raster::Raster;
use amberfield_core::{Domain, Feed, Outlet, Particles, Wall};
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
    /// Feeds, whose regions are outlined.
    pub feeds: &'a [Feed],
    /// Outlets, whose regions are outlined.
    pub outlets: &'a [Outlet],
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
    regions::draw(&mut image, &camera, scene);
    surroundings::in_front(&mut image, &camera, scene);
    let mut raster = image.into_raster();
    legend::draw(&mut raster, &camera, &view, scene, range);
    raster
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::{
        Axis, Boundary, FeedRegion, Grain, GroupId, MaterialId, OnBlocked, OutletRegion, Side, TriangleMesh,
        Vector3, Volume,
    };

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

    fn bytes_of(particles: &Particles, feeds: &[Feed], outlets: &[Outlet]) -> Vec<u8> {
        let domain = domain();
        let time_s = Some(0.1);
        render(&PictureScene {
            title: "Test",
            time_s,
            domain: &domain,
            walls: &[],
            feeds,
            outlets,
            particles,
        })
        .bytes()
    }

    fn picture(particles: &Particles) -> Vec<u8> {
        bytes_of(particles, &[], &[])
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
    fn feeds_and_outlets_are_outlined_in_their_colours() {
        let feed = |region| Feed {
            name: "hopper".into(),
            region,
            velocity: Vector3::zeros(),
            on_blocked: OnBlocked::Wait,
            seed: 0,
        };
        let outlet = |region| Outlet { name: "bin".into(), region, each: false };
        let block = Volume::Box { min: Vector3::repeat(2e-3), max: Vector3::repeat(8e-3) };
        let corner = |x: f64, y: f64| Vector3::new(x, y, 0.025);
        let face = TriangleMesh {
            vertices: vec![
                corner(2e-3, 2e-3),
                corner(0.018, 2e-3),
                corner(0.018, 0.018),
                corner(2e-3, 0.018),
            ],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        };
        let is_near = |pixel: &[u8], colour: [u8; 3]| (0..3).all(|k| pixel[k].abs_diff(colour[k]) < 25);
        let count =
            |bytes: &[u8], colour: [u8; 3]| bytes.chunks(3).filter(|pixel| is_near(pixel, colour)).count();
        let none = Particles::default();
        let bare = picture(&none);
        assert_eq!([regions::FEED, regions::OUTLET].map(|colour| count(&bare, colour)), [0; 2]);
        for region in [FeedRegion::Volume(block.clone()), FeedRegion::Face(face)] {
            let fed = bytes_of(&none, &[feed(region)], &[]);
            assert!(count(&fed, regions::FEED) > 300 && count(&fed, regions::OUTLET) == 0);
        }
        for region in [OutletRegion::Volume(block), OutletRegion::Face(Axis::Z, Side::Min)] {
            let emptied = bytes_of(&none, &[], &[outlet(region)]);
            assert!(count(&emptied, regions::OUTLET) > 300 && count(&emptied, regions::FEED) == 0);
        }
    }

    #[test]
    fn file_is_a_png() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bed.png");
        let (domain, particles) = (domain(), Particles::default());
        let scene = PictureScene {
            title: "Empty",
            time_s: None,
            domain: &domain,
            walls: &[],
            feeds: &[],
            outlets: &[],
            particles: &particles,
        };
        write_picture(&path, &scene).unwrap();
        assert!(std::fs::read(&path).unwrap().starts_with(b"\x89PNG"));
        assert!(write_picture(&folder.path().join("no/such/folder.png"), &scene).is_err());
    }
}
