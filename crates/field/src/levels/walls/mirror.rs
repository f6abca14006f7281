//! Mirror that a wall is for one charge near it, and whether an image can lie behind the wall.

use super::boundary::Carrier;
use super::creases::{Creases, NearCrease};
use super::screen::{EdgeScreen, Screen};
use super::solid::Surroundings;
use nalgebra::Vector3;

/// Depth up to which walls mirror charges, over the cell size.
const DEPTH_OF_CELL: f64 = 4.0;
/// Radii up to which ghosts are felt, over the cell size: before endless screens, and at edges.
const RADIUS_OF_CELL: f64 = 4.0;
const RADIUS_AT_EDGE_OF_CELL: f64 = 5.5;
/// Distance from an edge up to which it takes the place of the planes beside it, over the cell size, and the
/// part of it from which on it does so less and less.
const AT_EDGE_OF_CELL: f64 = 3.5;
const WHOLE_AT_EDGE: f64 = 0.65;
/// Distance up to which edges are looked for, over the cell size.
pub(super) const LOOK_FOR_EDGES_OF_CELL: f64 = 10.5;
/// Distance up to which rims are looked for, over the cell size, where facets carry the field.
pub(super) const LOOK_FOR_RIMS_OF_CELL: f64 = FROM_RIM[1] * DEPTH_OF_CELL;
/// Solid between an image and the mesh behind it at least, over the image's depth and over the cell size.
const BEHIND_OF_DEPTH: f64 = 1.0;
const BEHIND_OF_CELL: f64 = 1.5;
/// Distances of a second rim, over the charge's from an edge, between which the edge's own faces reflect more
/// and more.
const FADE: [f64; 2] = [1.0, 3.0];
/// Distance up to which walls are straight over a charge's distance from the edge, between which the edge
/// takes the place of the planes beside it.
const BENT: [f64; 2] = [1.0, 2.0];
/// Distance up to which walls are straight over the cell size, likewise: cells have to carry what ends there.
const BENT_OF_CELL: [f64; 2] = [2.0, 4.0];
/// Thickness of a plate over a charge's distance from its edge, between which its other edge is forgotten.
const FAR_EDGE: [f64; 2] = [2.5, 4.0];
/// Height of a charge above a sheet in a body's place over its distance into it, between which the sheet
/// comes into being: where the body's face bends away, a charge can be in the sheet.
const BEFORE_SHEET: [f64; 2] = [0.02, 0.1];
/// Radius of ghosts over the usual one, between which they come into being: cells cannot carry small ones.
const LEAST_RADIUS: [f64; 2] = [0.3, 0.6];
/// Height before a tip's plane below which a charge is beside the tip, over its distance from the edge.
const ON_FACE: f64 = 1e-6;
/// Thickness of a plate over a charge's distance from its edge, between which the plate's edges take the
/// place of a sheet's.
const THICK: [f64; 2] = [0.4, 1.2];

/// Depth at most over the distance of the wall across, and over the thickness of the solid, where facets
/// carry the field: no image is nearer to other facets than to its own.
const OF_GAP: f64 = 0.5;
const OF_SOLID: f64 = 0.5;
/// Distance of a charge's foot from a rim over the charge's own from the wall, between which images come into
/// being where facets carry the field: the charge of a wall gathers at its rim.
const FROM_RIM: [f64; 2] = [0.0, 2.0];

/// Wall below a charge's foot: how deep it mirrors, and what is behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ground {
    /// Carrier of the field that images leave.
    pub(super) carrier: Carrier,
    /// Size of the cells [m].
    pub(super) cell: f64,
    /// Thickness of the solid [m].
    pub(super) solid: f64,
    /// Deepest charge that is mirrored [m].
    pub(super) depth: f64,
    /// Radii up to which ghosts are felt: before endless screens, and at edges [m].
    pub(super) radius: f64,
    pub(super) radius_at_edge: f64,
    /// Distance from an edge up to which it takes the place of planes [m].
    pub(super) at_edge: f64,
}

impl Ground {
    /// The ground at a boundary face, with ghosts' radii and the reach of edges scaled.
    pub(super) fn new(around: &Surroundings, carrier: Carrier, ghost_scale: f64, edge_scale: f64) -> Self {
        let depth = DEPTH_OF_CELL * around.cell;
        let depth = match carrier {
            Carrier::Cells => depth,
            Carrier::Facets => depth.min(OF_GAP * around.gap).min(OF_SOLID * around.solid),
        };
        Self {
            carrier,
            cell: around.cell,
            solid: around.solid,
            depth,
            radius: ghost_scale * RADIUS_OF_CELL * around.cell,
            radius_at_edge: ghost_scale * RADIUS_AT_EDGE_OF_CELL * around.cell,
            at_edge: edge_scale.min(1.0) * AT_EDGE_OF_CELL * around.cell,
        }
    }

