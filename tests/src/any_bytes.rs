//! Readers that must answer any bytes with a result and never panic.
//!
//! The fuzzer (`cargo xtask fuzz`) uses them, and a test that sends its corpora, and changes of them,
//! through.

use amberfield_core::{Boundary, Domain, Vector3};
use amberfield_coupling::{GrainsInCells, MeshArrays, MeshPart, Question, assemble};
use amberfield_field::far::{FarMesh, FarMeshParts};
use amberfield_scene::{
    Physics, Purpose, SavedGrains, Snapshot, SnapshotOptions, Units, read_checkpoint, read_scene,
    write_checkpoint, write_snapshot,
};
use amberfield_wire::payloads::{
    BoundaryFace, FarAnswer, FarQuestion, FlowAnswer, FlowQuestion, MeshOutline,
};
use amberfield_wire::{Block64, Header, Section, SectionEntry, Sections};
use std::path::PathBuf;
use std::sync::OnceLock;

/// Function that reads bytes.
pub type Reader = fn(&[u8]);

/// Readers with their names.
pub const TARGETS: [(&str, Reader); 8] = [
    ("scene", scene),
    ("grains", grains),
    ("surface", surface),
    ("checkpoint", checkpoint),
    ("message", message),
    ("mesh", mesh),
    ("dump", snapshot),
    ("vtk", snapshot),
];

/// Good scene with every kind of section.
const SCENE: &str = include_str!("../fuzz/good/scene.toml");
/// Good particles file of the scene.
const GRAINS: &str = include_str!("../fuzz/good/grains.csv");
/// Good surface of the scene.
const SURFACE: &str = include_str!("../fuzz/good/surface.stl");
/// Fingerprint with which checkpoints are read.
/// Sections of messages.
const SECTIONS: [Section; 35] = [
    Section::Text,
    Section::Positions,
    Section::Charges,
    Section::ImagePositions,
    Section::ImageCharges,
    Section::Boundary,
    Section::FarQuestion,
    Section::Potential,
    Section::Field,
    Section::Cells,
    Section::FarAnswer,
    Section::Centres,
    Section::Volumes,
    Section::FirstFace,
    Section::FaceNormals,
    Section::FaceOffsets,
    Section::FaceNeighbours,
    Section::FaceShifts,
    Section::BoundaryFaces,
    Section::Guess,
    Section::MeshOutline,
    Section::FlowQuestion,
    Section::VoidFraction,
    Section::DragCoefficient,
    Section::MomentumSource,
    Section::Velocity,
    Section::PressureGradient,
    Section::ViscousForce,
    Section::Vorticity,
    Section::FlowAnswer,
    Section::FlowState,
    Section::FlowStateSizes,
    Section::FirstCorner,
    Section::Corners,
    Section::Patches,
];

/// Reads a good scene in which the bytes replace one file.
fn read_with(name: &str, bytes: &[u8]) {
    static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| tempfile::tempdir().expect("a folder"));
    // Each thread of a test has a folder of its own.
    let own: PathBuf = folder.path().join(format!("{:?}", std::thread::current().id()));
    std::fs::create_dir_all(&own).expect("a folder");
    for (good, text) in [("scene.toml", SCENE), ("grains.csv", GRAINS), ("surface.stl", SURFACE)] {
        let content = if good == name { bytes } else { text.as_bytes() };
        std::fs::write(own.join(good), content).expect("a file");
    }
    let scene = read_scene(&own.join("scene.toml"), &[], Purpose::Explain);
    if let Ok(scene) = scene {
        let finite = scene.particles.position.iter().flatten().all(|number| number.is_finite());
        assert!(finite, "positions are finite");
    }
}

/// Reads the bytes as a scene file.
fn scene(bytes: &[u8]) {
    // Fills of millions of grains are no mistake, but take long.
    if !bytes.windows(8).any(|word| word == b"generate") {
        read_with("scene.toml", bytes);
    }
}

/// Reads the bytes as a CSV file of particles.
fn grains(bytes: &[u8]) {
    read_with("grains.csv", bytes);
}

