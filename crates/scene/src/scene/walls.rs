//! Sections `[[walls]]`.

use super::wall_field::{Surroundings, read_wall_field};
use super::wall_motion::read_motion;
use crate::SceneError;
use crate::error::Problems;
use crate::materials::Materials;
use crate::poly_mesh::{PatchError, PolyMesh};
use crate::source::SceneSource;
use crate::stl::{Surface, read_stl};
use crate::table::SceneTable;
use amberfield_core::{Conductor, Domain, Fingerprint, TriangleMesh, Wall, WallCharging, WallShape};

/// Length below which a normal has no direction.
const SHORTEST_NORMAL: f64 = 1e-100;

/// Largest size of a surface over that of the domain.
const LARGEST: f64 = 1000.0;

/// Advice for a wall without a shape.
const SHAPES: &str = "give stl = \"file.stl\", plane = { point_m = [0, 0, 0], normal = [0, 0, 1] } or, with \
                      [solver], patch = \"name\"";

/// Walls of a scene.
pub(super) struct ReadWalls {
    pub(super) walls: Vec<Wall>,
    /// `OpenFOAM` patch of each wall.
    pub(super) patches: Vec<Option<String>>,
    /// Walls that bound the field, in their order.
    pub(super) conductors: Vec<Conductor>,
    pub(super) warnings: Vec<String>,
}

/// One wall of a scene.
struct ReadWall {
    wall: Wall,
    /// `OpenFOAM` patch with the same surface.
    patch: Option<String>,
    /// Conductor that it is to the field, where it bounds it.
    conductor: Option<Conductor>,
}

/// Reads `[[walls]]`.
pub(super) fn read_walls(
    document: &SceneTable<'_>,
    materials: &Materials,
    around: Surroundings<'_>,
    source: &mut SceneSource,
) -> Result<ReadWalls, SceneError> {
    let (walls, patches, conductors, warnings) = Default::default();
    let mut read = ReadWalls { walls, patches, conductors, warnings };
    let mut mesh = around.solver.map(|solver| PolyMesh::of(&solver.openfoam_case, source.mesh()));
    let mut problems = Problems::default();
    for table in document.tables("walls")?.into_iter().flatten() {
        let wall = table.and_then(|table| {
            let mut read = read_wall(&table, materials, mesh.as_mut(), source, &mut read.warnings)?;
            check_size(&table, &read.wall, around.domain)?;
            read.conductor = read_wall_field(&table, &read.wall, around)?;
            read.wall.bounds_field |= read.conductor.is_some();
            Ok(read)
        });
        // Whoever can make the mesh does so and reads the scene again.
        if let Err(error @ SceneError::NoMesh { .. }) = wall {
            return Err(error);
        }
        if let Some(ReadWall { wall, patch, conductor }) = problems.keep(wall) {
            read.walls.push(wall);
            read.patches.push(patch);
            read.conductors.extend(conductor);
        }
    }
    problems.finish().map(|()| read)
}

