//! Charges that walls are replaced by, which make the far level's boundary data smooth.
//!
//! The field is exact whatever they are. A charge at distance δ from a wall is mirrored in it with the charge
//! −q f(δ) (potential prescribed) or +q f(δ) (slope prescribed): f is 1 up to half the depth D = 4h, h the
//! size of the cells there, and falls to 0 at D as 1 − u³(10 − 15u + 6u²), u = 2δ/D − 1. In a conductor of
//! mean curvature κ it is the image of the sphere of that curvature, −q/(1 − κδ) at δ/(1 − κδ) (Jackson,
//! Classical Electrodynamics, 3rd ed., §2.2). Walls at an angle mirror each other's images, and so do two
//! walls that face each other.
//!
//! Where the solid behind a wall is thick enough, these are plain image charges, felt by every place. Where
//! an image would lie in the mesh behind a sheet or a plate, they are ghosts, felt only by the places that
//! the wall hides from them ([`ghosts`]). Near a crease, at which walls meet at an angle that is no right
//! one, a ghost has what the two faces do ([`creases`]).

mod boundary;
mod buckets;
mod creases;
mod curved;
mod edges;
mod facet_walls;
mod facets;
mod flat;
mod ghosts;
mod images;
mod mirror;
mod patch;
pub(super) mod polygon;
mod screen;
mod share;
mod smooth;
mod solid;

pub use boundary::{BoundaryFace, Condition};
pub(super) use boundary::{BoundaryFaces, Carrier};
pub(super) use buckets::Buckets;
pub(super) use facet_walls::{FacetImages, FacetWalls};
pub(super) use facets::{FacetSide, Facets};
pub(super) use ghosts::Ghosts;
pub(super) use screen::Place;

use creases::Creases;
use edges::{Edge, edges};
use ghosts::Ghost;
use images::{Images, Reflection};
use mirror::{AtEdge, Ground, Mirror};
use nalgebra::Vector3;
use smooth::{Shape, Surface, Wall, WallOfFaces};
use solid::{Surroundings, surroundings};

/// Distance into the mesh from which a place on a wall is seen, over the cell's size.
const SEEN_FROM: f64 = 0.1;

/// Largest factor of the depth up to which walls mirror charges.
pub(super) const DEEPEST: f64 = 1.4;

/// Edges and surroundings of a boundary's faces: what walls know of the boundary whatever their depth.
#[derive(Debug)]
pub(super) struct Outline {
    edges: Vec<Edge>,
    around: Vec<Surroundings>,
}

impl Outline {
    pub(super) fn new(boundary: &dyn BoundaryFaces) -> Self {
        Self { edges: edges(boundary), around: surroundings(boundary) }
    }
}

/// Charges that walls make of others.
#[derive(Debug, Default)]
pub(super) struct OfWalls {
    /// Places of the images that every place feels [m].
    pub(super) image_positions: Vec<Vector3<f64>>,
    /// Charges of these images [C].
    pub(super) image_charges: Vec<f64>,
    /// Ghosts, with their charges [C].
    pub(super) ghosts: Vec<Ghost>,
}

/// The walls of a boundary.
#[derive(Debug)]
pub(super) struct Walls {
    /// Curved ones first.
    walls: Vec<Wall>,
    /// Point of the wall at which each boundary face's condition holds [m].
    places: Vec<Place>,
    /// All creases, with the ground and the wall of each boundary face.
    creases: Creases,
    ground: Vec<Ground>,
    wall_of: Vec<u32>,
    deepest: f64,
    /// Factor of all depths.
    depth_scale: f64,
}

