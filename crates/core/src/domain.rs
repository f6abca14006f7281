//! The box that bounds the electric field and, where periodic, the motion.

use crate::course::PotentialCourse;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Condition of the electric field on a face of the domain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Boundary {
    /// Conductor at V = 0.
    Grounded,
    /// Conductor at the given potential [V].
    Potential(f64),
    /// Surface with a given outward normal field component E·n [V/m], n pointing out of the domain; 0 is an
    /// ideal insulator.
    Insulating {
        /// E·n with n the outward normal [V/m].
        normal_field_v_m: f64,
    },
    /// Joined to the opposite face.
    Periodic,
    /// Free space beyond.
    Open,
}

impl Boundary {
    /// Whether the potential is prescribed on the face.
    #[must_use]
    pub fn is_conductor(self) -> bool {
        matches!(self, Self::Grounded | Self::Potential(_))
    }

    /// Whether the normal field is prescribed on the face.
    #[must_use]
    pub fn is_insulating(self) -> bool {
        matches!(self, Self::Insulating { .. })
    }

    /// The prescribed potential [V] of a conductor.
    #[must_use]
    pub fn potential(self) -> Option<f64> {
        match self {
            Self::Grounded => Some(0.0),
            Self::Potential(volts) => Some(volts),
            _ => None,
        }
    }
}

/// A coordinate axis, also usable as an index into a vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Axis {
    /// First axis.
    X = 0,
    /// Second axis.
    Y = 1,
    /// Third axis.
    Z = 2,
}

impl Axis {
    /// All axes in order.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// Names of the box's faces, axis by axis, the lower end first.
    pub const FACE_NAMES: [&'static str; 6] = ["x_min", "x_max", "y_min", "y_max", "z_min", "z_max"];

    /// 0, 1 or 2.
    #[must_use]
    pub fn index(self) -> usize {
        self as usize
    }

    /// Name of the box's face at an end of this axis, as `x_min`.
    #[must_use]
    pub fn face_name(self, side: Side) -> &'static str {
        Self::FACE_NAMES[2 * self.index() + side as usize]
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(["x", "y", "z"][self.index()])
    }
}

/// Lower or upper end of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Side {
    /// The face at the smaller coordinate.
    Min = 0,
    /// The face at the larger coordinate.
    Max = 1,
}

/// Reason why a box is not a domain.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum DomainError {
    /// An extent is not positive and finite.
    Extent {
        /// Axis of the bad extent.
        axis: Axis,
        /// Lower coordinate [m].
        min_m: f64,
        /// Upper coordinate [m].
        max_m: f64,
    },
    /// Only one of two opposite faces is periodic.
    HalfPeriodic(Axis),
    /// A face value (potential or normal field) is not finite.
    Value(Axis, Side),
}

impl fmt::Display for DomainError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Extent { axis, min_m, max_m } => write!(
                f,
                "domain extent along {axis} must be positive and finite, got {min_m} to {max_m} m; \
                 give max_m above min_m"
            ),
            Self::HalfPeriodic(axis) => {
                write!(f, "only one face of axis {axis} is periodic; make both faces periodic or neither")
            }
            Self::Value(axis, side) => {
                let face = axis.face_name(*side);
                write!(f, "the boundary value on face {face} is not finite; give a finite number")
            }
        }
    }
}

impl std::error::Error for DomainError {}

/// Share of the box's size by which a region may reach out of it, because of rounding.
const REGION_SLACK: f64 = 1e-9;
/// Distance below which two places are one, over the largest coordinate or length of the domain: coordinates
/// in single precision, as binary STL files have, are round to 6e-8.
const SAME_PLACE: f64 = 1e-6;
/// Difference from 1 of the cosine of the angle below which two directions are one (0.26°).
const SAME_DIRECTION: f64 = 1e-5;

/// Potential of a face that changes with time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FaceCourse {
    /// Axis of the face.
    pub axis: Axis,
    /// Side of the face.
    pub side: Side,
    /// Potential [V] over time.
    pub course: PotentialCourse,
}

