//! Grains of a file.

use crate::{arrays, errors};
use amberfield_core::Particles;
use amberfield_scene::{Snapshot, SnapshotOptions, Units};
use numpy::IntoPyArray as _;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

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
