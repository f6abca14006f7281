use super::*;

/// Header of a file of the mesh.
fn head(class: &str, format: &str) -> String {
    format!(
        "/* a banner */\nFoamFile\n{{\n    version 2.0;\n    format {format};\n    class {class};\n    \
         arch \"LSB;label=32;scalar=64\"; // of this machine\n    object x;\n}}\n\n"
    )
}

/// Points of a mesh of two unit cubes side by side, whose common face is a baffle.
const POINTS: [[f64; 3]; 12] = [
    [0., 0., 0.],
    [1., 0., 0.],
    [2., 0., 0.],
    [0., 1., 0.],
    [1., 1., 0.],
    [2., 1., 0.],
    [0., 0., 1.],
    [1., 0., 1.],
    [2., 0., 1.],
    [0., 1., 1.],
    [1., 1., 1.],
    [2., 1., 1.],
];
/// Faces of the mesh: the floor's two, the baffle's two sides, and a triangle.
const FACES: [&[u32]; 5] = [&[0, 3, 4, 1], &[1, 4, 5, 2], &[1, 4, 10, 7], &[1, 7, 10, 4], &[6, 7, 9]];
const BOUNDARY: &str = "4\n(\n\
    floor\n{\n    type wall;\n    inGroups 1(wall);\n    nFaces 2;\n    startFace 0;\n}\n\
    plate { type patch; nFaces 2; startFace 2; }\n\
    lid { type wall; sampling { mode none; } nFaces 1; startFace 4; }\n\
    ends { type cyclicAMI; nFaces 0; startFace 5; }\n)\n";

/// Case with a mesh in a format; the folder is removed at the end.
fn case(format: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let mesh = folder.path().join(FOLDER);
    std::fs::create_dir_all(&mesh).expect("a folder");
    let mut points = head("vectorField", format).into_bytes();
    let mut faces;
    if format == "binary" {
        let list =
            |count: usize, bytes: Vec<u8>| [format!("\n{count}\n(").as_bytes(), &bytes[..], b")\n"].concat();
        points.extend(list(12, POINTS.iter().flatten().flat_map(|x| x.to_le_bytes()).collect()));
        let first = [0_u32, 4, 8, 12, 16, 19];
        faces = head("faceCompactList", format).into_bytes();
        faces.extend(list(6, first.iter().flat_map(|first| first.to_le_bytes()).collect()));
        faces.extend(list(19, FACES.concat().iter().flat_map(|label| label.to_le_bytes()).collect()));
    } else {
        let text = |[x, y, z]: &[f64; 3]| format!("({x} {y} {z})\n");
        points.extend(format!("12\n(\n{})\n", POINTS.iter().map(text).collect::<String>()).into_bytes());
        let text = |face: &&[u32]| {
            let labels: Vec<String> = face.iter().map(ToString::to_string).collect();
            format!("{}({})\n", face.len(), labels.join(" "))
        };
        let list = format!("5\n(\n{})\n", FACES.iter().map(text).collect::<String>());
        faces = (head("faceList", format) + &list).into_bytes();
    }
    std::fs::write(mesh.join("points"), points).expect("a file");
    std::fs::write(mesh.join("faces"), faces).expect("a file");
    let boundary = head("polyBoundaryMesh", format) + BOUNDARY;
    std::fs::write(mesh.join("boundary"), boundary).expect("a file");
    folder
}

/// Surface of a patch.
fn surface(case: &Path, patch: &str) -> Result<TriangleMesh, String> {
    PolyMesh::of(case, None).surface(patch).map_err(|error| match error {
        PatchError::Patch(problem) => problem,
        PatchError::Mesh(error) => error.to_string(),
    })
}

/// Area of each triangle as a vector.
fn areas(mesh: &TriangleMesh) -> Vec<Vector3<f64>> {
    let area = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| mesh.vertices[vertex as usize]);
        (b - a).cross(&(c - a)) / 2.0
    };
    mesh.triangles.iter().map(area).collect()
}

#[test]
fn faces_are_cut_into_triangles_that_turn_inwards() {
    let text = case("ascii");
    let floor = surface(text.path(), "floor").expect("a good mesh");
    assert_eq!((floor.vertices.len(), floor.triangles.len()), (8, 8));
    for area in areas(&floor) {
        assert!((area - Vector3::z() / 4.0).norm() < 1e-15, "{area:?}");
    }
    let lid = surface(text.path(), "lid").expect("a good mesh");
    assert_eq!(lid.triangles.len(), 1);
    assert!((areas(&lid)[0] + Vector3::z() / 2.0).norm() < 1e-15);
    let plate = surface(text.path(), "plate").expect("a good mesh");
    let across: Vec<f64> = areas(&plate).iter().map(|area| area.x).collect();
    assert_eq!(across, [-0.25, -0.25, -0.25, -0.25, 0.25, 0.25, 0.25, 0.25]);
}

