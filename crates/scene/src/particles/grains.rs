//! Grains from the rows of a file: each is checked, and what the file lacks is filled in.

use super::columns::Columns;
use super::names::{MaterialNames, Names};
use super::row::{Row, RowPlace, refuse};
use super::snapshot::{Given, Snapshot};
use crate::SceneError;
use crate::limits::{CHARGE, COORDINATE, DENSITY, MASS, RADIUS, RADIUS_OR_POINT, SPEED};
use amberfield_core::{Domain, Grain, Particles};
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Smallest charge other than 0 [C]: the square of a smaller one underflows.
const LEAST_CHARGE: f64 = 1e-100;

/// Parts of a scene that a file of grains is checked against.
#[derive(Debug)]
pub(crate) struct GrainContext<'a> {
    /// Box that grains must lie in.
    pub(crate) domain: Option<&'a Domain>,
    /// Materials by name.
    pub(crate) materials: MaterialNames<'a>,
    /// Switch for grains of radius 0, which a field without motion allows.
    pub(crate) allow_points: bool,
}

/// Indices of the columns in one file; `None` for a column that is absent.
struct ColumnIndices {
    id: Option<usize>,
    position: [usize; 3],
    radius: Option<usize>,
    charge: Option<usize>,
    velocity: [Option<usize>; 3],
    spin: [Option<usize>; 3],
    density: Option<usize>,
    mass: Option<usize>,
}

impl ColumnIndices {
    fn new(columns: &Columns) -> Self {
        let find = |name: &str| columns.find(name);
        let required = |name: &str| columns.find(name).expect("columns of places were checked");
        Self {
            id: find("id"),
            position: ["x_m", "y_m", "z_m"].map(required),
            radius: find("radius_m"),
            charge: find("charge_C"),
            velocity: ["vx_m_s", "vy_m_s", "vz_m_s"].map(find),
            spin: ["wx_rad_s", "wy_rad_s", "wz_rad_s"].map(find),
            density: find("density_kg_m3"),
            // Where both are there, as in many dumps, they say the same.
            mass: find("mass_kg").filter(|_| find("density_kg_m3").is_none() && find("radius_m").is_some()),
        }
    }
}

/// Box into which places are taken back along its periodic axes, as its file has them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Period {
    /// Axis.
    pub(super) axis: usize,
    /// Lower end [m].
    pub(super) low: f64,
    /// Upper end [m].
    pub(super) high: f64,
}

impl Period {
    /// Place inside the box; one that is inside stays as it is.
    fn wrap(&self, place: f64) -> f64 {
        if (self.low..=self.high).contains(&place) {
            return place;
        }
        let length = self.high - self.low;
        let inside = self.low + (place - self.low).rem_euclid(length);
        if inside < self.high { inside } else { self.low }
    }
}

/// Grains that are read row by row.
pub(super) struct Gathering<'a> {
    context: &'a GrainContext<'a>,
    columns: Columns,
    indices: ColumnIndices,
    names: Names<'a>,
    periods: Vec<Period>,
    particles: Particles,
    /// Number of each row in the file.
    numbers: Vec<u32>,
    /// Kind of the rows' places.
    place: RowPlace,
}

impl<'a> Gathering<'a> {
    /// Begins with the columns of a file, which have those of places.
    ///
    /// `first_type` is the smallest number that the file may have in its column of types.
    ///
    /// # Errors
    /// Radii and materials that the context needs and the file does not have.
    pub(super) fn new(
        columns: Columns,
        context: &'a GrainContext<'a>,
        first_type: u64,
    ) -> Result<Self, SceneError> {
        let indices = ColumnIndices::new(&columns);
        let needs_radius = !context.allow_points && matches!(context.materials, MaterialNames::Scene { .. });
        if indices.radius.is_none() && needs_radius {
            let problem = format!("no radius or diameter among {}; write one of them", columns.names());
            return Err(SceneError::file(&columns.file, problem));
        }
        let names = Names::new(&context.materials, &columns, first_type)?;
        let place = RowPlace::Line(0);
        let (periods, particles, numbers) = (Vec::new(), Particles::default(), Vec::new());
        Ok(Self { context, columns, indices, names, periods, particles, numbers, place })
    }

    /// Adds a box into which places are taken back.
    pub(super) fn wrap(&mut self, periods: Vec<Period>) {
        self.periods = periods;
    }

    /// Adds the grain of a row.
    ///
    /// # Errors
    /// Bad values, with their place.
    pub(super) fn add(&mut self, row: &impl Row) -> Result<(), SceneError> {
        let grain = self.grain(row)?;
        self.particles.push(grain);
        self.place = row.place();
        // More than 2³² rows do not fit anyway.
        self.numbers.push(u32::try_from(self.place.number()).unwrap_or(u32::MAX));
        Ok(())
    }

