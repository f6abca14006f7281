//! Result files: columns, digits and structure.

use crate::common::Folder;
use amberfield_scene::{FieldColumns, FieldComponents, write_field_csv, write_vtu};
use nalgebra::Vector3;

#[test]
fn field_csv_has_the_columns_of_the_contract_and_all_digits() {
    let folder = Folder::good();
    let path = folder.file("field.csv");
    let e = [Vector3::new(1.0 / 3.0, -2e-300, 0.0), Vector3::new(f64::MIN_POSITIVE, 1e300, 0.1)];
    let parts = FieldComponents { near: &e, middle: &e, far: &e, correction: &e, faces: &e, external: &e };
    let columns = FieldColumns { id: &[9, 3], e: &e, potential: &[0.1, -0.7], components: None };
    write_field_csv(&path, &columns).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next().unwrap(), "id,ex_V_per_m,ey_V_per_m,ez_V_per_m,potential_V");
    let row: Vec<f64> = lines.next().unwrap().split(',').map(|cell| cell.parse().unwrap()).collect();
    assert_eq!(row, [9.0, 1.0 / 3.0, -2e-300, 0.0, 0.1]);
    write_field_csv(&path, &FieldColumns { components: Some(parts), ..columns }).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    assert_eq!((header.len(), header[5], header[16]), (23, "near_ex_V_per_m", "correction_ez_V_per_m"));
    assert_eq!((header[17], header[22]), ("faces_ex_V_per_m", "external_ez_V_per_m"));
    assert!(text.lines().all(|line| line.split(',').count() == 23));
}

#[test]
fn appended_arrays_lie_where_the_header_says() {
    let folder = Folder::good();
    let grains = folder.read(&[]).unwrap().particles;
    let path = folder.file("a.vtu");
    let e = vec![Vector3::new(1.0, 2.0, 3.0); grains.len()];
    write_vtu(&path, &grains, &[("electric_force_N", &e)]).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let start = bytes.windows(2).position(|pair| pair == b"\n_").unwrap() + 2;
    let header = String::from_utf8(bytes[..start].to_vec()).unwrap();
    for (name, length) in [("charge_C", 24), ("electric_force_N", 72), ("types", 3)] {
        let line = header.lines().find(|line| line.contains(&format!("Name=\"{name}\""))).unwrap();
        let offset: usize =
            line.split("offset=\"").nth(1).unwrap().split('"').next().unwrap().parse().unwrap();
        let at = start + offset;
        assert_eq!(u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()), length, "{name}");
    }
    let left_over = std::fs::read_dir(folder.path())
        .unwrap()
        .filter(|entry| entry.as_ref().unwrap().file_name().to_string_lossy().ends_with(".part"));
    assert_eq!(left_over.count(), 0);
}

#[test]
#[cfg(unix)]
fn a_device_is_never_replaced() {
    use std::os::unix::fs::FileTypeExt as _;
    let folder = Folder::good();
    let socket = folder.file("socket");
    let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
    let refused = amberfield_scene::write_text(&socket, "text").unwrap_err().to_string();
    assert!(refused.contains("name a file"), "{refused}");
    assert!(std::fs::metadata(&socket).unwrap().file_type().is_socket());
    assert!(amberfield_scene::write_text("/dev/null".as_ref(), "text").is_err());
}
