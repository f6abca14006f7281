//! Mirror that a wall is for one charge near it, and whether an image can lie behind the wall.

use super::rims::Rims;
use super::screen::{HalfPlane, Screen};
use super::solid::Surroundings;
use nalgebra::Vector3;

/// Depth up to which walls mirror charges, over the cell size.
const DEPTH_OF_CELL: f64 = 4.0;
/// Radii up to which ghosts are felt, over the cell size: before endless screens, and at rims.
pub(super) const RADIUS_OF_CELL: f64 = 5.5;
pub(super) const RADIUS_AT_RIM_OF_CELL: f64 = 7.5;
/// Solid between an image and the mesh behind it at least, over the image's depth and over the cell size.
const BEHIND_OF_DEPTH: f64 = 1.0;
const BEHIND_OF_CELL: f64 = 1.5;
/// Distances of a second rim, over the charge's from the wall, between which ghosts fade away.
const FADE: [f64; 2] = [1.0, 3.0];

/// Wall below a charge's foot: how deep it mirrors, and what is behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ground {
    /// Size of the cells [m].
    pub(super) cell: f64,
    /// Thickness of the solid [m].
    pub(super) solid: f64,
    /// Deepest charge that is mirrored [m].
    pub(super) depth: f64,
    /// Radii up to which ghosts are felt: before endless screens, and at rims [m].
    pub(super) radius: f64,
    pub(super) radius_at_rim: f64,
}

impl Ground {
    /// The ground at a boundary face, with ghosts' radii scaled.
    pub(super) fn new(around: &Surroundings, ghost_scale: f64) -> Self {
        Self {
            cell: around.cell,
            solid: around.solid,
            depth: DEPTH_OF_CELL * around.cell,
            radius: ghost_scale * RADIUS_OF_CELL * around.cell,
            radius_at_rim: ghost_scale * RADIUS_AT_RIM_OF_CELL * around.cell,
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
    pub(super) normal: Vector3<f64>,
    pub(super) offset: f64,
    pub(super) distance: f64,
    /// Mean curvature towards the charge [1/m].
    pub(super) curvature: f64,
    /// Deepest charge that is mirrored [m].
    pub(super) depth: f64,
    /// The screen that the wall is, where no image can lie behind it.
    pub(super) screened: Option<Screened>,
}

/// Screen before which a charge has ghosts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Screened {
    pub(super) screen: Screen,
    /// Radius of the ghosts [m].
    pub(super) radius: f64,
    /// Share of the ghosts that is left where another rim is near.
    pub(super) fade: f64,
}

impl Mirror {
    /// Mirror of a charge at a point beyond the rim of a half plane, at a distance from it [m].
    pub(super) fn beyond_rim(
        half: HalfPlane,
        point: &Vector3<f64>,
        distance: f64,
        ground: &Ground,
        left: f64,
    ) -> Self {
        let radius = ground.radius_at_rim;
        Self {
            normal: -half.up,
            offset: half.height(point) - half.up.dot(point),
            distance,
            curvature: 0.0,
            depth: ground.depth,
            screened: Some(Screened { screen: Screen::Rim(half), radius, fade: left }),
        }
    }

    /// Whether two mirrors of a charge are one plane, seen from the same side.
    pub(super) fn is_same_plane(&self, other: &Self) -> bool {
        /// Difference of normals, and of distances over a distance, of one plane.
        const SAME: f64 = 1e-6;
        let apart = (self.distance - other.distance).abs();
        (self.normal - other.normal).norm() < SAME && apart < SAME * self.distance.max(f64::MIN_POSITIVE)
    }

    /// Charge of the image over the charge's, but for the sign and the curvature, at a distance [m].
    pub(super) fn fade(&self, distance: f64) -> f64 {
        let fade = 1.0 - smooth_step(2.0 * distance / self.depth - 1.0);
        fade * self.screened.map_or(1.0, |screened| screened.fade)
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
    /// An endless screen.
    Screen,
    /// A screen with a free rim, and the share that is left where a second one is near.
    Rim(HalfPlane, f64),
}

impl Side {
    /// Finds what is behind the wall for a charge at a distance [m] above a foot, whose image is at a depth
    /// [m]; `None` where the foot lies beyond the wall's rim.
    pub(super) fn of(
        ground: &Ground,
        rims: &Rims,
        foot: &Vector3<f64>,
        normal: &Vector3<f64>,
        distance: f64,
        image_depth: f64,
    ) -> Option<Self> {
        let near = rims.nearest(foot).filter(|rim| rim.distance < ground.radius_at_rim);
        let Some((rim, half)) = near.and_then(|rim| Some((rim, rim.of_wall(normal)?))) else {
            return Some(if ground.is_safe(image_depth) { Self::Solid } else { Self::Screen });
        };
        if half.inside(foot) < 0.0 {
            return None;
        }
        Some(Self::Rim(half, left_beside(rims.other(foot, &rim), distance)))
    }

    /// The screen, if the wall is one; `endless` makes that of a wall without rim.
    pub(super) fn screened(&self, ground: &Ground, endless: impl FnOnce() -> Screen) -> Option<Screened> {
        match *self {
            Self::Solid => None,
            Self::Screen => Some(Screened { screen: endless(), radius: ground.radius, fade: 1.0 }),
            Self::Rim(half, fade) => {
                Some(Screened { screen: Screen::Rim(half), radius: ground.radius_at_rim, fade })
            }
        }
    }
}

/// Share of the ghosts of a charge at a distance [m] from a wall that is left where another rim is `rim` [m]
/// away: a half plane's layer goes on where the wall does not.
pub(super) fn left_beside(rim: f64, distance: f64) -> f64 {
    let over = rim / distance.max(f64::MIN_POSITIVE);
    smooth_step((over - FADE[0]) / (FADE[1] - FADE[0]))
}

/// Step from 0 at u ≤ 0 to 1 at u ≥ 1, u³(10 − 15u + 6u²).
fn smooth_step(u: f64) -> f64 {
    let u = u.clamp(0.0, 1.0);
    u * u * u * (10.0 - 15.0 * u + 6.0 * u * u)
}
