//! Case of the image force of a grounded plane.

use crate::support::{COULOMB, Case};
use amberfield_core::Vector3;
use amberfield_oracle::{ErrorNorms, GroundedPlane, field_scale};

const CHARGE_C: f64 = 1e-12;
const VOLUME_M3: f64 = 1e-6;
/// Tolerance of the scene.
const TOLERANCE: f64 = 1e-3;
const HEADER: &str = "id,x_m,y_m,z_m,radius_m,charge_C\n";

#[test]
fn touching_grain_feels_its_image() {
    let field = Case::new("grounded-plane").field(&[]).column("ez_V_per_m")[0];
    assert!((field / -2.2469e5 - 1.0).abs() < TOLERANCE, "{field:e} V/m");
}

#[test]
fn force_falls_with_the_square_of_the_height() {
    for height in [1e-4, 3e-4, 1e-3, 4e-3] {
        let case = Case::new("grounded-plane");
        case.write("grain.csv", &format!("{HEADER}1,0.0003,-0.0002,{height},1e-4,1e-12\n"));
        let field = case.field(&[]).field()[0];
        let exact = GroundedPlane { coulomb_constant: COULOMB, charge: CHARGE_C, height }.self_field();
        // The tolerance's scale: the larger of |E| and q n^{2/3}/(4πε).
        let scale = field_scale(&[Vector3::z() * exact], &[CHARGE_C], VOLUME_M3, COULOMB);
        assert!(
            (field - Vector3::z() * exact).norm() < TOLERANCE * scale,
            "at {height} m: {field:?}, exact {exact:e}"
        );
    }
}

#[test]
fn a_row_of_grains_feels_all_images() {
    let grains: Vec<(Vector3<f64>, f64)> = (0..12)
        .map(|index| {
            let part = f64::from(index);
            let place = Vector3::new(-4e-3 + 7e-4 * part, 3e-3 * (1.3 * part).sin(), 1e-4 * (1.0 + part));
            (place, if index % 3 == 0 { -CHARGE_C } else { CHARGE_C })
        })
        .collect();
    let mut rows = HEADER.to_owned();
    for (id, (place, charge)) in grains.iter().enumerate() {
        rows.push_str(&format!("{id},{},{},{},1e-4,{charge}\n", place.x, place.y, place.z));
    }
    let case = Case::new("grounded-plane");
    case.write("grain.csv", &rows);
    let exact: Vec<Vector3<f64>> =
        grains.iter().enumerate().map(|(at, _)| exact_field(&grains, at)).collect();
    let charges: Vec<f64> = grains.iter().map(|(_, charge)| *charge).collect();
    let scale = field_scale(&exact, &charges, VOLUME_M3, COULOMB);
    let norms = ErrorNorms::new(&case.field(&[]).field(), &exact, scale);
    assert!(norms.relative_rms <= TOLERANCE, "{norms:?}");
}

/// Exact field [V/m] at a grain, with the images of all grains.
fn exact_field(grains: &[(Vector3<f64>, f64)], at: usize) -> Vector3<f64> {
    let mut field = Vector3::zeros();
    for (index, (place, charge)) in grains.iter().enumerate() {
        let plane = GroundedPlane { coulomb_constant: COULOMB, charge: *charge, height: place.z };
        if index == at {
            field.z += plane.self_field();
        } else {
            let offset = grains[at].0 - place;
            field += plane.field(Vector3::new(offset.x, offset.y, grains[at].0.z));
        }
    }
    field
}