    /// Ground that mirrors deeper, or less deep.
    pub(super) fn deeper(&self, scale: f64) -> Self {
        Self { depth: scale * self.depth, ..*self }
    }

    /// Whether another place of the wall is the same for all purposes.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        /// Relative difference of cells that are one size.
        const SAME: f64 = 1e-6;
        let thick = |ground: &Self| ground.is_safe(ground.depth);
        (self.cell - other.cell).abs() < SAME * self.cell && thick(self) && thick(other)
    }

    /// Whether an image at some depth [m] lies well inside the solid.
    fn is_safe(&self, image_depth: f64) -> bool {
        self.solid - image_depth >= (BEHIND_OF_DEPTH * image_depth).max(BEHIND_OF_CELL * self.cell)
    }
}

/// Mirror that a wall is for a charge: the tangent plane, the charge's distance and the wall's curvature
/// there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mirror {
    /// Face of the boundary under the charge; `None` where all of the wall is alike.
    pub(super) face: Option<u32>,
    pub(super) normal: Vector3<f64>,
    pub(super) offset: f64,
    pub(super) distance: f64,
    /// Mean curvature towards the charge [1/m].
    pub(super) curvature: f64,
    /// Deepest charge that is mirrored [m].
    pub(super) depth: f64,
    /// Share of the images that is left where an edge takes their place.
    pub(super) share: f64,
    /// The screen that the wall is, where no image can lie behind it.
    pub(super) screened: Option<Screened>,
}

/// Screen before which a charge has ghosts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Screened {
    pub(super) screen: Screen,
    pub(super) extent: Extent,
}

/// Radius up to which a ghost is felt [m], and over the cell size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub(crate) radius: f64,
    pub(crate) cells: f64,
}

/// Edges beside a charge: what their faces do, each with its share, in the place of planes.
#[derive(Clone, Copy, Debug)]
pub(super) struct AtEdge {
    pub(super) screens: [Option<(EdgeScreen, f64)>; 5],
    pub(super) extent: Extent,
    /// Share of what the edges do, and not the planes beside them.
    pub(super) share: f64,
}

impl AtEdge {
    /// The edge at a crease near a charge at a point, over some ground; `None` where it is too far.
    pub(super) fn new(
        crease: &NearCrease,
        creases: &Creases,
        ground: &Ground,
        point: &Vector3<f64>,
    ) -> Option<Self> {
        let least = crease.distance.max(f64::MIN_POSITIVE);
        let near = 1.0 - step(crease.distance / ground.at_edge, [WHOLE_AT_EDGE, 1.0]);
        if near == 0.0 {
            return None;
        }
        let straight =
            step(crease.straight() / least, BENT) * step(crease.straight() / ground.cell, BENT_OF_CELL);
        let other = creases.other_rim(point, crease);
        let (straight, bent) = (near * straight, near * (1.0 - straight));
        let over = other.map_or(f64::INFINITY, |other| other.distance / least);
        let sheet = crease.sheet(point).map(|screen| {
            let bent = bent * step(screen.steepness(point), BEFORE_SHEET);
            (screen, bent * step(over, FADE))
        });
        let own = crease.screen();
        let tip = other.and_then(|other| crease.tip(&other, point));
        let screens = match tip {
            // A thick plate's edges each for itself, and the plane between them is there once; a thin plate
            // is a sheet.
            Some(tip) => {
                let over = tip.thickness / least;
                let thick = straight * step(over, THICK);
                let height = tip.plane.up.dot(&(point - tip.plane.point));
                let both = (height > ON_FACE * crease.distance).then(|| thick * (1.0 - step(over, FAR_EDGE)));
                [
                    Some((own, thick)),
                    both.map(|share| (tip.other, share)),
                    both.map(|share| (tip.plane, -share)),
                    Some((tip.sheet, straight - thick)),
                    sheet,
                ]
            }
            None => [Some((own, straight * step(over, FADE))), None, None, None, sheet],
        };
        let radius = ground.radius_at_edge;
        let share = screens.iter().flatten().map(|(_, share)| share).sum();
        Some(Self { screens, extent: Extent { radius, cells: radius / ground.cell }, share })
    }
}

impl Mirror {
    /// Whether two mirrors of a charge are one plane, seen from the same side.
    pub(super) fn is_same_plane(&self, other: &Self) -> bool {
        /// Difference of normals, and of distances over a distance, of one plane.
        const SAME: f64 = 1e-6;
        let apart = (self.distance - other.distance).abs();
        (self.normal - other.normal).norm() < SAME && apart < SAME * self.distance.max(f64::MIN_POSITIVE)
    }