    fn grain(&mut self, row: &impl Row) -> Result<Grain, SceneError> {
        let id = self.id(row)?;
        let position = self.position(row)?;
        let (material, group) = self.names.of(&self.columns, row)?;
        let (columns, indices) = (&self.columns, &self.indices);
        let optional = |column: Option<usize>, range| match column {
            Some(column) => columns.number(row, column, range),
            None => Ok(0.0),
        };
        let vector = |three: [Option<usize>; 3]| -> Result<Vector3<f64>, SceneError> {
            let [x, y, z] = three;
            Ok(Vector3::new(optional(x, SPEED)?, optional(y, SPEED)?, optional(z, SPEED)?))
        };
        let is_free =
            self.context.allow_points || matches!(self.context.materials, MaterialNames::File { .. });
        let radius = optional(indices.radius, if is_free { RADIUS_OR_POINT } else { RADIUS })?;
        let density = match (indices.density, indices.mass) {
            (Some(column), _) => columns.number(row, column, DENSITY)?,
            (None, Some(column)) if radius > 0.0 => {
                let density = columns.number(row, column, MASS)? / (4.0 / 3.0 * PI * radius.powi(3));
                if !DENSITY.contains(density) {
                    let problem = format!("a density of {density:.3e} kg/m³; give one {DENSITY}");
                    return Err(columns.bad(row, column, &problem));
                }
                density
            }
            _ => self.context.materials.density(material),
        };
        let charge = optional(indices.charge, CHARGE)?;
        if let Some(column) = indices.charge.filter(|_| charge != 0.0 && charge.abs() < LEAST_CHARGE) {
            return Err(columns.bad(
                row,
                column,
                &format!("smaller than {LEAST_CHARGE:e} C but not 0; write 0 for a grain without charge"),
            ));
        }
        let (velocity, angular_velocity) = (vector(indices.velocity)?, vector(indices.spin)?);
        Ok(Grain { id, position, velocity, angular_velocity, radius, density, charge, material, group })
    }

    fn id(&self, row: &impl Row) -> Result<u64, SceneError> {
        match self.indices.id {
            Some(column) => row
                .text(column)
                .parse()
                .map_err(|_| self.columns.bad(row, column, "not a whole number from 0 to 2^64 - 1")),
            None => Ok(self.particles.len() as u64 + 1),
        }
    }

    fn position(&self, row: &impl Row) -> Result<Vector3<f64>, SceneError> {
        let mut position = Vector3::zeros();
        for (axis, column) in self.indices.position.into_iter().enumerate() {
            position[axis] = self.columns.number(row, column, COORDINATE)?;
            for period in self.periods.iter().filter(|period| period.axis == axis) {
                position[axis] = period.wrap(position[axis]);
            }
            if let Some(domain) = self.context.domain {
                let (low, high) = (domain.min()[axis], domain.max()[axis]);
                if position[axis] < low || position[axis] > high {
                    let place = if self.columns.is_converted(column) {
                        format!("{} m, ", position[axis])
                    } else {
                        String::new()
                    };
                    let problem = format!(
                        "{place}outside the domain, {low} to {high} m; move the grain or enlarge the domain"
                    );
                    return Err(self.columns.bad(row, column, &problem));
                }
            }
        }
        Ok(position)
    }

    /// Grains that were read.
    ///
    /// # Errors
    /// No grains, and ids that are used twice.
    pub(super) fn finish(self) -> Result<Snapshot, SceneError> {
        let file = &self.columns.file;
        if self.particles.is_empty() {
            return Err(SceneError::file(file, "a header row but no grains; add rows"));
        }
        if let Some([before, again]) = used_twice(&self.particles.id) {
            let (before, place) =
                (self.place.at(self.numbers[before].into()), self.place.at(self.numbers[again].into()));
            let problem = format!(
                "id = \"{}\": {} has this id already; give each grain its own",
                self.particles.id[again],
                before.named()
            );
            return Err(refuse(file, place, problem));
        }
        let ColumnIndices { radius, charge, velocity, spin, density, mass, .. } = self.indices;
        let given = Given {
            radius: radius.is_some(),
            charge: charge.is_some(),
            velocity: velocity.iter().any(Option::is_some),
            angular_velocity: spin.iter().any(Option::is_some),
            density: density.is_some() || mass.is_some(),
            material: self.names.has_materials(),
        };
        let mut unused = self.columns.unused();
        if mass.is_none() && density.is_none() && self.columns.find("mass_kg").is_some() {
            unused.push("mass".to_owned());
        }
        let (materials, groups) = self.names.finish();
        Ok(Snapshot { given, materials, groups, unused, ..Snapshot::of(self.particles) })
    }
}

/// Rows of the first id that was used before, and where.
fn used_twice(ids: &[u64]) -> Option<[usize; 2]> {
    if ids.is_sorted_by(|a, b| a < b) {
        return None;
    }
    let mut rows: Vec<usize> = (0..ids.len()).collect();
    rows.sort_by_key(|row| ids[*row]);
    let pairs = rows.windows(2).filter(|rows| ids[rows[0]] == ids[rows[1]]);
    pairs.map(|rows| [rows[0], rows[1]]).min_by_key(|rows| rows[1])
}