impl Walls {
    /// Walls of a boundary, with the radii of ghosts scaled, and the distance up to which edges matter.
    pub(super) fn new(
        boundary: &dyn BoundaryFaces,
        outline: &Outline,
        ghost_scale: f64,
        edge_scale: f64,
    ) -> Self {
        let faces = boundary.faces();
        let Outline { edges, around } = outline;
        let largest = around.iter().map(|face| face.cell).fold(0.0, f64::max);
        let reach = edge_scale.min(1.0) * mirror::LOOK_FOR_EDGES_OF_CELL * largest;
        let surface = Surface { boundary, edges, around, ghost_scale, edge_scale, reach };
        let mut at: Vec<_> = (0..faces.len()).map(|face| boundary.place_of_condition(face)).collect();
        let walls = surface.walls();
        let mut wall_of = vec![0; faces.len()];
        for (WallOfFaces { wall, faces }, number) in walls.iter().zip(0..) {
            faces.iter().for_each(|&face| wall_of[face as usize] = number);
            if let Shape::Curved(wall) = &wall.shape {
                for (index, &face) in faces.iter().enumerate() {
                    at[face as usize] = wall.place(index, &at[face as usize]);
                }
            }
        }
        let place = |(at, face): (&Vector3<f64>, usize)| {
            let into = SEEN_FROM * boundary.cell_at(face);
            Place { at: *at, seen_from: at - faces[face].normal * into }
        };
        let ground: Vec<Ground> = (0..faces.len() as u32).map(|face| surface.ground(face)).collect();
        Self {
            walls: walls.into_iter().map(|made| made.wall).collect(),
            places: at.iter().zip(0..).map(place).collect(),
            creases: Creases::new(boundary, edges, reach),
            deepest: ground.iter().map(|ground| ground.depth).fold(0.0, f64::max),
            ground,
            wall_of,
            depth_scale: 1.0,
        }
    }

    /// Point of the wall at which each boundary face's condition holds [m].
    pub(super) fn places(&self) -> &[Place] {
        &self.places
    }

    /// Mirrors charges up to so much of the usual depth, at most [`DEEPEST`].
    pub(super) fn scale_depth(&mut self, scale: f64) {
        self.depth_scale = scale;
    }

    /// Depth up to which some wall mirrors charges [m].
    pub(super) fn deepest(&self) -> f64 {
        self.depth_scale * self.deepest
    }

    /// Finds what the walls make of charges [C].
    pub(super) fn of_charges(&self, positions: &[Vector3<f64>], charges: &[f64]) -> OfWalls {
        let mut found = OfWalls::default();
        let mut images = Images::default();
        for (position, charge) in positions.iter().zip(charges).filter(|(_, charge)| **charge != 0.0) {
            self.reflect(position, &mut images);
            found.image_positions.extend(images.plain.iter().map(|image| image.at));
            found.image_charges.extend(images.plain.iter().map(|image| image.factor * charge));
            found.ghosts.extend(images.ghosts.iter().map(|ghost| ghost.with_charge(*charge)));
        }
        found
    }

    /// Finds what the walls make of a unit charge at a point: images and ghosts.
    fn reflect(&self, point: &Vector3<f64>, images: &mut Images) {
        let edge = self.edge_at(point);
        let of_walls = self.walls.iter().zip(0..).filter_map(|(wall, number)| {
            let mirror = wall.mirror(point, self.depth_scale)?;
            let of_edge = edge.as_ref().filter(|(_, walls)| walls.contains(&number));
            let share = of_edge.map_or(1.0, |(edge, _)| 1.0 - edge.share);
            Some(Reflection {
                mirror: Mirror { share: share * mirror.share, ..mirror },
                sign: wall.sign,
                is_at_edge: of_edge.is_some(),
            })
        });
        images.take(point, edge.as_ref().map(|(edge, _)| edge), of_walls);
    }

    /// The edge beside a charge at a point, and the walls that end there.
    fn edge_at(&self, point: &Vector3<f64>) -> Option<(AtEdge, [u32; 2])> {
        let crease = self.creases.nearest(point)?;
        let faces = crease.faces();
        let edge = AtEdge::new(&crease, &self.creases, &self.ground[faces[0] as usize], point)?;
        Some((edge, faces.map(|face| self.wall_of[face as usize])))
    }
}

#[cfg(test)]
mod tests;
