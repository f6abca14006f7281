//! File `.vtu` for ParaView: VTK XML unstructured grid with one vertex per grain, and raw appended data.
//!
//! The reason why no library writes it is in docs/decisions/mesh-and-vtk-files.md.

use super::atomic::write_atomically;
use crate::SceneError;
use crate::files::{GRAINS_VTU, WALL_CHARGE, WALL_SURFACES, When};
use amberfield_core::Particles;
use nalgebra::Vector3;
use std::io::{self, Write};
use std::path::Path;

/// Values of a data array.
pub(super) enum Values<'a> {
    Vectors(&'a [Vector3<f64>]),
    Numbers(&'a [f64]),
    Ids(&'a [u64]),
    Groups(Vec<u16>),
    /// Consecutive integers `from`, `from` + 1, …
    Count {
        from: i64,
        count: usize,
    },
    /// VTK cell types.
    CellTypes(Vec<u8>),
    Integers(Vec<i64>),
}

impl Values<'_> {
    /// VTK's name of the type of a number.
    fn number_type(&self) -> &'static str {
        match self {
            Self::Vectors(_) | Self::Numbers(_) => "Float64",
            Self::Ids(_) => "UInt64",
            Self::Groups(_) => "UInt16",
            Self::Count { .. } | Self::Integers(_) => "Int64",
            Self::CellTypes(_) => "UInt8",
        }
    }

    /// Numbers of one entry of the array.
    fn components(&self) -> usize {
        match self {
            Self::Vectors(_) => 3,
            _ => 1,
        }
    }

    /// Length of the data [bytes].
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

    /// Writes the length and the data, little endian.
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

/// VTK's number of the cell type vertex.
const VERTEX: u8 = 1;
/// VTK's number of the cell type polygon.
const POLYGON: u8 = 7;
/// VTK's number of the cell type quadrangle.
const QUAD: u8 = 9;

/// Data array with its name.
pub(super) type Named<'a> = (&'a str, Values<'a>);

/// Gives arrays the next names of a table, and takes no more than these.
fn named<'a>(names: &mut impl Iterator<Item = &'static str>, arrays: Vec<Values<'a>>) -> Vec<Named<'a>> {
    arrays.into_iter().zip(names).map(|(array, name)| (name, array)).collect()
}

/// Writes grains: position, id, radius, density, charge, velocities, material and group.
///
/// `vectors` are further vectors with their names, one for each grain.
///
/// # Errors
/// Errors of the operating system.
pub fn write_vtu(
    path: &Path,
    particles: &Particles,
    vectors: &[(&str, &[Vector3<f64>])],
) -> Result<(), SceneError> {
    let count = particles.len();
    let mut names = GRAINS_VTU.names(|when| when == When::Always);
    let mut point_data = named(
        &mut names,
        vec![
            Values::Ids(&particles.id),
            Values::Numbers(&particles.radius),
            Values::Numbers(&particles.density),
            Values::Numbers(&particles.charge),
            Values::Vectors(&particles.velocity),
            Values::Vectors(&particles.angular_velocity),
            Values::Groups(particles.material.iter().map(|material| material.0).collect()),
            Values::Groups(particles.group.iter().map(|group| group.0).collect()),
        ],
    );
    point_data.extend(vectors.iter().map(|(name, values)| (*name, Values::Vectors(values))));
    let points = named(&mut names, vec![Values::Vectors(&particles.position)]);
    let vertices = vec![
        Values::Count { from: 0, count },
        Values::Count { from: 1, count },
        Values::CellTypes(vec![VERTEX; count]),
    ];
    let cells = named(&mut names, vertices);
    let sections = [("PointData", &point_data[..]), ("Points", &points), ("Cells", &cells)];
    write_sections(path, &GridSize { points: count, cells: count, before: "" }, &sections)
}

/// Writes points with their arrays; `before` is an element that stands before the piece.
pub(super) fn write_grains(
    path: &Path,
    places: &[Vector3<f64>],
    arrays: &[Named<'_>],
    before: &str,
) -> Result<(), SceneError> {
    let count = places.len();
    let points = [("points_m", Values::Vectors(places))];
    let cells = [
        ("connectivity", Values::Count { from: 0, count }),
        ("offsets", Values::Count { from: 1, count }),
        ("types", Values::CellTypes(vec![VERTEX; count])),
    ];
    let sections = [("PointData", arrays), ("Points", &points), ("Cells", &cells)];
    write_sections(path, &GridSize { points: count, cells: count, before }, &sections)
}

/// Square around a charged place of a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChargedSquare {
    /// Number of the wall.
    pub wall: u32,
    /// Corners in order [m].
    pub corners: [Vector3<f64>; 4],
    /// Charge of the place [C].
    pub charge_c: f64,
    /// Charge per area there, with that of its neighbours [C/m²].
    pub density_c_m2: f64,
}

/// Writes the charged places of walls as squares, with their wall, charge and charge per area.
///
/// # Errors
/// Errors of the operating system.
pub fn write_charge_vtu(path: &Path, squares: &[ChargedSquare]) -> Result<(), SceneError> {
    let points: Vec<_> = squares.iter().flat_map(|square| square.corners).collect();
    let ends = (1..=squares.len()).map(|square| 4 * square as i64);
    let charges: Vec<f64> = squares.iter().map(|square| square.charge_c).collect();
    let densities: Vec<f64> = squares.iter().map(|square| square.density_c_m2).collect();
    let mut names = WALL_CHARGE.names(|when| when == When::Always);
    let walls = squares.iter().map(|square| i64::from(square.wall)).collect();
    let cell_data = vec![Values::Integers(walls), Values::Numbers(&charges), Values::Numbers(&densities)];
    let cell_data = named(&mut names, cell_data);
    let corners = named(&mut names, vec![Values::Vectors(&points)]);
    let quadrangles = vec![
        Values::Count { from: 0, count: points.len() },
        Values::Integers(ends.collect()),
        Values::CellTypes(vec![QUAD; squares.len()]),
    ];
    let cells = named(&mut names, quadrangles);
    let sections = [("CellData", &cell_data[..]), ("Points", &corners), ("Cells", &cells)];
    write_sections(path, &GridSize { points: points.len(), cells: squares.len(), before: "" }, &sections)
}

/// Face of a wall.
#[derive(Clone, Debug, PartialEq)]
pub struct WallFace {
    /// Number of the wall.
    pub wall: u32,
    /// Corners in order [m].
    pub corners: Vec<Vector3<f64>>,
}

/// Writes faces of walls, with the number of their wall.
///
/// # Errors
/// Errors of the operating system.
pub fn write_walls_vtu(path: &Path, faces: &[WallFace]) -> Result<(), SceneError> {
    let points: Vec<_> = faces.iter().flat_map(|face| face.corners.iter().copied()).collect();
    let ends = faces.iter().scan(0, |end, face| {
        *end += face.corners.len() as i64;
        Some(*end)
    });
    let mut names = WALL_SURFACES.names(|when| when == When::Always);
    let walls = faces.iter().map(|face| i64::from(face.wall)).collect();
    let cell_data = named(&mut names, vec![Values::Integers(walls)]);
    let corners = named(&mut names, vec![Values::Vectors(&points)]);
    let polygons = vec![
        Values::Count { from: 0, count: points.len() },
        Values::Integers(ends.collect()),
        Values::CellTypes(vec![POLYGON; faces.len()]),
    ];
    let cells = named(&mut names, polygons);
    let sections = [("CellData", &cell_data[..]), ("Points", &corners), ("Cells", &cells)];
    write_sections(path, &GridSize { points: points.len(), cells: faces.len(), before: "" }, &sections)
}

/// Size of a grid.
struct GridSize<'a> {
    /// Number of points.
    points: usize,
    /// Number of cells.
    cells: usize,
    /// Element before the piece; empty for none.
    before: &'a str,
}

/// Writes a grid of the given size.
fn write_sections(
    path: &Path,
    size: &GridSize<'_>,
    sections: &[(&str, &[Named<'_>])],
) -> Result<(), SceneError> {
    write_atomically(path, |writer| {
        writeln!(
            writer,
            "<?xml version=\"1.0\"?>\n\
             <VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
             header_type=\"UInt64\">"
        )?;
        writeln!(
            writer,
            "<UnstructuredGrid>\n{}<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">",
            size.before, size.points, size.cells
        )?;
        let mut offset = 0;
        for (section, arrays) in sections {
            writeln!(writer, "<{section}>")?;
            for (name, values) in *arrays {
                let (number_type, components) = (values.number_type(), values.components());
                writeln!(
                    writer,
                    "<DataArray type=\"{number_type}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
                     format=\"appended\" offset=\"{offset}\"/>"
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
