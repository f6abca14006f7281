//! Particles for ParaView: VTK XML unstructured grid, one vertex per grain, raw appended data.
//!
//! Written here rather than by a library: docs/decisions/mesh-and-vtk-files.md says why.

use super::atomic::write_atomically;
use crate::SceneError;
use amberfield_core::Particles;
use nalgebra::Vector3;
use std::io::{self, Write};
use std::path::Path;

/// Values of an array.
enum Values<'a> {
    Vectors(&'a [Vector3<f64>]),
    Numbers(&'a [f64]),
    Ids(&'a [u64]),
    Groups(Vec<u16>),
    /// 0, 1, 2, … or 1, 2, 3, …: what the cells are made of.
    Count {
        from: i64,
        count: usize,
    },
    /// VTK cell types.
    CellTypes(Vec<u8>),
    Integers(Vec<i64>),
}

impl Values<'_> {
    fn kind(&self) -> (&'static str, usize) {
        match self {
            Self::Vectors(_) => ("Float64", 3),
            Self::Numbers(_) => ("Float64", 1),
            Self::Ids(_) => ("UInt64", 1),
            Self::Groups(_) => ("UInt16", 1),
            Self::Count { .. } => ("Int64", 1),
            Self::CellTypes(_) => ("UInt8", 1),
            Self::Integers(_) => ("Int64", 1),
        }
    }

    fn bytes(&self) -> usize {
        match self {
            Self::Vectors(values) => 24 * values.len(),
            Self::Numbers(values) => 8 * values.len(),
            Self::Ids(values) => 8 * values.len(),
            Self::Groups(values) => 2 * values.len(),
            Self::Count { count, .. } => 8 * count,
            Self::CellTypes(types) => types.len(),
            Self::Integers(values) => 8 * values.len(),
        }
    }

    fn write(&self, writer: &mut dyn Write) -> io::Result<()> {
        writer.write_all(&(self.bytes() as u64).to_le_bytes())?;
        match self {
            Self::Vectors(values) => {
                values.iter().flatten().try_for_each(|value| writer.write_all(&value.to_le_bytes()))
            }
            Self::Numbers(values) => {
                values.iter().try_for_each(|value| writer.write_all(&value.to_le_bytes()))
            }
            Self::Ids(values) => values.iter().try_for_each(|value| writer.write_all(&value.to_le_bytes())),
            Self::Groups(values) => {
                values.iter().try_for_each(|value| writer.write_all(&value.to_le_bytes()))
            }
            Self::Count { from, count } => {
                (0_i64..).take(*count).try_for_each(|value| writer.write_all(&(value + from).to_le_bytes()))
            }
            Self::CellTypes(types) => writer.write_all(types),
            Self::Integers(values) => {
                values.iter().try_for_each(|value| writer.write_all(&value.to_le_bytes()))
            }
        }
    }
}

/// VTK's numbers of cell types.
const VERTEX: u8 = 1;
const TRIANGLE: u8 = 5;
const QUAD: u8 = 9;

/// An array with its name.
type Named<'a> = (&'a str, Values<'a>);

/// Writes grains: position, id, radius, charge, velocities, material, group, and further vectors by name, one per
/// grain.
///
/// # Errors
/// What the system says.
pub fn write_vtu(
    path: &Path,
    particles: &Particles,
    vectors: &[(&str, &[Vector3<f64>])],
) -> Result<(), SceneError> {
    let count = particles.len();
    let mut point_data = vec![
        ("id", Values::Ids(&particles.id)),
        ("radius_m", Values::Numbers(&particles.radius)),
        ("charge_C", Values::Numbers(&particles.charge)),
        ("velocity_m_s", Values::Vectors(&particles.velocity)),
        ("angular_velocity_rad_s", Values::Vectors(&particles.angular_velocity)),
        ("material", Values::Groups(particles.material.iter().map(|material| material.0).collect())),
        ("group", Values::Groups(particles.group.iter().map(|group| group.0).collect())),
    ];
    point_data.extend(vectors.iter().map(|(name, values)| (*name, Values::Vectors(values))));
    let points = [("points_m", Values::Vectors(&particles.position))];
    let cells = [
        ("connectivity", Values::Count { from: 0, count }),
        ("offsets", Values::Count { from: 1, count }),
        ("types", Values::CellTypes(vec![VERTEX; count])),
    ];
    let sections = [("PointData", &point_data[..]), ("Points", &points), ("Cells", &cells)];
    write_sections(path, [count, count], &sections)
}

/// A facet of a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetCell {
    /// Number of the wall.
    pub wall: u32,
    /// Corners in order [m]; the last is the third of a triangle.
    pub corners: [Vector3<f64>; 4],
    /// Area [m²].
    pub area_m2: f64,
    /// Charge [C].
    pub charge_c: f64,
}

/// Writes charged facets of walls: triangles and quadrangles with their wall, charge and charge per area.
///
/// # Errors
/// What the system says.
pub fn write_facets_vtu(path: &Path, facets: &[FacetCell]) -> Result<(), SceneError> {
    let corners = |facet: &FacetCell| if facet.corners[2] == facet.corners[3] { 3 } else { 4 };
    let points: Vec<_> =
        facets.iter().flat_map(|facet| facet.corners.into_iter().take(corners(facet))).collect();
    let ends = facets.iter().scan(0_i64, |end, facet| {
        *end += corners(facet) as i64;
        Some(*end)
    });
    let types = facets.iter().map(|facet| if corners(facet) == 3 { TRIANGLE } else { QUAD });
    let charges: Vec<f64> = facets.iter().map(|facet| facet.charge_c).collect();
    let densities: Vec<f64> = facets.iter().map(|facet| facet.charge_c / facet.area_m2).collect();
    let cell_data = [
        ("wall", Values::Integers(facets.iter().map(|facet| i64::from(facet.wall)).collect())),
        ("charge_C", Values::Numbers(&charges)),
        ("charge_density_C_m2", Values::Numbers(&densities)),
    ];
    let cells = [
        ("connectivity", Values::Count { from: 0, count: points.len() }),
        ("offsets", Values::Integers(ends.collect())),
        ("types", Values::CellTypes(types.collect())),
    ];
    let sections = [
        ("CellData", &cell_data[..]),
        ("Points", &[("points_m", Values::Vectors(&points))]),
        ("Cells", &cells),
    ];
    write_sections(path, [points.len(), facets.len()], &sections)
}

/// Writes a grid with so many points and cells.
fn write_sections(
    path: &Path,
    [points, cells]: [usize; 2],
    sections: &[(&str, &[Named<'_>])],
) -> Result<(), SceneError> {
    write_atomically(path, |writer| {
        writeln!(
            writer,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">"
        )?;
        writeln!(
            writer,
            "<UnstructuredGrid>\n<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">"
        )?;
        let mut offset = 0;
        for (section, arrays) in sections {
            writeln!(writer, "<{section}>")?;
            for (name, values) in *arrays {
                let (kind, components) = values.kind();
                writeln!(
                    writer,
                    "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{offset}\"/>"
                )?;
                offset += 8 + values.bytes();
            }
            writeln!(writer, "</{section}>")?;
        }
        write!(writer, "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_")?;
        for (_, values) in sections.iter().flat_map(|(_, arrays)| *arrays) {
            values.write(writer)?;
        }
        writeln!(writer, "\n</AppendedData>\n</VTKFile>")
    })
}
