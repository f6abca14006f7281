//! The uniform external field that a scene gives.

use crate::values::FieldAt;
use amberfield_core::{Domain, FieldCourse, FieldSettings};
use nalgebra::Vector3;

/// A uniform field, whose potential is zero at the domain's centre: V = −E·(x − centre).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ExternalField {
    e: Vector3<f64>,
    centre: Vector3<f64>,
}

impl ExternalField {
    /// The external field of a scene, at t = 0 where it changes.
    pub(crate) fn new(domain: &Domain, settings: &FieldSettings) -> Self {
        let mut field = Self { e: settings.external_field_v_m, centre: domain.centre() };
        field.set_time(settings.external_course.as_ref(), 0.0);
        field
    }

    /// Takes the value of a course at a time [s].
    pub(crate) fn set_time(&mut self, course: Option<&FieldCourse>, time_s: f64) {
        if let Some(course) = course {
            self.e = course.at(time_s);
        }
    }

    /// E [V/m].
    pub(crate) fn e(&self) -> Vector3<f64> {
        self.e
    }

    /// E [V/m] and potential [V] at a position [m].
    #[inline]
    pub(crate) fn at(&self, position: &Vector3<f64>) -> FieldAt {
        FieldAt { e: self.e, potential: -self.e.dot(&(position - self.centre)) }
    }
}
