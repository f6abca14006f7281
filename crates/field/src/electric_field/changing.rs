//! Potentials of faces and an external field that change with time.

use super::ElectricField;
use crate::error::FieldError;
use crate::levels::far::FarSolver;
use crate::values::FieldAt;
use amberfield_core::{Domain, FieldSettings, Method};
use nalgebra::Vector3;

impl ElectricField {
    /// Takes the potentials and the external field of a time [s], for what is evaluated from now on. A field
    /// that was built has those of t = 0.
    pub fn set_time(&mut self, time_s: f64) {
        self.external.set_time(self.settings.external_course.as_ref(), time_s);
        self.faces.set_time(time_s);
        if let Some(solver) = self.method.far_solver_mut() {
            solver.set_time(time_s);
        }
    }

    /// Whether any part of E changes with time though no charge moves.
    #[must_use]
    pub fn changes(&self) -> bool {
        self.settings.external_course.is_some()
            || self.faces.changing_uniform().is_some()
            || self.faces.changing_otherwise().is_some()
            || self.method.far_solver().is_some_and(FarSolver::changes)
    }

    /// External field at the time that was set [V/m].
    #[must_use]
    pub fn external(&self) -> Vector3<f64> {
        self.external.e()
    }

    /// Part of the field that changes with time and is the same everywhere, at a place of the domain and the
    /// time that was set: the external one, and that of faces across one axis. E is the same at all places,
    /// the potential is not. Zero where nothing changes.
    #[must_use]
    pub fn changing_uniform(&self, place: &Vector3<f64>) -> GivenField {
        let external = self.settings.external_course.as_ref().map(|_| self.external.at(place));
        let faces = self.faces.changing_uniform().map(|faces| faces.evaluate(place));
        GivenField { external: external.unwrap_or_default(), faces: faces.unwrap_or_default() }
    }

    /// E of the part of the field that changes with time and is the same everywhere, at any time [s], in V/m.
    #[must_use]
    pub fn changing_uniform_at(&self, time_s: f64) -> Vector3<f64> {
        let external = self.settings.external_course.as_ref().map(|course| course.at(time_s));
        external.unwrap_or_default() + self.faces.changing_uniform_at(time_s)
    }

    /// Longest time from a time [s] on for which E may be extrapolated: where potentials that change make a
    /// field that is not the same everywhere, a twentieth of a period or of a table's line. Infinite
    /// elsewhere.
    #[must_use]
    pub fn longest_forecast_s(&self, time_s: f64) -> f64 {
        let courses = self.faces.changing_otherwise().into_iter().flat_map(Domain::courses);
        courses.map(|face| face.course.longest_look_s(time_s)).fold(f64::INFINITY, f64::min)
    }

    /// Longest time between two trades of charge at contacts from a time [s] on that follow what changes, a
    /// twentieth of a period or of a table's line; infinite where nothing changes.
    #[must_use]
    pub fn longest_look_s(&self, time_s: f64) -> f64 {
        let external = self.settings.external_course.iter().map(|course| course.longest_look_s(time_s));
        let courses = self.domain.courses().iter().map(|face| face.course.longest_look_s(time_s));
        external.chain(courses).fold(f64::INFINITY, f64::min)
    }
}

/// Field that is there without charges, or the part of it that changes and is the same everywhere.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GivenField {
    /// External field.
    pub external: FieldAt,
    /// Field of the faces' potentials.
    pub faces: FieldAt,
}

/// Refuses potentials that change where the method has them in equations that it solves once for all.
pub(super) fn check(domain: &Domain, settings: &FieldSettings) -> Result<(), FieldError> {
    if settings.method == Method::Kolehmainen && !domain.courses().is_empty() {
        return Err(FieldError::Settings(
            "method kolehmainen has no potentials that change with time; choose method p3m, or give \
             potential_V as a number"
                .into(),
        ));
    }
    Ok(())
}