/// Reads the bytes as a file of grains of any program; what was read comes back when it is written.
fn snapshot(bytes: &[u8]) {
    static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| tempfile::tempdir().expect("a folder"));
    let thread = format!("{:?}", std::thread::current().id());
    let path = folder.path().join(&thread);
    std::fs::write(&path, bytes).expect("a file");
    for units in [None, Some(Units::Cgs)] {
        let options = SnapshotOptions { units, ..SnapshotOptions::default() };
        let Ok(read) = Snapshot::read(&path, &options) else { continue };
        assert!(read.positions_m().iter().flatten().all(|number| number.is_finite()), "places are finite");
        if read.radii_m().is_some() {
            let table = folder.path().join(thread.clone() + ".csv");
            write_snapshot(&table, &read, Units::Si).expect("a table");
            let again = Snapshot::read(&table, &SnapshotOptions::default()).expect("our own table");
            assert_eq!((again.ids(), again.positions_m()), (read.ids(), read.positions_m()));
            assert_eq!((again.radii_m(), again.charges_c()), (read.radii_m(), read.charges_c()));
        }
    }
}

/// Reads the bytes as an STL file.
fn surface(bytes: &[u8]) {
    read_with("surface.stl", bytes);
}

/// Reads the bytes as a checkpoint, and as the state behind a header that fits them.
fn checkpoint(bytes: &[u8]) {
    type State = (u64, Vec<f64>, String, Option<[f64; 3]>);
    static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| tempfile::tempdir().expect("a folder"));
    let path = folder.path().join(format!("{:?}.amber", std::thread::current().id()));
    std::fs::write(&path, bytes).expect("a file");
    let _answer = read_checkpoint::<State>(&path, &Physics::default());
    write_checkpoint(&path, &Physics::default(), &SavedGrains::default(), &Raw(bytes)).expect("a file");
    let _answer = read_checkpoint::<State>(&path, &Physics::default());
}

/// Bytes that are encoded as themselves.
struct Raw<'a>(&'a [u8]);

impl serde::Serialize for Raw<'_> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeTuple as _;
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        self.0.iter().try_for_each(|byte| tuple.serialize_element(byte))?;
        tuple.end()
    }
}

/// Reads the bytes as the header and the payload of a message.
fn message(bytes: &[u8]) {
    let mut bytes = bytes.iter().copied();
    let mut number = |size: usize| {
        (0..size).fold(0_u64, |number, place| number | u64::from(bytes.next().unwrap_or(0)) << (8 * place))
    };
    let mut header = Header {
        version: number(4) as u32,
        kind: number(1) as u32,
        run: number(1),
        solve: number(1),
        rank: number(1) as u32,
        ranks: number(1) as u32,
        section_count: number(1),
        ..Header::default()
    };
    let used = (header.section_count as usize).min(header.sections.len());
    for entry in &mut header.sections[..used] {
        *entry = SectionEntry {
            section: number(1) as u32,
            element: number(1) as u32,
            count: number(8),
            first_block: number(8),
        };
    }
    let payload: Vec<u8> = bytes.collect();
    let payload: Vec<Block64> = payload.chunks(64).map(block).collect();
    let sections = Sections::new(&header, &payload);
    let _answer = header.check(0);
    for section in SECTIONS {
        let _lengths = (
            sections.get::<u8>(section).map(<[u8]>::len),
            sections.get::<u64>(section).map(|numbers| numbers.iter().fold(0, |sum, number| sum ^ number)),
            sections.get::<i64>(section).map(<[i64]>::len),
            sections.get::<f64>(section).map(|numbers| numbers.iter().sum::<f64>()),
            sections.get::<[f64; 3]>(section).map(<[[f64; 3]]>::len),
            sections.get::<BoundaryFace>(section).map(<[BoundaryFace]>::len),
            sections.get::<MeshOutline>(section).map(<[MeshOutline]>::len),
            sections.get::<FarQuestion>(section).map(<[FarQuestion]>::len),
            sections.get::<FarAnswer>(section).map(<[FarAnswer]>::len),
            sections.get::<FlowQuestion>(section).map(<[FlowQuestion]>::len),
            sections.get::<FlowAnswer>(section).map(<[FlowAnswer]>::len),
        );
    }
    let _answer = (sections.text(), Question::read(&header, &sections).is_ok());
    let _answer = GrainsInCells::read(&sections, 1..3).is_ok();
    if let Ok(part) = MeshPart::read(&sections) {
        let _answer = assemble(&[part]);
    }
}

/// Block of at most 64 bytes, little endian.
fn block(bytes: &[u8]) -> Block64 {
    let mut words = [0_u64; 8];
    for (place, byte) in bytes.iter().enumerate() {
        words[place / 8] |= u64::from(*byte) << (8 * (place % 8));
    }
    Block64 { words }
}