fn read_wall(
    table: &SceneTable<'_>,
    materials: &Materials,
    mut mesh: Option<&mut PolyMesh>,
    source: &mut SceneSource,
    warnings: &mut Vec<String>,
) -> Result<ReadWall, SceneError> {
    let material = materials.named_by(table, "material")?;
    let charging = table.word(
        "charging",
        &[
            ("grounded", WallCharging::Grounded),
            ("insulating", WallCharging::Insulating),
            ("none", WallCharging::None),
        ],
    )?;
    let patch = table.text("patch")?;
    if let (Some(patch), Some(mesh)) = (patch, mesh.as_mut()) {
        mesh.check(patch).map_err(|error| refusal(table, error))?;
    }
    let (name, shape) = match (table.text("stl")?, table.has("plane")) {
        (Some(stl), false) => {
            let scale = table.number("scale")?.unwrap_or(1.0);
            let bytes = source.read_file(table, "stl", stl)?;
            let Surface { mesh, dropped } = read_stl(stl, &bytes, scale)?;
            if dropped > 0 {
                warnings.push(format!("{stl}: {dropped} degenerate triangles (no area) were dropped"));
            }
            (stl.to_owned(), WallShape::Mesh(mesh))
        }
        (None, true) if table.has("scale") => {
            return Err(table.bad("scale", "a plane has no scale; remove it"));
        }
        (None, true) => (table.key("plane"), read_plane(table)?),
        (Some(_), true) => {
            return Err(table.bad("plane", "the wall has an stl already; give one of stl, plane"));
        }
        (None, false) => {
            let patch = table.need(patch, "stl", SHAPES)?;
            let surface = read_patch(table, patch, mesh, source)?;
            (patch.to_owned(), WallShape::Mesh(surface))
        }
    };
    // Unless the scene says otherwise, surfaces are grounded conductors and planes take no charge.
    let usual = if matches!(shape, WallShape::Mesh(_)) { WallCharging::Grounded } else { WallCharging::None };
    let bounds_field = patch.is_some();
    let patch = patch.map(ToOwned::to_owned);
    let charging = charging.unwrap_or(usual);
    let motion = read_motion(table, source)?;
    let wall = Wall { name, shape, material, charging, bounds_field, motion };
    Ok(ReadWall { wall, patch, conductor: None })
}

/// Refuses a surface that is so large that its file is in another unit.
fn check_size(table: &SceneTable<'_>, wall: &Wall, domain: Option<&Domain>) -> Result<(), SceneError> {
    let WallShape::Mesh(mesh) = &wall.shape else { return Ok(()) };
    let (Some([low, high]), Some(domain), true) = (mesh.bounds(), domain, table.has("stl")) else {
        return Ok(());
    };
    let (size, extent) = ((high - low).max(), domain.extent().max());
    if size <= LARGEST * extent {
        return Ok(());
    }
    let problem = format!(
        "the surface is {size:.3e} m large, {:.1e} times the domain; its scale is missing or wrong: give \
         scale = 1e-3 for a file in mm",
        size / extent
    );
    Err(table.bad(if table.has("scale") { "scale" } else { "stl" }, problem))
}

/// Surface of a patch of the solver's mesh.
fn read_patch(
    table: &SceneTable<'_>,
    patch: &str,
    mesh: Option<&mut PolyMesh>,
    source: &mut SceneSource,
) -> Result<TriangleMesh, SceneError> {
    if table.has("scale") {
        return Err(table.bad("scale", "a patch has no scale, its mesh is in metres; remove it"));
    }
    let Some(mesh) = mesh else {
        return Err(table.bad(
            "patch",
            "there is no mesh whose patch the wall could be; add [solver] with openfoam_case, or give the \
             wall an stl or a plane",
        ));
    };
    let surface = mesh.surface(patch).map_err(|error| refusal(table, error))?;
    // How the mesh's files are written does not matter, only what they say.
    let mut print = Fingerprint::new();
    for vertex in &surface.vertices {
        vertex.iter().for_each(|x| print.add(&x.to_le_bytes()));
    }
    for vertex in surface.triangles.iter().flatten() {
        print.add(&vertex.to_le_bytes());
    }
    source.add(&format!("patch {patch}"), &print);
    Ok(surface)
}

/// Error about a wall's patch.
fn refusal(table: &SceneTable<'_>, error: PatchError) -> SceneError {
    match error {
        PatchError::Patch(problem) => table.bad("patch", problem),
        PatchError::Mesh(error) => error,
    }
}

fn read_plane(table: &SceneTable<'_>) -> Result<WallShape, SceneError> {
    let plane = table.table("plane")?;
    let plane = table.need(plane, "plane", "give { point_m, normal }")?;
    let point = plane.need_vector("point_m")?;
    let normal = plane.need_vector("normal")?;
    if normal.norm() < SHORTEST_NORMAL {
        return Err(plane.bad("normal", "the normal has no direction; give it a length, as [0, 0, 1]"));
    }
    Ok(WallShape::Plane { point, normal: normal.normalize() })
}
