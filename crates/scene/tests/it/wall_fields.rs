//! Key `field` of walls: its forms, and what it does not go with.

use crate::common::{Folder, SCENE};
use amberfield_core::{ConductorState, WallShape};
use amberfield_scene::Scene;

/// Reads the good scene with these values of keys below its STL wall.
fn read(values: &[&str]) -> Scene {
    Folder::good().read(values).unwrap_or_else(|error| panic!("{values:?}: {error}"))
}

fn conductors(scene: &Scene) -> Vec<(String, ConductorState)> {
    let field = &scene.electric_field.as_ref().unwrap().field;
    field.conductors.iter().map(|conductor| (conductor.name.clone(), conductor.state)).collect()
}

#[test]
fn every_form_makes_a_conductor() {
    for (value, state) in [
        ("\"grounded\"", ConductorState::Potential(0.0)),
        ("{ potential_V = -1000.0 }", ConductorState::Potential(-1000.0)),
        ("{ floating = { charge_C = 2e-12 } }", ConductorState::Charge(2e-12)),
    ] {
        let scene = read(&[&format!("walls.1.field={value}")]);
        assert_eq!(conductors(&scene), [("plate.stl".to_owned(), state)]);
        assert!(scene.walls[1].bounds_field && !scene.walls[0].bounds_field);
        assert!(scene.conductor(0).is_none(), "the plane bounds nothing");
        assert_eq!(scene.conductor(1).unwrap().state, state);
        let surface = &scene.conductor(1).unwrap().surface;
        assert!(surface.triangles.len() > 1, "the only triangle of the file is divided");
        assert!(!scene.warnings.iter().any(|warning| warning.contains("does not bound")), "{value}");
    }
}

#[test]
fn none_is_the_default_and_any_wall_may_say_it() {
    let plain = Folder::good().read(&[]).unwrap();
    for wall in ["walls.0", "walls.1"] {
        let scene = read(&[&format!("{wall}.field=none")]);
        assert_eq!((&scene.walls, &scene.warnings), (&plain.walls, &plain.warnings));
        assert!(conductors(&scene).is_empty() && scene.conductor(1).is_none());
    }
}

#[test]
fn a_changed_field_of_a_wall_is_a_change_of_the_physics() {
    let with = |value: &str| read(&[&format!("walls.1.field={value}")]);
    let grounded = with("grounded");
    for (value, told) in [
        ("none", "walls[1].field is \"none\""),
        ("{ potential_V = 5.0 }", "walls[1].field.potential_V is 5.0"),
        ("{ floating = { charge_C = 0.0 } }", "walls[1].field.floating.charge_C is 0.0"),
    ] {
        let changes = with(value).physics().changes_since(grounded.physics());
        assert!(changes.iter().any(|change| change.starts_with(told)), "{value}: {changes:?}");
    }
    let volts = |number: &str| with(&format!("{{ potential_V = {number} }}"));
    let changes = volts("6.0").physics().changes_since(volts("5.0").physics());
    assert_eq!(changes, ["walls[1].field.potential_V is 6.0 and was 5.0"]);
    assert!(with("grounded").physics().changes_since(grounded.physics()).is_empty());
}

/// Values beside the wall's field, the key that is refused, and parts of what is told.
const REFUSALS: &[(&[&str], &str, &[&str])] = &[
    (&["walls.0.field=grounded"], "walls[0].field", &["make it a face of the domain", "z_min"]),
    (&["walls.1.field=earthed"], "walls[1].field", &["the word for this is \"grounded\""]),
    (&["walls.1.field={ potential_V = \"high\" }"], "walls[1].field.potential_V", &["a number"]),
    (&["walls.1.field={ floating = {} }"], "walls[1].field.floating.charge_C", &["charge_C = 0.0"]),
    (&["walls.1.field={ floating = 1e-9 }"], "walls[1].field.floating", &["charge_C"]),
    (
        &["walls.1.field={ potential_V = 1.0, floating = { charge_C = 0.0 } }"],
        "walls[1].field.floating",
        &["give one of the two"],
    ),
    (&["walls.1.field={}"], "walls[1].field.potential_V", &["or the word \"grounded\""]),
    (&["walls.1.potential_V=5.0"], "walls[1].potential_V", &["walls[1].field", "{ potential_V = 1000.0 }"]),
    (
        &[
            "walls.1.field=grounded",
            "electric_field.method=cutoff",
            "electric_field.field_cutoff_radius=1e-3",
        ],
        "walls[1].field",
        &["method cutoff", "\"p3m\""],
    ),
    (
        &[
            "walls.1.field=grounded",
            "electric_field.method=kolehmainen",
            "electric_field.field_cutoff_radius=1e-3",
        ],
        "walls[1].field",
        &["method kolehmainen", "\"p3m\""],
    ),
    (
        &["walls.1.field=grounded", "walls.1.motion=[{ velocity_m_s = [0, 0, 0.1] }]"],
        "walls[1].field",
        &["walls at rest", "surface_velocity_m_s"],
    ),
    (
        &["walls.1.field=grounded", "walls.1.charging=insulating"],
        "walls[1].charging",
        &["charging = \"grounded\""],
    ),
    (
        &["walls.1.field={ potential_V = 1.0 }", "walls.1.charging=insulating"],
        "walls[1].charging",
        &["makes it a conductor"],
    ),
    (
        &["walls.1.field={ floating = { charge_C = 0.0 } }", "walls.1.charging=insulating"],
        "walls[1].charging",
        &["makes it a conductor"],
    ),
    (
        &[
            "walls.1.field={ floating = { charge_C = 0.0 } }",
            "electric_field.enable_collision_charge_transfer=true",
            "materials.1.work_function_eV=4.0",
        ],
        "walls[1].field",
        &["charging = \"none\""],
    ),
    (
        &["walls.1.field=grounded", "domain.boundary.z_min=insulating", "domain.boundary.z_max=insulating"],
        "walls[1].field",
        &["ground a face or make one open"],
    ),
    (
        &["walls.1.field=grounded", "domain.max_m=[0.02, 0.015, 0.04]"],
        "walls[1].field",
        &["5.000e-3 m beyond the face y_max", "cut the surface"],
    ),
    (
        &["walls.1.field=grounded", "domain.min_m=[0, 0, 1e-3]", "walls.0.plane.point_m=[0, 0, 1e-3]"],
        "walls[1].field",
        &["1 of the surface's 1 triangles", "cut them off"],
    ),
    (
        &[
            "walls.1.field=grounded",
            "electric_field.external_field_V_m={ amplitude = [0, 0, 1e3], frequency_Hz = 50 }",
        ],
        "electric_field.coupling_interval",
        &["coupling_interval = 1"],
    ),
];

