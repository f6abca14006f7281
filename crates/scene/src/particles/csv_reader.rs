//! Reader of a particles CSV.

use super::columns::{CsvColumns, csv_error, line};
use crate::SceneError;
use crate::limits::{CHARGE, COORDINATE, DENSITY, RADIUS, RADIUS_OR_POINT, SPEED};
use crate::materials::Materials;
use crate::source::decode;
use amberfield_core::{Domain, Grain, GroupId, MaterialId, Particles};
use csv::StringRecord;
use nalgebra::Vector3;
use std::io::Read;

/// Columns of a particles CSV.
const COLUMNS: [&str; 15] = [
    "id",
    "x_m",
    "y_m",
    "z_m",
    "radius_m",
    "charge_C",
    "vx_m_s",
    "vy_m_s",
    "vz_m_s",
    "wx_rad_s",
    "wy_rad_s",
    "wz_rad_s",
    "density_kg_m3",
    "material",
    "group",
];
/// Columns that are required.
const REQUIRED: [&str; 5] = ["id", "x_m", "y_m", "z_m", "radius_m"];

/// Smallest charge other than 0 [C]: the square of a smaller one underflows.
const LEAST_CHARGE: f64 = 1e-100;

/// Parts of the scene that a particles file is checked against.
pub(crate) struct CsvContext<'a> {
    /// Box that grains must lie in.
    pub(crate) domain: Option<&'a Domain>,
    /// Materials by name.
    pub(crate) materials: &'a Materials,
    /// Switch for grains of radius 0, which a field without motion allows.
    pub(crate) allow_points: bool,
}

/// Particles of a file or a generator.
#[derive(Debug)]
pub(crate) struct ReadParticles {
    /// Particles, in the order of the file.
    pub(crate) particles: Particles,
    /// Names of the groups, `all` first.
    pub(crate) groups: Vec<String>,
    /// Flag of charges that were given; without, all charges are 0.
    pub(crate) has_charge: bool,
}

/// Indices of the columns in one file; `None` for a column that is absent.
struct ColumnIndices {
    id: usize,
    position: [usize; 3],
    radius: usize,
    charge: Option<usize>,
    velocity: [Option<usize>; 3],
    spin: [Option<usize>; 3],
    density: Option<usize>,
    material: Option<usize>,
    group: Option<usize>,
}

impl ColumnIndices {
    fn new(columns: &CsvColumns<'_>) -> Self {
        let required = |name: &str| columns.find(name).expect("required columns were checked");
        Self {
            id: required("id"),
            position: ["x_m", "y_m", "z_m"].map(required),
            radius: required("radius_m"),
            charge: columns.find("charge_C"),
            velocity: ["vx_m_s", "vy_m_s", "vz_m_s"].map(|name| columns.find(name)),
            spin: ["wx_rad_s", "wy_rad_s", "wz_rad_s"].map(|name| columns.find(name)),
            density: columns.find("density_kg_m3"),
            material: columns.find("material"),
            group: columns.find("group"),
        }
    }
}

fn csv_reader<R: Read>(bytes: R) -> csv::Reader<R> {
    csv::ReaderBuilder::new().flexible(false).from_reader(bytes)
}

