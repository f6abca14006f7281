//! Patches of an OpenFOAM case as surfaces: the files in `constant/polyMesh`, compressed or not.

mod foam_file;

use crate::SceneError;
use crate::source::read_bytes;
use crate::tree::nearest;
use amberfield_core::TriangleMesh;
use foam_file::{Faces, FoamFile};
use nalgebra::Vector3;
use std::collections::HashMap;
use std::io::Read as _;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Folder of the mesh in a case.
const FOLDER: &str = "constant/polyMesh";
/// Ending of a compressed file.
const COMPRESSED: &str = ".gz";
/// Beginnings of the types of patches at which space does not end.
const NO_SURFACE: [&str; 4] = ["cyclic", "processor", "empty", "wedge"];

/// Patch of a mesh.
#[derive(Debug)]
struct Patch {
    name: String,
    /// Type: `wall`, `patch`, `cyclic` and so on.
    kind: String,
    /// Faces among all of the mesh.
    faces: Range<usize>,
}

/// Points and faces of a mesh.
#[derive(Debug)]
struct Geometry {
    points: Vec<Vector3<f64>>,
    faces: Faces,
}

/// Mesh of a case; what is not asked for is not read.
#[derive(Debug)]
pub(crate) struct PolyMesh {
    /// Folder of the case, for messages.
    case: PathBuf,
    /// Folder in which the mesh is.
    place: PathBuf,
    patches: Option<Vec<Patch>>,
    geometry: Option<Geometry>,
}

/// Reason why a patch is no wall.
pub(crate) enum PatchError {
    /// The patch is not there or has no surface.
    Patch(String),
    /// The mesh cannot be read.
    Mesh(SceneError),
}

impl From<SceneError> for PatchError {
    fn from(error: SceneError) -> Self {
        Self::Mesh(error)
    }
}

impl PolyMesh {
    /// The mesh of a case; one that has none has that in another folder.
    pub(crate) fn of(case: &Path, other: Option<&Path>) -> Self {
        let has_one =
            ["", COMPRESSED].iter().any(|end| case.join(FOLDER).join(format!("points{end}")).exists());
        let place = other.filter(|_| !has_one).unwrap_or(case);
        Self { case: case.to_path_buf(), place: place.to_path_buf(), patches: None, geometry: None }
    }

    /// Refuses the name of a patch that the mesh does not have. A mesh that is not there yet has any.
    pub(crate) fn check(&mut self, name: &str) -> Result<(), PatchError> {
        match self.find(name) {
            Err(PatchError::Mesh(SceneError::NoMesh { .. })) => Ok(()),
            found => found.map(drop),
        }
    }

    /// Faces of a patch, cut into triangles that turn their front to the inside of the mesh.
    ///
    /// A face with more than three corners is cut into a fan around its centre. Unlike a cut along diagonals
    /// this leaves no choice, and what the wall does to a grain cannot depend on one.
    pub(crate) fn surface(&mut self, name: &str) -> Result<TriangleMesh, PatchError> {
        let faces = self.find(name)?;
        let geometry = match self.geometry.take() {
            Some(known) => known,
            None => self.read_geometry()?,
        };
        let surface = cut(&geometry, faces);
        self.geometry = Some(geometry);
        Ok(surface)
    }

    /// Faces of a patch with a surface.
    fn find(&mut self, name: &str) -> Result<Range<usize>, PatchError> {
        let patches = match self.patches.take() {
            Some(known) => known,
            None => self.read_patches()?,
        };
        let found = self.faces_of(&patches, name);
        self.patches = Some(patches);
        found.map_err(PatchError::Patch)
    }

    fn faces_of(&self, patches: &[Patch], name: &str) -> Result<Range<usize>, String> {
        let case = self.case.display();
        let Some(patch) = patches.iter().find(|patch| patch.name == name) else {
            let names: Vec<&str> = patches.iter().map(|patch| patch.name.as_str()).collect();
            let advice =
                nearest(name, &names).map_or_else(String::new, |near| format!("; the nearest is {near}"));
            return Err(format!(
                "the mesh of the case {case} has no such patch; it has {}{advice}",
                names.join(", ")
            ));
        };
        if NO_SURFACE.iter().any(|kind| patch.kind.starts_with(kind)) {
            return Err(format!(
                "in the mesh of the case {case} this patch is of the type {}, at which space does not end; \
                 name another patch",
                patch.kind
            ));
        }
        if patch.faces.is_empty() {
            return Err(format!(
                "in the mesh of the case {case} this patch has no faces; name another patch"
            ));
        }
        Ok(patch.faces.clone())
    }

    /// Reads `boundary`.
    fn read_patches(&self) -> Result<Vec<Patch>, SceneError> {
        let Content { name, bytes } = self.read("boundary")?;
        patches_of(&mut FoamFile::open(&name, &bytes)?)
    }