/// Axis-aligned box with a boundary condition per face.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Domain {
    min: Vector3<f64>,
    max: Vector3<f64>,
    faces: [[Boundary; 2]; 3],
    /// Potentials that change with time; the faces' conditions hold their values at one time.
    courses: Vec<FaceCourse>,
}

impl Domain {
    /// Box from corner `min` to corner `max` [m], `faces[axis][side]` with sides (min, max).
    ///
    /// # Errors
    /// Extents that are not positive and finite, half-periodic axes, boundary values that are not finite.
    pub fn new(min: Vector3<f64>, max: Vector3<f64>, faces: [[Boundary; 2]; 3]) -> Result<Self, DomainError> {
        for axis in Axis::ALL {
            let (lo, hi) = (min[axis.index()], max[axis.index()]);
            if !(lo.is_finite() && hi.is_finite() && hi > lo && (hi - lo).is_finite()) {
                return Err(DomainError::Extent { axis, min_m: lo, max_m: hi });
            }
            let pair = faces[axis.index()];
            if (pair[0] == Boundary::Periodic) != (pair[1] == Boundary::Periodic) {
                return Err(DomainError::HalfPeriodic(axis));
            }
            for (side, face) in [Side::Min, Side::Max].into_iter().zip(pair) {
                let value = match face {
                    Boundary::Potential(volts) => volts,
                    Boundary::Insulating { normal_field_v_m } => normal_field_v_m,
                    _ => 0.0,
                };
                if !value.is_finite() {
                    return Err(DomainError::Value(axis, side));
                }
            }
        }
        Ok(Self { min, max, faces, courses: Vec::new() })
    }

    /// Lets potentials of faces change with time; the faces have their values at t = 0.
    #[must_use]
    pub fn with_courses(mut self, courses: Vec<FaceCourse>) -> Self {
        self.courses = courses;
        self.set_time(0.0);
        self
    }

    /// Potentials of faces that change with time.
    #[must_use]
    pub fn courses(&self) -> &[FaceCourse] {
        &self.courses
    }

    /// Gives the faces whose potentials change their values at a time [s].
    pub fn set_time(&mut self, time_s: f64) {
        for FaceCourse { axis, side, course } in &self.courses {
            self.faces[axis.index()][*side as usize] = Boundary::Potential(course.at(time_s));
        }
    }

    /// Lower corner [m].
    #[must_use]
    pub fn min(&self) -> Vector3<f64> {
        self.min
    }

    /// Upper corner [m].
    #[must_use]
    pub fn max(&self) -> Vector3<f64> {
        self.max
    }

    /// Edge lengths [m].
    #[must_use]
    pub fn extent(&self) -> Vector3<f64> {
        self.max - self.min
    }

    /// Centre [m].
    #[must_use]
    pub fn centre(&self) -> Vector3<f64> {
        (self.min + self.max) * 0.5
    }

