//! The field of the faces alone: potentials of electrodes and prescribed normal fields, without charges.

mod general;
mod heat;
mod level;

use crate::error::FieldError;
use crate::geometry::images::{AxisKind, FaceKind, Geometry, axis_kinds};
use crate::values::FieldAt;
use amberfield_core::{Axis, Boundary, Domain, Side};
use general::General;
use nalgebra::Vector3;

pub(crate) use level::FacesLevel;

/// Relative error of the quadrature.
const TOLERANCE: f64 = 1e-12;
/// Divergences whose sum is this small beside their absolute sum cancel.
const ROUND_OFF: f64 = 1e-12;

/// Field and potential that solve Laplace's equation with the faces' values, to be added to the field of
/// charges between grounded faces and faces without normal field.
///
/// Faces of an axis without an open face are whole planes where the other axes are open: a domain that is
/// open at its sides stands for plates without edges.
///
/// Where the values vary along one axis alone the field is linear in the coordinates and costs nothing; else
/// every evaluation integrates heat kernels, some tens of microseconds a point.
///
/// Normal fields without any conductor whose fluxes do not cancel go with a uniform background charge that
/// takes them; the charges' own background, see [`crate::Direct`], cancels it when the net charge matches.
/// Where the faces leave the potential free its mean over the domain is 0.
///
/// Potentials that change with time have the values that the domain's faces have at present; which of the
/// solutions it is does not depend on them.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundaryField {
    solution: Solution,
}

#[derive(Clone, Debug, PartialEq)]
enum Solution {
    Linear(Linear),
    General(General),
}

/// E linear in each coordinate: E_a = field_a + slope_a (x_a − origin_a).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Linear {
    origin: Vector3<f64>,
    field: Vector3<f64>,
    slope: Vector3<f64>,
    /// Potential at the origin [V].
    potential: f64,
}

impl BoundaryField {
    /// The boundary field of a domain; `None` when every face's value is zero, and nothing is to be added.
    ///
    /// # Errors
    /// Geometries and normal fields that have no bounded solution.
    pub fn new(domain: &Domain) -> Result<Option<Self>, FieldError> {
        Self::with_tolerance(domain, TOLERANCE)
    }

    /// Builds the field of the faces with a given relative error of the quadrature, where there is one.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_tolerance(domain: &Domain, tolerance: f64) -> Result<Option<Self>, FieldError> {
        let values = domain.faces().iter().flatten().map(|face| match face {
            Boundary::Insulating { normal_field_v_m } => *normal_field_v_m,
            face => face.potential().unwrap_or(0.0),
        });
        if domain.courses().is_empty() && values.into_iter().all(|value| value == 0.0) {
            return Ok(None);
        }
        let solution = match carrier(domain) {
            Carrier::Nowhere => Solution::Linear(without_conductor(domain)?),
            Carrier::Axis(axis) => Solution::Linear(along(domain, axis)),
            Carrier::Everywhere(potential) => Solution::Linear(Linear { potential, ..Linear::default() }),
            Carrier::Several => Solution::General(General::new(domain, tolerance)?),
        };
        Ok(Some(Self { solution }))
    }

    /// Takes the present potentials of a domain's faces, of which the field was built.
    pub(crate) fn set_potentials(&mut self, domain: &Domain) {
        match (&mut self.solution, carrier(domain)) {
            (Solution::Linear(linear), Carrier::Axis(axis)) => *linear = along(domain, axis),
            (Solution::General(general), _) => general.set_potentials(domain),
            // Without a conductor there is no potential.
            _ => {}
        }
    }

    /// E of a field that is the same everywhere, at a time [s] of a domain's potentials [V/m].
    pub(crate) fn uniform_at(&self, domain: &Domain, time_s: f64) -> Vector3<f64> {
        let Carrier::Axis(axis) = carrier(domain) else { return Vector3::zeros() };
        let potential = |side: Side| {
            let course = domain.courses().iter().find(|face| face.axis == axis && face.side == side);
            course.map_or_else(|| domain.face(axis, side).potential(), |face| Some(face.course.at(time_s)))
        };
        field_along(domain, axis, [Side::Min, Side::Max].map(potential)).0
    }

    /// Whether E is the same everywhere.
    #[must_use]
    pub fn is_uniform(&self) -> bool {
        matches!(&self.solution, Solution::Linear(linear) if linear.slope == Vector3::zeros())
    }

    /// Whether an evaluation is a closed form; else it integrates.
    #[must_use]
    pub fn is_closed_form(&self) -> bool {
        matches!(self.solution, Solution::Linear(_))
    }

    /// E [V/m] and potential [V] at a point [m] of the domain.
    #[must_use]
    pub fn evaluate(&self, x: &Vector3<f64>) -> FieldAt {
        match &self.solution {
            Solution::General(general) => general.evaluate(x),
            Solution::Linear(linear) => {
                let d = x - linear.origin;
                let e = linear.field + linear.slope.component_mul(&d);
                let fall = linear.field + 0.5 * linear.slope.component_mul(&d);
                FieldAt { e, potential: linear.potential - fall.dot(&d) }
            }
        }
    }
}