/// Reads a particles CSV, row by row: a file of 10⁷ grains is as large as the grains.
///
/// # Errors
/// Bad header, bad values, duplicate ids, grains outside the domain: with line, column and value.
pub(crate) fn read_particles(
    file: &str,
    bytes: impl Read,
    context: &CsvContext<'_>,
) -> Result<ReadParticles, SceneError> {
    let mut reader = csv_reader(bytes);
    let header = reader.headers().map_err(|error| csv_error(file, &error))?;
    let columns = CsvColumns::new(file, header, &COLUMNS, &REQUIRED)?;
    let indices = ColumnIndices::new(&columns);
    let mut read = ReadParticles {
        particles: Particles::default(),
        groups: vec!["all".to_owned()],
        has_charge: indices.charge.is_some(),
    };
    let (mut record, mut lines) = (StringRecord::new(), Vec::new());
    while reader.read_record(&mut record).map_err(|error| csv_error(file, &error))? {
        let grain = read_grain(&columns, &indices, &record, context, &mut read.groups)?;
        read.particles.push(grain);
        // More than 2³² lines do not fit anyway.
        lines.push(u32::try_from(line(&record)).unwrap_or(u32::MAX));
    }
    if read.particles.is_empty() {
        return Err(SceneError::file(file, "a header row but no grains; add rows"));
    }
    if let Some([before, again]) = used_twice(&read.particles.id) {
        let (id, before, line) = (read.particles.id[again], lines[before], lines[again]);
        let problem = format!("id = \"{id}\": line {before} has this id already; give each grain its own");
        return Err(SceneError::data(file, line.into(), problem));
    }
    Ok(read)
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

fn read_grain(
    columns: &CsvColumns<'_>,
    indices: &ColumnIndices,
    record: &StringRecord,
    context: &CsvContext<'_>,
    groups: &mut Vec<String>,
) -> Result<Grain, SceneError> {
    let id = record.get(indices.id).unwrap_or_default().trim();
    let id =
        id.parse().map_err(|_| columns.bad(record, indices.id, "not a whole number from 0 to 2^64 - 1"))?;
    let mut position = Vector3::zeros();
    for (axis, column) in indices.position.into_iter().enumerate() {
        position[axis] = columns.number(record, column, COORDINATE)?;
        if let Some(domain) = context.domain {
            let (low, high) = (domain.min()[axis], domain.max()[axis]);
            if position[axis] < low || position[axis] > high {
                let problem =
                    format!("outside the domain, {low} to {high} m; move the grain or enlarge the domain");
                return Err(columns.bad(record, column, &problem));
            }
        }
    }
    let optional = |column: Option<usize>, range| match column {
        Some(column) => columns.number(record, column, range),
        None => Ok(0.0),
    };
    let vector = |three: [Option<usize>; 3]| -> Result<Vector3<f64>, SceneError> {
        Ok(Vector3::new(optional(three[0], SPEED)?, optional(three[1], SPEED)?, optional(three[2], SPEED)?))
    };
    let material = read_material(columns, indices, record, context.materials)?;
    let density = match indices.density {
        Some(column) => columns.number(record, column, DENSITY)?,
        None => context.materials.density(material),
    };
    let charge = optional(indices.charge, CHARGE)?;
    if let Some(column) = indices.charge.filter(|_| charge != 0.0 && charge.abs() < LEAST_CHARGE) {
        return Err(columns.bad(
            record,
            column,
            &format!("smaller than {LEAST_CHARGE:e} C but not 0; write 0 for a grain without charge"),
        ));
    }
    let radius_range = if context.allow_points { RADIUS_OR_POINT } else { RADIUS };
    Ok(Grain {
        id,
        position,
        velocity: vector(indices.velocity)?,
        angular_velocity: vector(indices.spin)?,
        radius: columns.number(record, indices.radius, radius_range)?,
        density,
        charge,
        material,
        group: read_group(columns, indices, record, groups)?,
    })
}

fn read_material(
    columns: &CsvColumns<'_>,
    indices: &ColumnIndices,
    record: &StringRecord,
    materials: &Materials,
) -> Result<MaterialId, SceneError> {
    match indices.material {
        Some(column) => {
            let name = record.get(column).unwrap_or_default().trim();
            materials.find(name).map_err(|problem| columns.bad(record, column, &problem))
        }
        None => materials.default_id().ok_or_else(|| {
            let count = materials.list.len();
            columns.bad(
                record,
                indices.id,
                &format!("the scene has {count} materials and the file has no column material; add it"),
            )
        }),
    }
}

fn read_group(
    columns: &CsvColumns<'_>,
    indices: &ColumnIndices,
    record: &StringRecord,
    groups: &mut Vec<String>,
) -> Result<GroupId, SceneError> {
    let Some(column) = indices.group else { return Ok(GroupId(0)) };
    let name = record.get(column).unwrap_or_default().trim();
    if name.is_empty() {
        return Ok(GroupId(0));
    }
    let index = match groups.iter().position(|group| group == name) {
        Some(index) => index,
        None => {
            groups.push(name.to_owned());
            groups.len() - 1
        }
    };
    u16::try_from(index)
        .map(GroupId)
        .map_err(|_| columns.bad(record, column, "more than 65536 groups; merge some"))
}

/// Reads the column `charge_C` [C] of a file for a generator, one row per grain.
///
/// # Errors
/// As [`read_particles`]; another number of rows than grains.
pub(crate) fn read_charges(file: &str, bytes: &[u8], count: usize) -> Result<Vec<f64>, SceneError> {
    decode(file, bytes)?;
    let mut reader = csv_reader(bytes);
    let header = reader.headers().map_err(|error| csv_error(file, &error))?;
    let columns = CsvColumns::new(file, header, &COLUMNS, &["charge_C"])?;
    let column = columns.find("charge_C").expect("required columns were checked");
    let mut charges = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| csv_error(file, &error))?;
        charges.push(columns.number(&record, column, CHARGE)?);
        if charges.len() > count {
            return Err(SceneError::data(
                file,
                line(&record),
                format!("more rows than the {count} grains of the generator; remove some"),
            ));
        }
    }
    if charges.len() < count {
        return Err(SceneError::file(
            file,
            format!("{} rows for {count} grains of the generator; give one charge per grain", charges.len()),
        ));
    }
    Ok(charges)
}
