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
    /// The VTK cell type of a vertex, once per grain.
    VertexType(usize),
}

impl Values<'_> {
    fn kind(&self) -> (&'static str, usize) {
        match self {
            Self::Vectors(_) => ("Float64", 3),
            Self::Numbers(_) => ("Float64", 1),
            Self::Ids(_) => ("UInt64", 1),
            Self::Groups(_) => ("UInt16", 1),
            Self::Count { .. } => ("Int64", 1),
            Self::VertexType(_) => ("UInt8", 1),
        }
    }

    fn bytes(&self) -> usize {
        match self {
            Self::Vectors(values) => 24 * values.len(),
            Self::Numbers(values) => 8 * values.len(),
            Self::Ids(values) => 8 * values.len(),
            Self::Groups(values) => 2 * values.len(),
            Self::Count { count, .. } => 8 * count,
            Self::VertexType(count) => *count,
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
            Self::VertexType(count) => (0..*count).try_for_each(|_| writer.write_all(&[1])),
        }
    }
}

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
        ("types", Values::VertexType(count)),
    ];
    write_atomically(path, |writer| {
        writeln!(
            writer,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">"
        )?;
        writeln!(writer, "<UnstructuredGrid>\n<Piece NumberOfPoints=\"{count}\" NumberOfCells=\"{count}\">")?;
        let mut offset = 0;
        for (section, arrays) in [("PointData", &point_data[..]), ("Points", &points), ("Cells", &cells)] {
            writeln!(writer, "<{section}>")?;
            for (name, values) in arrays {
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
        for (_, values) in point_data.iter().chain(&points).chain(&cells) {
            values.write(writer)?;
        }
        writeln!(writer, "\n</AppendedData>\n</VTKFile>")
    })
}