/// Axes whose faces carry values.
enum Carrier {
    /// No conductor: normal fields alone, each axis by itself.
    Nowhere,
    /// All conductors have one potential and nothing else has a value.
    Everywhere(f64),
    /// Conductors and values on one axis.
    Axis(Axis),
    /// Anything else.
    Several,
}

fn carrier(domain: &Domain) -> Carrier {
    let kinds = axis_kinds(domain);
    let mut conducting = Axis::ALL.into_iter().filter(|axis| kinds[axis.index()].has_conductor());
    let has_flux = |axis: Axis| {
        [Side::Min, Side::Max].into_iter().any(|side| {
            matches!(
                domain.face(axis, side),
                Boundary::Insulating { normal_field_v_m } if normal_field_v_m != 0.0
            )
        })
    };
    let mut potentials = domain.faces().iter().flatten().filter_map(|face| face.potential());
    let Some(first) = potentials.next() else {
        return Carrier::Nowhere;
    };
    // Potentials that change may be the same at times.
    let stay = domain.courses().is_empty();
    if stay && potentials.all(|other| other == first) && !Axis::ALL.into_iter().any(has_flux) {
        return Carrier::Everywhere(first);
    }
    match (conducting.next(), conducting.next()) {
        (Some(axis), None) if !Axis::ALL.into_iter().any(|other| other != axis && has_flux(other)) => {
            Carrier::Axis(axis)
        }
        _ => Carrier::Several,
    }
}

fn normal_field(face: Boundary) -> f64 {
    match face {
        Boundary::Insulating { normal_field_v_m } => normal_field_v_m,
        _ => 0.0,
    }
}

/// One axis has conductors, and it alone has values.
fn along(domain: &Domain, axis: Axis) -> Linear {
    let potentials = [Side::Min, Side::Max].map(|side| domain.face(axis, side).potential());
    let (field, potential) = field_along(domain, axis, potentials);
    Linear { origin: domain.min(), potential, field, ..Linear::default() }
}

/// Field [V/m], and potential at the lower corner [V], between two faces across an axis with potentials [V]
/// or none.
fn field_along(domain: &Domain, axis: Axis, potentials: [Option<f64>; 2]) -> (Vector3<f64>, f64) {
    let index = axis.index();
    let length = domain.extent()[index];
    let [lower, upper] = [Side::Min, Side::Max].map(|side| domain.face(axis, side));
    let (along, potential) = match (potentials[0], potentials[1]) {
        (Some(low), Some(high)) => ((low - high) / length, low),
        // An open or insulating face opposite: the field is the insulator's, none for an open one.
        (Some(low), None) => (normal_field(upper), low),
        (None, high) => {
            let field = -normal_field(lower);
            (field, high.unwrap_or(0.0) + field * length)
        }
    };
    let mut field = Vector3::zeros();
    field[index] = along;
    (field, potential)
}

/// Normal fields alone: along each axis E runs linearly from one face's value to the other's.
fn without_conductor(domain: &Domain) -> Result<Linear, FieldError> {
    let kinds = axis_kinds(domain);
    let mut linear = Linear { origin: domain.min(), ..Linear::default() };
    for axis in Axis::ALL {
        let index = axis.index();
        let length = domain.extent()[index];
        let [lower, upper] = [Side::Min, Side::Max].map(|side| normal_field(domain.face(axis, side)));
        match kinds[index] {
            AxisKind::Faces(FaceKind::Insulator, FaceKind::Insulator) => {
                linear.field[index] = -lower;
                linear.slope[index] = (lower + upper) / length;
            }
            AxisKind::Faces(FaceKind::Insulator, _) => linear.field[index] = -lower,
            AxisKind::Faces(_, FaceKind::Insulator) => linear.field[index] = upper,
            _ => {}
        }
        linear.potential += linear.field[index] * length / 2.0 + linear.slope[index] * length * length / 6.0;
    }
    if linear.slope.sum().abs() <= ROUND_OFF * linear.slope.abs().sum() {
        return Ok(linear);
    }
    match Geometry::of(domain) {
        Geometry::Closed => Ok(linear),
        _ => Err(FieldError::Settings(
            "normal fields on opposite faces of a domain with open faces and no conductor do not cancel, \
             and the flux has nowhere to go; make them equal and opposite, or ground a face"
                .into(),
        )),
    }
}