    /// Volume [m³].
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.extent().product()
    }

    /// Boundary condition of a face.
    #[must_use]
    pub fn face(&self, axis: Axis, side: Side) -> Boundary {
        self.faces[axis.index()][side as usize]
    }

    /// Distance below which two places are one [m]: a wall so near to a face is the face.
    #[must_use]
    pub fn same_place_m(&self) -> f64 {
        SAME_PLACE * self.min.amax().max(self.max.amax()).max(self.extent().amax())
    }

    /// The boundary condition of the face that a surface lies on, at a place of the surface [m] where this
    /// unit vector points out of the domain; `None` where it lies on none.
    #[must_use]
    pub fn face_under(&self, place: &Vector3<f64>, outward: &Vector3<f64>) -> Option<Boundary> {
        Axis::ALL.into_iter().flat_map(|axis| [Side::Min, Side::Max].map(|side| (axis, side))).find_map(
            |(axis, side)| {
                let (index, (corner, out)) = (
                    axis.index(),
                    match side {
                        Side::Min => (self.min, -1.0),
                        Side::Max => (self.max, 1.0),
                    },
                );
                let is_it = out * outward[index] > 1.0 - SAME_DIRECTION
                    && (place[index] - corner[index]).abs() <= self.same_place_m();
                is_it.then(|| self.face(axis, side))
            },
        )
    }

    /// Corners of the polygon in which a plane cuts the box, in order [m]; none where it passes by.
    #[must_use]
    pub fn section(&self, point: &Vector3<f64>, normal: &Vector3<f64>) -> Vec<Vector3<f64>> {
        let ends = [self.min, self.max];
        let corner = |k: usize| Vector3::from_fn(|axis, _| ends[k >> axis & 1][axis]);
        let mut crossings = Vec::new();
        for from in 0..8_usize {
            for axis in (0..3).filter(|axis| from >> axis & 1 == 0) {
                let (a, b) = (corner(from), corner(from | 1 << axis));
                let (start, end) = ((a - point).dot(normal), (b - point).dot(normal));
                if start * end <= 0.0 && start != end {
                    crossings.push(a + (b - a) * (start / (start - end)));
                }
            }
        }
        let centre = crossings.iter().sum::<Vector3<f64>>() / crossings.len().max(1) as f64;
        let across = normal.cross(&Vector3::ith(normal.iamin(), 1.0)).normalize();
        let along = normal.cross(&across);
        let angle = |place: &Vector3<f64>| (place - centre).dot(&along).atan2((place - centre).dot(&across));
        crossings.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        crossings
    }

    /// Boundary conditions `[axis][side]`.
    #[must_use]
    pub fn faces(&self) -> &[[Boundary; 2]; 3] {
        &self.faces
    }

    /// Whether the axis is periodic.
    #[must_use]
    pub fn is_periodic(&self, axis: Axis) -> bool {
        self.faces[axis.index()][0] == Boundary::Periodic
    }

    /// Whether the potential is fixed only up to a constant and the net charge must therefore vanish: every
    /// face is insulating or periodic.
    #[must_use]
    pub fn needs_neutrality(&self) -> bool {
        self.faces.iter().flatten().all(|face| face.is_insulating() || *face == Boundary::Periodic)
    }

    /// Whether a point lies in the closed box. NaN is outside.
    #[must_use]
    pub fn contains(&self, point: &Vector3<f64>) -> bool {
        (0..3).all(|axis| point[axis] >= self.min[axis] && point[axis] <= self.max[axis])
    }

    /// Text of how far a region with these corners [m] reaches out of the box; `None` where it is in it.
    #[must_use]
    pub fn overrun(&self, [low, high]: &[Vector3<f64>; 2]) -> Option<String> {
        let slack = REGION_SLACK * self.extent();
        let reaches_out = |axis: &Axis| {
            let k = axis.index();
            low[k] < self.min[k] - slack[k] || high[k] > self.max[k] + slack[k]
        };
        Axis::ALL.into_iter().find(reaches_out).map(|axis| {
            let k = axis.index();
            format!(
                "reaches from {} to {} m along {axis}, beyond the domain from {} to {} m",
                low[k], high[k], self.min[k], self.max[k]
            )
        })
    }

    /// Name of the face of some kind beyond which a region with these corners [m] reaches farthest, and how
    /// far [m]; `None` where it reaches beyond none.
    #[must_use]
    pub fn farthest_beyond(
        &self,
        [low, high]: &[Vector3<f64>; 2],
        is_meant: impl Fn(Boundary) -> bool,
    ) -> Option<(&'static str, f64)> {
        let reach = |(axis, side): (Axis, Side)| {
            let k = axis.index();
            let reach = match side {
                Side::Min => self.min[k] - low[k],
                Side::Max => high[k] - self.max[k],
            };
            let is_beyond = is_meant(self.face(axis, side)) && reach > self.same_place_m();
            is_beyond.then(|| (axis.face_name(side), reach))
        };
        let faces = Axis::ALL.into_iter().flat_map(|axis| [(axis, Side::Min), (axis, Side::Max)]);
        faces.filter_map(reach).max_by(|(_, a), (_, b)| a.total_cmp(b))
    }

    /// The point moved by whole periods into the half-open box along the periodic axes.
    #[must_use]
    pub fn wrap(&self, mut point: Vector3<f64>) -> Vector3<f64> {
        for axis in Axis::ALL {
            if self.is_periodic(axis) {
                let axis = axis.index();
                if (self.min[axis]..self.max[axis]).contains(&point[axis]) {
                    continue;
                }
                let length = self.max[axis] - self.min[axis];
                let mut offset = (point[axis] - self.min[axis]).rem_euclid(length);
                if offset >= length {
                    offset = 0.0;
                }
                point[axis] = self.min[axis] + offset;
                if point[axis] >= self.max[axis] {
                    point[axis] = self.min[axis];
                }
            }
        }
        point
    }

    /// The shortest of a difference and its periodic copies.
    #[must_use]
    pub fn shortest(&self, mut difference: Vector3<f64>) -> Vector3<f64> {
        for axis in Axis::ALL.into_iter().filter(|&axis| self.is_periodic(axis)).map(Axis::index) {
            let length = self.max[axis] - self.min[axis];
            difference[axis] -= length * (difference[axis] / length).round();
        }
        difference
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit(faces: [[Boundary; 2]; 3]) -> Result<Domain, DomainError> {
        Domain::new(Vector3::zeros(), Vector3::repeat(1.0), faces)
    }

    #[test]
    fn half_periodic_axis_is_refused() {
        let mut faces = [[Boundary::Grounded; 2]; 3];
        faces[1][0] = Boundary::Periodic;
        assert_eq!(unit(faces), Err(DomainError::HalfPeriodic(Axis::Y)));
    }

    #[test]
    fn inverted_extent_is_refused() {
        let result = Domain::new(Vector3::repeat(1.0), Vector3::zeros(), [[Boundary::Open; 2]; 3]);
        assert!(matches!(result, Err(DomainError::Extent { axis: Axis::X, .. })));
    }

    #[test]
    fn wrap_stays_inside_for_tiny_negative_offsets() {
        let domain = unit([[Boundary::Periodic; 2]; 3]).unwrap();
        let wrapped = domain.wrap(Vector3::new(-1e-20, 2.5, 1.0));
        assert!(wrapped.iter().all(|&c| (0.0..1.0).contains(&c)), "{wrapped:?}");
    }

    #[test]
    fn differences_are_shortened_along_periodic_axes_only() {
        let open = [Boundary::Open; 2];
        let domain = unit([[Boundary::Periodic; 2], open, open]).unwrap();
        assert_eq!(domain.shortest(Vector3::new(0.75, 0.75, -2.0)), Vector3::new(-0.25, 0.75, -2.0));
    }

    #[test]
    fn surfaces_in_single_precision_lie_on_their_face() {
        let corner = Vector3::repeat(0.1);
        let faces = [[Boundary::Open; 2], [Boundary::Open; 2], [Boundary::Grounded, Boundary::Open]];
        let domain = Domain::new(corner, corner.add_scalar(0.02), faces).unwrap();
        let under = |z: f64, tilt: f64| {
            domain.face_under(&Vector3::new(0.11, 0.11, z), &Vector3::new(tilt.sin(), 0.0, -tilt.cos()))
        };
        assert_eq!(under(f64::from(0.1_f32), 0.0), Some(Boundary::Grounded));
        assert_eq!(under(0.1 + 1e-10, 1e-3), Some(Boundary::Grounded));
        assert_eq!(under(0.1 + 1e-6, 0.0), None);
        assert_eq!(under(0.1, 0.1), None);
    }

    #[test]
    fn only_closed_boxes_without_conductor_need_neutrality() {
        let insulating = Boundary::Insulating { normal_field_v_m: 0.0 };
        assert!(
            unit([[insulating; 2], [Boundary::Periodic; 2], [insulating; 2]]).unwrap().needs_neutrality()
        );
        assert!(!unit([[insulating; 2], [Boundary::Open; 2], [insulating; 2]]).unwrap().needs_neutrality());
        assert!(
            !unit([[insulating; 2], [insulating, Boundary::Grounded], [insulating; 2]])
                .unwrap()
                .needs_neutrality()
        );
    }
}
