//! Meaning of good scenes.

use crate::common::{Folder, GRAINS, SCENE};
use amberfield_core::{
    Boundary, Cohesion, CouplingInterval, MaterialId, Method, RollingModel, Skin, Step, WallCharging,
    WallShape,
};
use amberfield_scene::{Purpose, write_particles_csv};
use nalgebra::Vector3;

#[test]
fn a_scene_becomes_its_description() {
    let folder = Folder::good();
    let scene = folder.read(&[]).unwrap();
    let domain = scene.domain.as_ref().unwrap();
    assert_eq!(domain.faces()[0], [Boundary::Periodic; 2]);
    assert_eq!(domain.faces()[2], [Boundary::Grounded, Boundary::Potential(100.0)]);
    assert_eq!(scene.title, "scene");
    assert_eq!(scene.materials[1].density_kg_m3, 7800.0);
    assert_eq!(scene.materials[1].rolling_friction, 0.0);
    assert!(matches!(scene.walls[0].shape, WallShape::Plane { normal, .. } if normal == Vector3::z()));
    let WallShape::Mesh(mesh) = &scene.walls[1].shape else { panic!("a surface") };
    assert_eq!(mesh.vertices[1], Vector3::new(20.0 * 1e-3, 0.0, 1e-3));
    assert_eq!(scene.walls[1].charging, WallCharging::Grounded);
    assert_eq!(scene.particles.id, [1, 2, 7]);
    assert_eq!(scene.particles.density, [2500.0, 2500.0, 7800.0]);
    assert_eq!(scene.groups, ["all", "fine", "coarse"]);
    assert_eq!(scene.particles.group[1].0, 0);
    let time = scene.time.as_ref().unwrap();
    assert_eq!((time.step, time.skin), (Step::Seconds(1e-6), Skin::Auto));
    assert!(scene.output.vtk && scene.output.csv);
    assert_eq!(scene.warnings.len(), 1, "the grounded surface on the internal grid: {:?}", scene.warnings);
}

#[test]
fn rolling_model_is_chosen_by_name_and_belongs_to_the_physics() {
    let plain = Folder::good().read(&[]).unwrap();
    assert_eq!(plain.rolling_model, RollingModel::Epsd);
    for model in [RollingModel::Epsd2, RollingModel::Cdt] {
        let key = format!("contacts.rolling_model={}", model.name());
        let asked = Folder::good().read(&[&key]).unwrap();
        assert_eq!(asked.rolling_model, model);
        assert_ne!(asked.physics(), plain.physics());
    }
}

#[test]
fn pairs_and_cohesion_are_read_by_name() {
    let plain = Folder::good().read(&[]).unwrap();
    assert!(plain.pairs.is_empty() && plain.cohesion == Cohesion::None);
    let keys = [
        "contacts.cohesion=jkr",
        "materials[0].surface_energy_J_m2=0.05",
        "pairs=[{ between = [\"steel\", \"glass\"], friction = 0.4, surface_energy_J_m2 = 0.02 }]",
    ];
    let asked = Folder::good().read(&keys).unwrap();
    assert_eq!(asked.cohesion, Cohesion::Jkr);
    assert_eq!(asked.materials[0].surface_energy_j_m2, 0.05);
    let [pair] = &asked.pairs[..] else { panic!("one pair") };
    assert!(pair.is_between(MaterialId(0), MaterialId(1)));
    assert_eq!((pair.friction, pair.restitution, pair.surface_energy_j_m2), (Some(0.4), None, Some(0.02)));
    let unused = Folder::good().read(&keys[1..]).unwrap();
    assert!(unused.warnings.iter().any(|warning| warning.contains("contacts.cohesion")));
}

#[test]
fn defaults_of_the_electric_field_are_those_of_the_contract() {
    let field = Folder::good().read(&[]).unwrap().electric_field.unwrap();
    assert_eq!((field.field.method, field.field.tolerance), (Method::P3m, 1e-2));
    assert_eq!(field.particle_group, "all");
    assert!(
        field.use_without_cfd_coupling && !field.enable_collision_charge_transfer && !field.limit_field_force
    );
    assert_eq!((field.charge_transfer_cutoff_m, field.field_force_limit_factor), (5e-7, 1e-3));
    assert_eq!(field.field.permittivity.relative(), 1.0);
    assert_eq!(field.field.coupling_interval, CouplingInterval::Auto);
    assert_eq!(field.field.force_limit, None);
}

#[test]
fn byte_order_marks_and_windows_line_ends_are_accepted() {
    let folder = Folder::good();
    let plain = folder.read(&[]).unwrap();
    folder.write("scene.toml", format!("\u{feff}{}", SCENE.replace('\n', "\r\n")));
    folder.write("grains.csv", format!("\u{feff}{}", GRAINS.replace('\n', "\r\n")));
    assert_eq!(folder.read(&[]).unwrap().particles, plain.particles);
}

