//! Walls of facets, for a level whose unknowns are charges on the facets themselves.
//!
//! A charge has plain images in them: one in each wall near it; two walls at about a right angle make a
//! third, and three walls seven. Each fades away as −q f(δ/D), D = 2h with h the size of the facets, or less
//! where another wall is near, before or behind; and with the distance e of its foot from a rim, by
//! 1 − f(½ + ½ min(e/(2δ), 1)). The charge of the facets makes up for whatever images leave.

use super::boundary::{BoundaryFaces, Carrier};
use super::facets::{FacetSide, Facets};
use super::images::{Images, Reflection};
use super::smooth::{Shape, Surface, Wall};
use super::{Outline, mirror};
use nalgebra::Vector3;

/// Walls of facets.
#[derive(Debug)]
pub(in crate::levels) struct FacetWalls {
    walls: Vec<Wall>,
    /// Height of the surface over each facet [m].
    heights: Vec<f64>,
    deepest: f64,
}

/// Images of one charge in walls of facets, and what is needed to find them.
#[derive(Debug)]
pub(in crate::levels) struct FacetImages {
    reflections: Vec<Reflection>,
    images: Images,
}

impl Default for FacetImages {
    fn default() -> Self {
        Self { reflections: Vec::new(), images: Images::new(Carrier::Facets) }
    }
}

impl FacetWalls {
    /// Walls that facets make.
    pub(in crate::levels) fn new(facets: &Facets) -> Self {
        let Outline { edges, around } = &Outline::new(facets);
        let largest = around.iter().map(|face| face.cell).fold(0.0, f64::max);
        let reach = mirror::LOOK_FOR_RIMS_OF_CELL * largest;
        let surface = Surface { boundary: facets, edges, around, ghost_scale: 1.0, edge_scale: 1.0, reach };
        let made = surface.walls();
        let mut heights = vec![0.0; facets.count()];
        for wall in &made {
            let Shape::Curved(curved) = &wall.wall.shape else { continue };
            for (index, &face) in wall.faces.iter().enumerate() {
                // Both sides say where the surface is, each along its own normal.
                let FacetSide { facet, is_front } = FacetSide::of_face(face);
                heights[facet] += if is_front { -0.5 } else { 0.5 } * curved.height(index);
            }
        }
        let depths = (0..facets.faces().len() as u32).map(|face| surface.ground(face).depth);
        let deepest = depths.fold(0.0, f64::max);
        Self { walls: made.into_iter().map(|made| made.wall).collect(), heights, deepest }
    }

    /// Height of the curved surface over each facet's centroid, along the normal about which the facet's
    /// corners turn anticlockwise [m]; 0 where the wall is flat. A facet moved by it lies as much before the
    /// surface as behind it.
    pub(in crate::levels) fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// Depth up to which some wall mirrors charges [m].
    pub(in crate::levels) fn deepest(&self) -> f64 {
        self.deepest
    }

    /// Finds the images of a charge [C] at a position: their places [m] and charges [C]. Sides of facets that
    /// are not allowed to mirror it do not, such as those of a sheet with grains behind it.
    pub(in crate::levels) fn plain_images(
        &self,
        position: &Vector3<f64>,
        charge: f64,
        is_allowed: impl Fn(FacetSide) -> bool,
        found: &mut FacetImages,
    ) -> impl Iterator<Item = (Vector3<f64>, f64)> {
        let FacetImages { reflections, images } = found;
        reflections.clear();
        let mirrors = self.walls.iter().filter_map(|wall| {
            let mirror = wall.mirror(position, 1.0)?;
            let is_allowed = mirror.face.is_some_and(|face| is_allowed(FacetSide::of_face(face)));
            is_allowed.then_some(Reflection { mirror, sign: wall.sign, is_at_edge: false })
        });
        reflections.extend(mirrors);
        // Nearest first, whatever the order of the facets.
        reflections.sort_unstable_by(|a, b| {
            let by_normal = || {
                let pairs = a.mirror.normal.iter().zip(&b.mirror.normal);
                pairs.fold(std::cmp::Ordering::Equal, |order, (a, b)| order.then(a.total_cmp(b)))
            };
            a.mirror.distance.total_cmp(&b.mirror.distance).then_with(by_normal)
        });
        images.take(position, None, reflections.iter().copied());
        images.plain.iter().map(move |image| (image.at, image.factor * charge))
    }
}

#[cfg(test)]
mod tests;
