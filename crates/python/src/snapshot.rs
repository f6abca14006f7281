//! Grains from files and to files.

use crate::{arrays, errors};
use amberfield_core::{Axis, GroupId, MaterialId, Particles, Vector3};
use amberfield_scene::{Given, Snapshot, SnapshotBox, SnapshotOptions, Units, read_outline};
use numpy::{IntoPyArray as _, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Materials, and the corners [m] and periodic axes of a box.
type Outline = (Vec<String>, Option<([[f64; 3]; 2], [bool; 3])>);

/// Reads the grains of a file at one time: a dict of arrays, in which what the file does not have is `None`.
#[pyfunction]
pub(crate) fn read_snapshot(
    py: Python<'_>,
    path: PathBuf,
    units: Option<String>,
    step: Option<u64>,
    materials_by_type: Vec<String>,
) -> PyResult<Bound<'_, PyDict>> {
    let units = units.map(|name| Units::named(&name)).transpose();
    let units = units.map_err(|reason| errors::bad_input(py, &format!("units: {reason}")))?;
    let options = SnapshotOptions { units, step, materials_by_type };
    let snapshot =
        py.detach(|| Snapshot::read(&path, &options)).map_err(|error| errors::of_scene(py, &error))?;
    let has = (
        snapshot.velocities_m_s().is_some(),
        snapshot.angular_velocities_rad_s().is_some(),
        snapshot.radii_m().is_some(),
        snapshot.densities_kg_m3().is_some(),
        snapshot.charges_c().is_some(),
    );
    let (velocity, angular_velocity, radius, density, charge) = has;
    let dict = PyDict::new(py);
    dict.set_item("step", snapshot.step)?;
    dict.set_item("time_s", snapshot.time_s)?;
    if let Some(bounds) = snapshot.bounds {
        let corners = [bounds.min_m, bounds.max_m].map(<[f64; 3]>::from);
        dict.set_item("box_m", corners)?;
        dict.set_item("is_periodic", bounds.is_periodic)?;
    }
    if let Some(materials) = snapshot.material_ids() {
        let ids: Vec<u16> = materials.iter().map(|id| id.0).collect();
        dict.set_item("material", ids.into_pyarray(py))?;
        dict.set_item("materials", &snapshot.materials)?;
    }
    let columns = columns(py, snapshot.into_particles())?;
    for (name, there) in [
        ("velocity_m_s", velocity),
        ("angular_velocity_rad_s", angular_velocity),
        ("radius_m", radius),
        ("density_kg_m3", density),
        ("charge_C", charge),
    ] {
        if !there {
            columns.set_item(name, py.None())?;
        }
    }
    dict.update(columns.as_mapping())?;
    Ok(dict)
}

/// Names of the materials of a scene, and the box with the axes along which it repeats; the box is `None`
/// where the mesh of a solver gives it.
#[pyfunction]
pub(crate) fn outline(py: Python<'_>, scene: PathBuf) -> PyResult<Outline> {
    let outline = read_outline(&scene).map_err(|error| errors::of_scene(py, &error))?;
    let bounds = outline.domain.map(|domain| {
        let corners = [domain.min(), domain.max()].map(<[f64; 3]>::from);
        (corners, Axis::ALL.map(|axis| domain.is_periodic(axis)))
    });
    Ok((outline.materials, bounds))
}

/// Arrays of grains by the names of their columns.
pub(crate) fn columns(py: Python<'_>, particles: Particles) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("id", particles.id.into_pyarray(py))?;
    dict.set_item("position_m", arrays::vectors(py, particles.position))?;
    dict.set_item("velocity_m_s", arrays::vectors(py, particles.velocity))?;
    dict.set_item("angular_velocity_rad_s", arrays::vectors(py, particles.angular_velocity))?;
    dict.set_item("radius_m", particles.radius.into_pyarray(py))?;
    dict.set_item("density_kg_m3", particles.density.into_pyarray(py))?;
    dict.set_item("charge_C", particles.charge.into_pyarray(py))?;
    Ok(dict)
}