#[test]
fn overrides_change_any_key() {
    let folder = Folder::good();
    let scene = folder
        .read(&[
            "electric_field.tolerance=1e-4",
            "domain.boundary.z_max=open",
            "walls.1.charging=\"none\"",
            "output={ every_s = 2.0 }",
        ])
        .unwrap();
    assert_eq!(scene.electric_field.as_ref().unwrap().field.tolerance, 1e-4);
    assert_eq!(scene.domain.as_ref().unwrap().faces()[2][1], Boundary::Open);
    assert_eq!(scene.output.every_s, Some(2.0));
    assert!(scene.resolved().contains("0.0001"), "{}", scene.resolved());
}

#[test]
fn the_resolved_scene_is_the_same_scene_from_anywhere() {
    let folder = Folder::good();
    let scene = folder.read(&["time.end_s=0.01"]).unwrap();
    let elsewhere = tempfile::tempdir().unwrap();
    let path = elsewhere.path().join("scene.toml");
    std::fs::write(&path, scene.resolved()).unwrap();
    let again = amberfield_scene::read_scene(&path, &[], Purpose::Run).unwrap();
    assert_eq!(again.physics().changes_since(scene.physics()), [""; 0]);
    assert_eq!((again.particles, again.walls.len(), again.time), (scene.particles, 2, scene.time));
}

#[test]
fn physics_is_known_from_output_and_changes_of_it_are_named() {
    let folder = Folder::good();
    let before = folder.read(&[]).unwrap();
    let changes = |set: &[&str]| folder.read(set).unwrap().physics().changes_since(before.physics());
    let technical = [
        "time.end_s=1.0",
        "output.every_s=0.5",
        "time.allow_unstable=true",
        "electric_field.tuning=model",
        "electric_field.far_tolerance=1e-9",
    ];
    assert_eq!(changes(&technical), [""; 0]);
    assert_eq!(
        changes(&["electric_field.tolerance=1e-3", "time.step_s=1e-9"]),
        ["electric_field.tolerance is 0.001 and was 0.01", "time.step_s is 0.000000001 and was 0.000001"]
    );
    folder.write("grains.csv", GRAINS.replace("0.003", "0.004"));
    assert_eq!(changes(&[]), ["grains.csv has other contents"]);
}

#[test]
fn a_field_needs_neither_materials_nor_time_nor_sizes() {
    let folder = Folder::good();
    folder.write(
        "scene.toml",
        "domain = { min_m = [0, 0, 0], max_m = [1, 1, 1], \
         boundary = { x = 'open', y = 'open', z = 'open' } }\n\
         particles.file = 'grains.csv'\n[electric_field]\n",
    );
    folder.write("grains.csv", "charge_C,radius_m,z_m,y_m,x_m,id\n1e-9,0,0.5,0.5,0.5,3\n");
    let scene = folder.read_for(Purpose::Field, &[]).unwrap();
    assert_eq!((scene.particles.radius[0], scene.particles.charge[0]), (0.0, 1e-9));
    assert!(folder.read_for(Purpose::Explain, &[]).is_ok());
    assert!(folder.read(&[]).is_err());
}

#[test]
fn particles_written_are_read_back_bitwise() {
    let folder = Folder::good();
    let mut scene = folder.read(&[]).unwrap();
    scene.particles.velocity[0] = Vector3::new(0.1, 1.0 / 3.0, -2e-300);
    write_particles_csv(&folder.file("grains.csv"), &scene.particles, &scene.materials, &scene.groups)
        .unwrap();
    assert_eq!(folder.read(&[]).unwrap().particles, scene.particles);
}

#[test]
fn a_command_line_is_the_same_as_keys() {
    let folder = Folder::good();
    let keys = folder
        .read(&[
            "electric_field={ field_cutoff_radius = 3e-3, enable_collision_charge_transfer = true }",
            "materials.1.work_function_eV=4.0",
        ])
        .unwrap();
    let line = folder
        .read(&[
            "electric_field={ command = \"enable_electric_field field_cutoff_radius 3e-3 \
             enable_collision_charge_transfer yes\" }",
            "materials.1.work_function_eV=4.0",
        ])
        .unwrap();
    assert_eq!(keys.electric_field, line.electric_field);
}

#[test]
fn columns_may_be_in_other_units() {
    let folder = Folder::good();
    folder.write(
        "grains.csv",
        "id,x_mm,y_um,z_m,diameter_um,charge_pC,material\n1,1,2000,0.003,200,-0.5,glass\n",
    );
    let scene = folder.read(&[]).unwrap();
    assert!((scene.particles.position[0] - Vector3::new(1e-3, 2e-3, 3e-3)).norm() < 1e-15);
    assert!((scene.particles.radius[0] - 1e-4).abs() < 1e-18);
    assert!((scene.particles.charge[0] + 0.5e-12).abs() < 1e-25);
    folder.write("grains.csv", "id,x,y_m,z_m,radius_m\n1,1,2,3,1e-4\n");
    let said = folder.refusal(&[]);
    assert!(said.contains("\"x\"; its unit is missing, write one of x_m, x_cm, x_mm"), "{said}");
    folder.write("grains.csv", "id,x_m,y_m,z_m,radius_m,diameter_m\n1,1,2,3,1e-4,2e-4\n");
    let said = folder.refusal(&[]);
    assert!(said.contains("columns radius_m and diameter_m are both radius_m"), "{said}");
}
