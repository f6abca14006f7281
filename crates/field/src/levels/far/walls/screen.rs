//! Walls that hide what is behind them: sheets, plates and edges of bodies, where a mirror charge would lie
//! in the mesh or beside it.
//!
//! A screen takes a share T(x, y) R of a charge's potential away from a place x that it hides from the
//! charge's place y (R = |x − y|). An endless screen hides all or nothing; at a free rim the share goes
//! smoothly around it, as a half plane's does (`amberfield_laws::half_plane`).

use super::curved::Quadric;
use amberfield_laws::half_plane::{Across, Hidden, hidden};
use nalgebra::Vector3;

/// A wall as a charge near it sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Screen {
    /// A flat wall without a rim nearby.
    Plane {
        /// Unit normal, away from the charge.
        normal: Vector3<f64>,
        /// Normal times a point of the plane [m].
        offset: f64,
    },
    /// A curved wall without a rim nearby.
    Curved(Quadric),
    /// A flat wall that ends at a straight rim.
    Rim(HalfPlane),
}

/// A half plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HalfPlane {
    /// A point of the rim [m].
    pub(crate) rim: Vector3<f64>,
    /// Unit vector in the plane, from the rim into the plate.
    pub(crate) into: Vector3<f64>,
    /// Unit normal on the charge's side.
    pub(crate) up: Vector3<f64>,
}

impl HalfPlane {
    /// Distance into the plate [m], negative beyond the rim.
    pub(crate) fn inside(&self, point: &Vector3<f64>) -> f64 {
        self.into.dot(&(point - self.rim))
    }

    /// Height above the plate [m].
    pub(crate) fn height(&self, point: &Vector3<f64>) -> f64 {
        self.up.dot(&(point - self.rim))
    }

    /// Mirror image of a point in the plane [m].
    pub(crate) fn mirrored(&self, point: &Vector3<f64>) -> Vector3<f64> {
        point - self.up * (2.0 * self.height(point))
    }

    /// Place across the rim; a place on the plate itself is on the side of `seen_from`.
    pub(crate) fn across(&self, point: &Vector3<f64>, seen_from: &Vector3<f64>) -> Across {
        let height = self.height(point).abs().copysign(self.height(seen_from));
        Across::new(self.inside(point), height)
    }
}

/// A place that a field is asked for at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    /// The place [m].
    pub(crate) at: Vector3<f64>,
    /// A point on the same side of every wall, off them [m]: places on a wall are on the mesh's side of it.
    pub(crate) seen_from: Vector3<f64>,
}

/// Share that is hidden, over the distance, with its gradient.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct HiddenAt {
    /// T [1/m].
    pub(crate) value: f64,
    /// ∂T/∂R over R at fixed c [1/m³].
    pub(crate) slope_over_distance: f64,
    /// ∂T/∂c ∇c [1/m²].
    pub(crate) aside: Vector3<f64>,
}

impl Screen {
    /// The screen moved by a period [m].
    pub(crate) fn moved(&self, by: &Vector3<f64>) -> Self {
        match *self {
            Self::Plane { normal, offset } => Self::Plane { normal, offset: offset + normal.dot(by) },
            Self::Curved(quadric) => Self::Curved(quadric.moved(by)),
            Self::Rim(half) => Self::Rim(HalfPlane { rim: half.rim + by, ..half }),
        }
    }

    /// Height of a point above the wall [m], positive on the charge's side; on a half plane's own side of
    /// the rim only.
    pub(crate) fn height(&self, point: &Vector3<f64>) -> f64 {
        match self {
            Self::Plane { normal, offset } => offset - normal.dot(point),
            Self::Curved(quadric) => -quadric.above(point),
            Self::Rim(half) => half.height(point),
        }
    }

    /// Finds what is hidden at a place from the place `y` of a charge at a distance R, on the side `above`
    /// (+1, −1) of the wall; `None` where the place sees it.
    pub(crate) fn hides(
        &self,
        place: &Place,
        y: &Vector3<f64>,
        distance: f64,
        above: f64,
    ) -> Option<HiddenAt> {
        match self {
            Self::Plane { .. } | Self::Curved(_) => {
                let sees = self.height(&place.seen_from) * above > 0.0;
                let whole = || HiddenAt {
                    value: 1.0 / distance,
                    slope_over_distance: -distance.powi(-3),
                    aside: Vector3::zeros(),
                };
                (!sees).then(whole)
            }
            Self::Rim(half) => {
                let here = half.across(&place.at, &place.seen_from);
                let height = half.height(y).abs().copysign(above);
                let there = Across::new(half.inside(y), height);
                let Hidden { value, slope_over_distance, slope_between } =
                    hidden(distance, here.between(&there));
                let [into, up] = here.slope_between(&there);
                let aside = slope_between * (half.into * into + half.up * up);
                Some(HiddenAt { value, slope_over_distance, aside })
            }
        }
    }
}