/// Writes grains in the form that the file's ending names. Arrays that are `None` are left out.
#[pyfunction]
pub(crate) fn write_snapshot(
    py: Python<'_>,
    path: PathBuf,
    units: &str,
    grains: &Bound<'_, PyDict>,
) -> PyResult<()> {
    let units = Units::named(units).map_err(|reason| errors::bad_input(py, &format!("units: {reason}")))?;
    let snapshot = Columns { grains }.snapshot()?;
    py.detach(|| amberfield_scene::write_snapshot(&path, &snapshot, units))
        .map_err(|error| errors::of_scene(py, &error))
}

/// Arrays of grains, checked and made contiguous by the other half of the package.
struct Columns<'a, 'py> {
    grains: &'a Bound<'py, PyDict>,
}

impl<'py> Columns<'_, 'py> {
    /// Snapshot with what is there.
    fn snapshot(&self) -> PyResult<Snapshot> {
        let id: Vec<u64> = self.value("id")?.unwrap_or_default();
        let count = id.len();
        let position = self.vectors("position_m")?;
        let velocity = self.vectors("velocity_m_s")?;
        let angular_velocity = self.vectors("angular_velocity_rad_s")?;
        let radius: Option<Vec<f64>> = self.value("radius_m")?;
        let density: Option<Vec<f64>> = self.value("density_kg_m3")?;
        let charge: Option<Vec<f64>> = self.value("charge_C")?;
        let material: Option<Vec<u16>> = self.value("material")?;
        let given = Given {
            radius: radius.is_some(),
            charge: charge.is_some(),
            velocity: velocity.is_some(),
            angular_velocity: angular_velocity.is_some(),
            density: density.is_some(),
            material: material.is_some(),
        };
        let material = material.map(|ids| ids.into_iter().map(MaterialId).collect());
        let zeros = || vec![0.0; count];
        let still = || vec![Vector3::zeros(); count];
        let particles = Particles {
            id,
            position: position.unwrap_or_else(still),
            velocity: velocity.unwrap_or_else(still),
            angular_velocity: angular_velocity.unwrap_or_else(still),
            radius: radius.unwrap_or_else(zeros),
            density: density.unwrap_or_else(zeros),
            charge: charge.unwrap_or_else(zeros),
            material: material.unwrap_or_else(|| vec![MaterialId(0); count]),
            group: vec![GroupId(0); count],
            fixed_groups: Vec::new(),
        };
        let mut snapshot = Snapshot::with(particles, given);
        snapshot.step = self.value("step")?;
        snapshot.time_s = self.value("time_s")?;
        snapshot.materials = self.value("materials")?.unwrap_or_default();
        let corners: Option<[[f64; 3]; 2]> = self.value("box_m")?;
        let is_periodic = self.value("is_periodic")?.unwrap_or_default();
        snapshot.bounds =
            corners.map(|[low, high]| SnapshotBox { min_m: low.into(), max_m: high.into(), is_periodic });
        Ok(snapshot)
    }

    /// Value of a name; `None` where there is none.
    fn value<T: for<'a> FromPyObject<'a, 'py>>(&self, name: &str) -> PyResult<Option<T>> {
        let found = self.grains.get_item(name)?.filter(|value| !value.is_none());
        found.map(|value| value.extract().map_err(Into::into)).transpose()
    }

    /// Vectors of a name.
    fn vectors(&self, name: &str) -> PyResult<Option<Vec<Vector3<f64>>>> {
        let Some(found) = self.grains.get_item(name)?.filter(|value| !value.is_none()) else {
            return Ok(None);
        };
        let array: PyReadonlyArray2<'_, f64> = found.extract()?;
        Ok(Some(arrays::rows(self.grains.py(), name, &array)?.to_vec()))
    }
}