    /// Whether this wall stands before another that looks the same way, so that the charge does not see that
    /// one's foot.
    pub(super) fn hides(&self, other: &Self) -> bool {
        /// Cosine of the angle of walls that look the same way.
        const SAME_WAY: f64 = 0.9;
        let along = self.normal.dot(&other.normal);
        along > SAME_WAY && along * other.distance > self.distance * (1.0 + 1e-6)
    }

    /// Whether this wall and another stand at an angle near a right one.
    pub(super) fn is_across(&self, other: &Self, carrier: Carrier) -> bool {
        self.normal.dot(&other.normal).abs() < carrier.across()
    }

    /// Charge of the image over the charge's, but for the sign and the curvature, at a distance [m].
    pub(super) fn fade(&self, distance: f64) -> f64 {
        self.share * (1.0 - smooth_step(2.0 * distance / self.depth - 1.0))
    }

    /// Charge of the image over the charge's, but for the sign.
    pub(super) fn factor(&self) -> f64 {
        self.fade(self.distance) / (1.0 - self.curvature * self.distance)
    }

    /// The image of the charge itself.
    pub(super) fn image(&self, point: &Vector3<f64>) -> Vector3<f64> {
        point + self.normal * (self.distance + self.distance / (1.0 - self.curvature * self.distance))
    }

    /// The image of another wall's image, in the plane.
    pub(super) fn again(&self, point: &Vector3<f64>) -> Vector3<f64> {
        point + self.normal * (2.0 * self.distance_of(point))
    }

    /// Distance of a point before the plane [m].
    pub(super) fn distance_of(&self, point: &Vector3<f64>) -> f64 {
        self.offset - self.normal.dot(point)
    }
}

/// Far side of a wall, for one charge.
#[derive(Clone, Copy, Debug)]
pub(super) enum Side {
    /// Solid as deep as an image needs.
    Solid,
    /// A screen, and the radius up to which its ghosts are felt [m].
    Screen(f64),
    /// Facets beside a rim or far from it, and the share of the images there.
    Facets(f64),
}

impl Side {
    /// Finds what is behind the wall for a charge whose foot on it is given, and whose image is at a depth
    /// [m]; `None` where the foot lies beyond the wall's rim.
    pub(super) fn of(
        ground: &Ground,
        rims: &Creases,
        foot: &Vector3<f64>,
        normal: &Vector3<f64>,
        image_depth: f64,
    ) -> Option<Self> {
        let is_near = |rim: &NearCrease| ground.carrier == Carrier::Facets || rim.distance < ground.radius;
        let near = rims.nearest(foot).filter(is_near);
        let inside = near.and_then(|rim| rim.inside(normal, foot)).unwrap_or(f64::INFINITY);
        if inside < 0.0 {
            return None;
        }
        if ground.carrier == Carrier::Facets {
            return Some(Self::Facets(step(inside / image_depth.max(f64::MIN_POSITIVE), FROM_RIM)));
        }
        if ground.is_safe(image_depth) && inside > ground.at_edge {
            return Some(Self::Solid);
        }
        // No ghost is felt beyond the rim.
        Some(Self::Screen(inside.min(ground.radius)))
    }

    /// Share of the images: cells cannot carry ghosts that end at once.
    pub(super) fn share(&self, ground: &Ground) -> f64 {
        match *self {
            Self::Solid => 1.0,
            Self::Facets(share) => share,
            Self::Screen(radius) => {
                step(radius / ground.radius.min(RADIUS_OF_CELL * ground.cell), LEAST_RADIUS)
            }
        }
    }

    /// The screen, if the wall is one.
    pub(super) fn screened(&self, ground: &Ground, screen: impl FnOnce() -> Screen) -> Option<Screened> {
        match *self {
            Self::Solid | Self::Facets(_) => None,
            Self::Screen(radius) => {
                let extent = Extent { radius, cells: radius / ground.cell };
                Some(Screened { screen: screen(), extent })
            }
        }
    }
}

/// Step from 0 below the first of two bounds to 1 above the second.
fn step(value: f64, bounds: [f64; 2]) -> f64 {
    smooth_step((value - bounds[0]) / (bounds[1] - bounds[0]))
}

/// Step from 0 at u ≤ 0 to 1 at u ≥ 1, u³(10 − 15u + 6u²).
fn smooth_step(u: f64) -> f64 {
    let u = u.clamp(0.0, 1.0);
    u * u * u * (10.0 - 15.0 * u + 6.0 * u * u)
}