#[test]
fn what_a_field_of_a_wall_does_not_go_with_is_refused_with_advice() {
    for (values, key, parts) in REFUSALS {
        let said = Folder::good().refusal(values);
        assert!(said.contains(key), "{values:?}: {said}");
        assert!(said.contains("--set") || said.contains("scene.toml:"), "{values:?}: {said}");
        for part in *parts {
            assert!(said.contains(part), "{values:?}: {part:?} is not in: {said}");
        }
    }
}

#[test]
fn a_field_of_a_wall_needs_an_electric_field_and_no_solver() {
    let folder = Folder::good();
    let (before, rest) = SCENE.split_once("[electric_field]").unwrap();
    let (_, after) = rest.split_once("[output]").unwrap();
    folder.write("scene.toml", format!("{before}[output]{after}"));
    let said = folder.refusal(&["walls.1.field=grounded"]);
    assert!(said.contains("walls[1].field") && said.contains("add [electric_field]"), "{said}");

    let folder = Folder::good();
    std::fs::create_dir_all(folder.file("case/system")).unwrap();
    folder.write("case/system/controlDict", "");
    let said = folder.refusal(&["walls.1.field=grounded", "solver.openfoam_case=case"]);
    assert!(said.contains("walls[1].field") && said.contains("remove [solver]"), "{said}");
}

#[test]
fn what_goes_with_a_field_of_a_wall_is_taken() {
    let still = "walls.1.motion=[{ surface_velocity_m_s = [0.1, 0, 0] }]";
    let transfer = "electric_field.enable_collision_charge_transfer=true";
    let work = "materials.1.work_function_eV=4.0";
    let changing = "electric_field.external_field_V_m={ amplitude = [0, 0, 1e3], frequency_Hz = 50 }";
    for values in [
        &["walls.1.field=grounded", still][..],
        &["walls.1.field=grounded", "walls.1.charging=none"],
        &["walls.1.field=grounded", "electric_field.method=direct"],
        &["walls.1.field={ potential_V = 1.0 }", transfer, work],
        &["walls.1.field={ floating = { charge_C = 0.0 } }", "walls.1.charging=none", transfer, work],
        &["walls.1.field=grounded", changing, "electric_field.coupling_interval=1"],
        &["walls.1.field=grounded", "domain.boundary.z_min=insulating"],
    ] {
        assert_eq!(conductors(&read(values)).len(), 1, "{values:?}");
    }
    let outside = ["walls.1.field=grounded", "domain.boundary.y=open", "domain.max_m=[0.02, 0.015, 0.04]"];
    assert_eq!(conductors(&read(&outside)).len(), 1, "beyond an open face");
}

/// STL of right triangles in z = 1 mm with legs of these lengths [mm].
fn triangles(legs: &[f64]) -> String {
    let facet = |leg: &f64| {
        let to = 1.0 + leg;
        let corners = format!("vertex 1 1 1\nvertex {to} 1 1\nvertex 1 {to} 1\n");
        format!("facet normal 0 0 1\nouter loop\n{corners}endloop\nendfacet\n")
    };
    format!("solid\n{}endsolid\n", legs.iter().map(facet).collect::<String>())
}

#[test]
fn facets_are_divided_for_the_field_and_those_that_do_not_fit_the_grains_are_named() {
    let folder = Folder::good();
    let read = |legs: &[f64]| {
        folder.write("plate.stl", triangles(legs));
        folder.read(&["walls.1.field=grounded"]).unwrap()
    };
    // Legs of 8, 2 and 0.2 radii of the smallest grain.
    let scene = read(&[0.8, 0.2, 0.02]);
    assert_eq!(scene.warnings.len(), 1, "{:?}", scene.warnings);
    let small = &scene.warnings[0];
    assert!(small.contains("1 of the ") && small.contains("mesh it coarser"), "{small}");
    assert!(scene.conductor(1).unwrap().surface.triangles.len() > 3, "the large one is divided");
    let WallShape::Mesh(touched) = &scene.walls[1].shape else { panic!("a mesh") };
    assert_eq!(touched.triangles.len(), 3, "grains touch the facets of the file");
    // Eight sheets with legs of 180 radii: 3000 facets are not enough.
    let warnings = read(&[18.0; 8]).warnings;
    let large = warnings.iter().find(|warning| warning.contains("mesh it finer")).expect("a warning");
    assert!(large.contains("larger than 7 radii") && large.contains("divided to 3000 in all"), "{large}");
    assert_eq!(read(&[0.2, 0.3]).warnings, Vec::<String>::new());
}
