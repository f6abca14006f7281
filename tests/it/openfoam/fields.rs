//! Fields over OpenFOAM, compared with the internal grid and with more exact fields.

use super::{AGREEMENT, difference, good};
use amberfield_tests::FoamBox;

fn agrees_with_the_internal_grid(scene: &FoamBox) {
    good(&scene.field("one.csv", &[]));
    good(&scene.field("two.csv", &["--set", "solver.ranks=2"]));
    scene.alone();
    good(&scene.field("alone.csv", &[]));
    let (one, two, alone) = (scene.e("one.csv"), scene.e("two.csv"), scene.e("alone.csv"));
    assert!(difference(&one, &alone) < AGREEMENT, "{:e}", difference(&one, &alone));
    assert!(difference(&two, &one) < 1e-4, "one rank and two: {:e}", difference(&two, &one));
}

#[test]
fn grounded_box_agrees_with_the_internal_grid() {
    agrees_with_the_internal_grid(&FoamBox::grounded());
}

#[test]
fn mixed_box_agrees_with_the_internal_grid() {
    let (cyclic, wall) = (("cyclic", "type cyclic;"), "wall");
    let sides = [
        cyclic,
        cyclic,
        (wall, "type zeroGradient;"),
        (wall, "type fixedGradient; gradient uniform -2000;"),
        (wall, "type fixedValue; value uniform 0;"),
        (wall, "type fixedValue; value uniform 300;"),
    ];
    let faces = "x = 'periodic'\ny_min = 'insulating'\ny_max = { normal_field_V_m = 2000.0 }\n\
        z_min = 'grounded'\nz_max = { potential_V = 300.0 }";
    agrees_with_the_internal_grid(&FoamBox::new(&sides, faces, "bipolar = 1e-12"));
}

#[test]
fn periodic_box_agrees_and_refuses_a_net_charge() {
    let sides = [("cyclic", "type cyclic;"); 6];
    let faces = "x = 'periodic'\ny = 'periodic'\nz = 'periodic'";
    agrees_with_the_internal_grid(&FoamBox::new(&sides, faces, "bipolar = 1e-12"));
    let answer = FoamBox::new(&sides, faces, "constant = 1e-12").field("out.csv", &[]);
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    assert!(answer.stderr.contains("net charge"), "{}", answer.stderr);
}

/// Case of the published hybrid method on the same cells, with the same operator and the same gradient.
#[test]
fn kolehmainen_over_openfoam_is_that_of_the_internal_grid() {
    let scene = FoamBox::grounded();
    let radius = ["--method", "kolehmainen", "--set", "electric_field.field_cutoff_radius=2e-3"];
    good(
        &scene
            .field("coupled.csv", &[&radius[..], &["--set", "electric_field.far_tolerance=1e-10"]].concat()),
    );
    scene.alone();
    good(
        &scene.field(
            "alone.csv",
            &[&radius[..], &["--set", "electric_field.grid.cells=[12, 12, 10]"]].concat(),
        ),
    );
    let error = difference(&scene.e("coupled.csv"), &scene.e("alone.csv"));
    assert!(error < 1e-6, "{error:e}");
}

/// Case of 20 000 grains that fill three tenths of the volume, on cells of 2.9 diameters.
#[test]
fn coarse_mesh_errs_by_less_than_8_in_1000() {
    const MOST: f64 = 8e-3;
    let many = ["--set", "particles.generate.count=20000", "--set", "particles.generate.radius_m=1.727e-4"];
    let wall = ("wall", "type fixedValue; value uniform 0;");
    let faces = "x = 'grounded'\ny = 'grounded'\nz = 'grounded'";
    for charge in ["bipolar = 1e-12", "constant = 1e-12"] {
        let scene = FoamBox::new(&[wall; 6], faces, charge);
        good(&scene.field("coupled.csv", &[&many[..], &["--tolerance", "5e-3"]].concat()));
        scene.alone();
        good(&scene.field("exact.csv", &[&many[..], &["--tolerance", "1e-5"]].concat()));
        // The published hybrid method on as many cells of the internal grid.
        let hybrid = ["--method", "kolehmainen", "--set", "electric_field.field_cutoff_radius=1.8e-3"];
        let cells = ["--set", "electric_field.grid.cells=[12, 12, 10]"];
        good(&scene.field("hybrid.csv", &[&many[..], &hybrid, &cells].concat()));
        let exact = scene.e("exact.csv");
        let [error, hybrid] = ["coupled.csv", "hybrid.csv"].map(|name| difference(&scene.e(name), &exact));
        println!("{charge}: {error:.2e}, kolehmainen on the same cells {hybrid:.2e}");
        assert!(error < MOST, "{charge}: {error:e}");
    }
}

#[test]
fn far_tolerances_from_a_tenth_to_1e_12_all_end_and_agree() {
    let scene = FoamBox::grounded();
    let field = |tolerance: &str| {
        let set = format!("electric_field.far_tolerance={tolerance}");
        good(&scene.field("out.csv", &["--set", &set]));
        scene.e("out.csv")
    };
    let exact = field("1e-12");
    let mut before = f64::INFINITY;
    for tolerance in ["1e-1", "1e-3", "1e-6", "1e-9"] {
        let error = difference(&field(tolerance), &exact);
        let asked: f64 = tolerance.parse().unwrap();
        assert!(error <= before && error < asked, "{tolerance}: {error:e}");
        before = error;
    }
}