    /// Reads `points` and `faces`.
    fn read_geometry(&self) -> Result<Geometry, SceneError> {
        let Content { name, bytes } = self.read("points")?;
        let points = FoamFile::open(&name, &bytes)?.points()?;
        let Content { name, bytes } = self.read("faces")?;
        let mut file = FoamFile::open(&name, &bytes)?;
        let faces = file.faces()?;
        if let Some(label) = faces.corners.iter().find(|label| **label as usize >= points.len()) {
            return Err(file.bad(format!("a face has point {label} of {}", points.len())));
        }
        let count = faces.first.len() - 1;
        let patches = self.patches.iter().flatten();
        if let Some(patch) = patches.into_iter().find(|patch| patch.faces.end > count) {
            return Err(file.bad(format!(
                "patch {} reaches to face {}, and there are {count}",
                patch.name, patch.faces.end
            )));
        }
        Ok(Geometry { points, faces })
    }

    /// Reads a file of the mesh.
    fn read(&self, file: &str) -> Result<Content, SceneError> {
        let path = self.place.join(FOLDER).join(file);
        let packed = self.place.join(FOLDER).join(format!("{file}{COMPRESSED}"));
        if !path.exists() && !packed.exists() {
            return Err(SceneError::NoMesh { case: self.case.clone() });
        }
        let is_packed = !path.exists();
        let path = if is_packed { packed } else { path };
        let name = path.display().to_string();
        let unreadable = |reason: String| SceneError::Unreadable { file: name.clone(), reason };
        let mut bytes = read_bytes(&path).map_err(unreadable)?;
        if is_packed {
            let mut unpacked = Vec::new();
            let read = flate2::read::MultiGzDecoder::new(&bytes[..]).read_to_end(&mut unpacked);
            read.map_err(|error| unreadable(format!("it cannot be unpacked: {error}; write it again")))?;
            bytes = unpacked;
        }
        Ok(Content { name, bytes })
    }
}

/// Reads the patches of the file `boundary`, which is text whatever its header says.
fn patches_of(file: &mut FoamFile<'_>) -> Result<Vec<Patch>, SceneError> {
    let mut patches = Vec::new();
    let count = file.count()?;
    file.expect(b'(')?;
    while !file.comes(b')') {
        let name = file.word()?.to_owned();
        file.expect(b'{')?;
        let (mut kind, mut start, mut faces) = (String::new(), None, None);
        while !file.comes(b'}') {
            let (key, value) = (file.word()?, file.value()?);
            match key {
                "type" => kind = value.to_owned(),
                "startFace" => start = value.parse::<u32>().ok(),
                "nFaces" => faces = value.parse::<u32>().ok(),
                _ => {}
            }
        }
        file.expect(b'}')?;
        let (Some(start), Some(faces)) = (start, faces) else {
            return Err(file.bad(format!("patch {name} has no startFace or no nFaces")));
        };
        let faces = start as usize..start as usize + faces as usize;
        patches.push(Patch { name, kind, faces });
    }
    if patches.len() != count {
        return Err(file.bad(format!("{} patches stand where {count} should", patches.len())));
    }
    Ok(patches)
}

/// Content of a file.
struct Content {
    /// Name for messages.
    name: String,
    /// Bytes, unpacked.
    bytes: Vec<u8>,
}

/// Cuts faces into triangles.
fn cut(geometry: &Geometry, range: Range<usize>) -> TriangleMesh {
    let Geometry { points, faces } = geometry;
    let mut surface = TriangleMesh::default();
    let mut index_of: HashMap<u32, u32> = HashMap::new();
    for face in range {
        let labels = &faces.corners[faces.first[face] as usize..faces.first[face + 1] as usize];
        let corners: Vec<u32> = labels
            .iter()
            .map(|&label| {
                *index_of.entry(label).or_insert_with(|| {
                    surface.vertices.push(points[label as usize]);
                    surface.vertices.len() as u32 - 1
                })
            })
            .collect();
        // A mesh's faces turn their front to the outside; grains are inside.
        if let [a, b, c] = corners[..] {
            surface.triangles.push([a, c, b]);
        } else if corners.len() > 3 {
            let around: Vec<Vector3<f64>> = corners.iter().map(|&k| surface.vertices[k as usize]).collect();
            let middle = surface.vertices.len() as u32;
            surface.vertices.push(centre(&around));
            let next = corners.iter().cycle().skip(1);
            surface.triangles.extend(corners.iter().zip(next).map(|(&a, &b)| [b, a, middle]));
        }
    }
    surface
}

/// Centre of area of a polygon, whose corners need not lie in one plane [m].
fn centre(corners: &[Vector3<f64>]) -> Vector3<f64> {
    let mean = corners.iter().sum::<Vector3<f64>>() / corners.len() as f64;
    let edges = || corners.iter().zip(corners.iter().cycle().skip(1));
    let across = |a: &Vector3<f64>, b: &Vector3<f64>| (a - mean).cross(&(b - mean));
    let normal: Vector3<f64> = edges().map(|(a, b)| across(a, b)).sum();
    let mut moment = Vector3::zeros();
    for (a, b) in edges() {
        // Of a concave polygon some triangles count as negative.
        moment += (a + b - 2.0 * mean) / 3.0 * across(a, b).dot(&normal);
    }
    let area = normal.norm_squared();
    if area > 0.0 { mean + moment / area } else { mean }
}

#[cfg(test)]
mod tests;