/// Reads a mesh of a few cells in which the bytes change numbers: each eleven bytes say which, and into what.
fn mesh(bytes: &[u8]) {
    static GOOD: OnceLock<(FarMesh, MeshArrays)> = OnceLock::new();
    let (good, arrays) = GOOD.get_or_init(|| {
        let faces = [
            [Boundary::Grounded; 2],
            [Boundary::Periodic; 2],
            [Boundary::Insulating { normal_field_v_m: 0.0 }; 2],
        ];
        let domain =
            Domain::new(Vector3::zeros(), Vector3::new(3.0, 2.0, 2.0), faces).expect("a sound domain");
        let mesh = FarMeshParts::of_box(&domain, [3, 2, 2]).and_then(FarMesh::new).expect("a sound mesh");
        let arrays = MeshArrays::of(&mesh);
        (mesh, arrays)
    });
    let part = arrays.part(good);
    let mut centres = part.centres.to_vec();
    let mut volumes = part.volumes.to_vec();
    let mut first_face = part.first_face.to_vec();
    let mut normals = part.face_normals.to_vec();
    let mut neighbours = part.face_neighbours.to_vec();
    let mut shifts = part.face_shifts.to_vec();
    let mut boundary = part.boundary_faces.to_vec();
    let mut first_corner = part.first_corner.to_vec();
    let mut corners = part.corners.to_vec();
    let mut patches = part.patches.to_vec();
    let mut outline = part.outline;
    for change in bytes.chunks_exact(11) {
        let place = usize::from(change[1]) | usize::from(change[2]) << 8;
        let word = u64::from_le_bytes(change[3..].try_into().expect("eight bytes"));
        let number = f64::from_bits(word);
        match change[0] % 13 {
            0 if place % 2 == 0 => outline.low_m[(place >> 1) % 3] = number,
            0 => outline.high_m[(place >> 1) % 3] = number,
            1 => outline.first_cell = word,
            2 => outline.all_cells = word,
            3 => set(&mut volumes, place, number),
            4 => set(&mut first_face, place, word),
            5 => set(&mut neighbours, place, word as i64),
            6 => set_in(&mut centres, place, number),
            7 => set_in(&mut normals, place, number),
            8 => set_in(&mut shifts, place, number),
            9 => set_in_face(&mut boundary, place, word),
            10 => set(&mut first_corner, place, word),
            11 => set_in(&mut corners, place, number),
            _ => set(&mut patches, place, word as u8),
        }
    }
    let changed = MeshPart {
        outline,
        centres: &centres,
        volumes: &volumes,
        first_face: &first_face,
        face_normals: &normals,
        face_neighbours: &neighbours,
        face_shifts: &shifts,
        boundary_faces: &boundary,
        first_corner: &first_corner,
        corners: &corners,
        patches: &patches,
        ..part
    };
    if let Ok(mesh) = assemble(&[changed]) {
        for place in [Vector3::new(0.1, 0.2, 0.3), Vector3::new(2.9, 1.9, 1.9)] {
            let (cell, _) = mesh.locate(&place, None);
            assert!((cell as usize) < mesh.cell_count());
        }
        let faces = 0..mesh.boundary().len();
        assert!(faces.into_iter().all(|face| mesh.corners_of(face).len() >= 3));
    }
}

/// Sets a number of a list; the place is taken modulo the length.
fn set<T>(numbers: &mut [T], place: usize, number: T) {
    let count = numbers.len();
    numbers[place % count] = number;
}

/// Sets a number in a list of vectors; the place is taken modulo the length.
fn set_in<const N: usize>(vectors: &mut [[f64; N]], place: usize, number: f64) {
    let count = vectors.len() * N;
    vectors[place % count / N][place % N] = number;
}

/// Sets one of the seventeen numbers of a face, in the order of its fields.
fn set_in_face(faces: &mut [BoundaryFace], place: usize, word: u64) {
    let count = 17 * faces.len();
    let (face, number) = (&mut faces[place % count / 17], f64::from_bits(word));
    match place % 17 {
        axis @ 0..3 => face.centre_m[axis] = number,
        axis @ 3..6 => face.normal[axis - 3] = number,
        6 => face.area_m2 = number,
        7 => face.cell = word,
        8 => face.patch = word,
        9 => face.is_conductor = word,
        10 => face.prescribed = number,
        11 => face.spread_xx_m2 = number,
        12 => face.spread_xy_m2 = number,
        13 => face.spread_xz_m2 = number,
        14 => face.spread_yy_m2 = number,
        15 => face.spread_yz_m2 = number,
        _ => face.spread_zz_m2 = number,
    }
}