#[test]
fn text_binary_and_compressed_files_say_the_same() {
    let [text, binary, packed] = ["ascii", "binary", "binary"].map(case);
    for name in ["points", "faces", "boundary"] {
        let file = packed.path().join(FOLDER).join(name);
        let bytes = std::fs::read(&file).expect("a file");
        std::fs::remove_file(&file).expect("a file");
        let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        std::io::Write::write_all(&mut packer, &bytes).expect("memory");
        std::fs::write(file.with_extension("gz"), packer.finish().expect("memory")).expect("a file");
    }
    for patch in ["floor", "plate", "lid"] {
        let expected = surface(text.path(), patch).expect("a good mesh");
        for case in [&binary, &packed] {
            assert_eq!(surface(case.path(), patch).as_ref(), Ok(&expected), "{patch}");
        }
    }
}

#[test]
fn the_centre_of_a_polygon_is_that_of_its_area_also_where_it_is_concave() {
    let polygon = |corners: &[[f64; 2]]| -> Vec<Vector3<f64>> {
        corners.iter().map(|[x, y]| Vector3::new(5.0 + x, y - 3.0, 2.0)).collect()
    };
    // A unit square with points more on one edge, and an L of three unit squares.
    let square = polygon(&[[0., 0.], [0.1, 0.], [0.2, 0.], [1., 0.], [1., 1.], [0., 1.]]);
    assert!((centre(&square) - Vector3::new(5.5, -2.5, 2.0)).norm() < 1e-15);
    let l_shape = polygon(&[[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]]);
    let expected = Vector3::new(5.0 + 5.0 / 6.0, -3.0 + 5.0 / 6.0, 2.0);
    assert!((centre(&l_shape) - expected).norm() < 1e-14);
}

#[test]
fn patches_that_are_no_surface_are_refused_with_those_that_are_there() {
    let text = case("ascii");
    let said = surface(text.path(), "flor").expect_err("no such patch");
    assert!(said.contains("no such patch; it has floor, plate, lid, ends; the nearest is floor"), "{said}");
    assert!(said.contains(&text.path().display().to_string()), "{said}");
    let said = surface(text.path(), "ends").expect_err("no surface");
    assert!(said.contains("of the type cyclicAMI"), "{said}");
    let nowhere = tempfile::tempdir().expect("a folder");
    let said = surface(nowhere.path(), "floor").expect_err("no mesh");
    assert!(said.contains("no constant/polyMesh yet"), "{said}");
    let mut mesh = PolyMesh::of(nowhere.path(), None);
    assert!(mesh.check("floor").is_ok(), "its mesh may come");
}

#[test]
fn damaged_files_are_refused_and_nothing_panics() {
    for format in ["ascii", "binary"] {
        let folder = case(format);
        let read = |name: &str, bytes: &[u8]| match (name, FoamFile::open(name, bytes)) {
            ("points", Ok(mut file)) => file.points().map(drop),
            ("faces", Ok(mut file)) => file.faces().map(drop),
            (_, opened) => opened.and_then(|mut file| patches_of(&mut file)).map(drop),
        };
        for name in ["points", "faces", "boundary"] {
            let good = std::fs::read(folder.path().join(FOLDER).join(name)).expect("a file");
            assert_eq!(read(name, &good), Ok(()));
            let last = good.iter().rposition(|byte| !byte.is_ascii_whitespace()).expect("not empty");
            for place in 0..=last {
                assert!(read(name, &good[..place]).is_err(), "{format} {name} {place}");
                for byte in [b'9', b')', b';', 0xff] {
                    let mut changed = good.clone();
                    changed[place] = byte;
                    let _any = read(name, &changed);
                }
            }
        }
    }
}

#[test]
fn what_does_not_fit_together_is_refused() {
    for (name, from, to, word) in [
        ("boundary", "nFaces 2;\n", "nFaces 9;\n", "patch floor reaches to face 9, and there are 5"),
        ("boundary", "4\n(", "7\n(", "4 patches stand where 7 should"),
        ("boundary", "startFace 2", "start 2", "patch plate has no startFace"),
        ("faces", "4(0 3 4 1)", "4(0 3 44 1)", "a face has point 44 of 12"),
        ("points", "(2 0 0)", "(2 nan 0)", "point 2 is at [2.0, NaN, 0.0] m"),
        ("points", "(2 0 0)", "(2 0)", "a word or a number is missing"),
        ("points", "format ascii", "format xml", "the format xml is not known"),
    ] {
        let folder = case("ascii");
        let file = folder.path().join(FOLDER).join(name);
        let good = std::fs::read_to_string(&file).expect("a file");
        assert!(good.contains(from), "{from}");
        std::fs::write(&file, good.replacen(from, to, 1)).expect("a file");
        let said = surface(folder.path(), "floor").expect_err("a damaged mesh");
        assert!(said.contains(word), "{said}");
    }
}
