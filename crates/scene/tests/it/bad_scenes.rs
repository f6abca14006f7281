//! Bad values of all kinds, each refused by one clear message.

use crate::common::{Folder, GRAINS, PLATE, SCENE};
use std::fmt::Write as _;

/// Changes of the good scene: the text to replace, and its replacement.
const SCENE_CHANGES: &[(&str, &str)] = &[
    ("tolerance = 1e-2", "tolerence = 1e-2"),
    ("[output]", "[ouput]"),
    ("tolerance = 1e-2", "tolerance = nan"),
    ("tolerance = 1e-2", "tolerance = 5"),
    ("tolerance = 1e-2", "tolerance = \"fine\""),
    ("tolerance = 1e-2", "method = \"pppm\""),
    ("tolerance = 1e-2", "method = \"kolehmainen\""),
    ("tolerance = 1e-2", "field_force_limit_factor = 1.5"),
    ("tolerance = 1e-2", "use_without_cfd_coupling = false"),
    ("tolerance = 1e-2", "particle_group = \"fin\""),
    ("tolerance = 1e-2", "enable_collision_charge_transfer = true"),
    ("tolerance = 1e-2", "grid = { cells = [8, 8] }"),
    ("tolerance = 1e-2", "grid = { cells = [1000, 1000, 1000] }"),
    ("tolerance = 1e-2", "field_cutoff_radius = 1.0"),
    ("tolerance = 1e-2", "coupling_interval = 0"),
    ("tolerance = 1e-2", "command = \"enable_electric_field\""),
    (
        "tolerance = 1e-2",
        "command = \"enable_electric_field field_cutoff_radius 1e-3 field_cutoff_radius 1e-3\"",
    ),
    (
        "tolerance = 1e-2",
        "command = \"enable_electric_field field_cutoff_radius 1e-3 limit_field_force true\"",
    ),
    ("tolerance = 1e-2", "command = \"enable_electric_field field_cutof_radius 1e-3\""),
    ("tolerance = 1e-2", "command = \"enable_electric_field field_cutoff_radius 1e-3\"\noverlap = true"),
    ("tolerance = 1e-2", "relative_permittivity = inf"),
    ("end_s = 0.05", ""),
    ("end_s = 0.05", "end_s = -1"),
    ("end_s = 0.05", "end_s = 1e300"),
    ("end_s = 0.05", "end_s = 99999999999999999999999"),
    ("step_s = 1e-6", "step_s = \"atuo\""),
    ("step_s = 1e-6", "step_s = 1.0"),
    ("gravity_m_s2 = [0, 0, -9.81]", "gravity_m_s2 = [0, -9.81]"),
    ("gravity_m_s2 = [0, 0, -9.81]", "gravity_m_s2 = [0, 0, \"down\"]"),
    ("max_m = [0.02, 0.02, 0.04]", "max_m = [0.02, -0.02, 0.04]"),
    ("x = \"periodic\"", "x_min = \"periodic\""),
    ("x = \"periodic\"", "x = \"periodic\"\nx_min = \"periodic\""),
    ("x = \"periodic\"", "x_min = \"periodic\"\nx_max = \"open\""),
    ("x = \"periodic\"", "x = \"perodic\""),
    ("z_max = { potential_V = 100.0 }", "z_max = { potental_V = 100.0 }"),
    ("z_max = { potential_V = 100.0 }", "z_max = { potential_V = 1.0, normal_field_V_m = 1.0 }"),
    ("poisson = 0.3", "poisson = 0.7"),
    ("density_kg_m3 = 7800", "density_kg_m3 = -7800"),
    ("density_kg_m3 = 7800", "density_kg_m3 = true"),
    ("name = \"steel\"", "name = \"glass\""),
    ("name = \"steel\"", "name = 2024-01-01"),
    ("material = \"steel\"", "material = \"stel\""),
    ("normal = [0, 0, 2]", "normal = [0, 0, 0]"),
    ("stl = \"plate.stl\"", "stl = \"plat.stl\""),
    ("stl = \"plate.stl\"", "stl = \".\""),
    #[cfg(unix)]
    ("stl = \"plate.stl\"", "stl = \"/dev/zero\""),
    ("charging = \"grounded\"", "charging = \"ground\""),
    ("stl = \"plate.stl\"\nscale = 1e-3", ""),
    ("stl = \"plate.stl\"", "patch = \"plate\""),
    ("stl = \"plate.stl\"\nscale = 1e-3", "patch = \"plate\""),
    ("file = \"grains.csv\"", ""),
    ("file = \"grains.csv\"", "file = \"grains.csv\"\ngenerate = { count = 1 }"),
    ("file = \"grains.csv\"", "generate = { count = 0 }"),
    ("file = \"grains.csv\"", "generate = { material = \"glass\", count = 5, radius_m = 1e-4 }"),
    ("file = \"grains.csv\"", "generate = { material = \"glass\", count = 5, radius_m = { normal = 1 } }"),
    ("file = \"grains.csv\"", "file = \"grains.csv\"\non_exit = \"ignore\""),
    ("formats = [\"vtk\", \"csv\"]", "formats = [\"vtu\"]"),
    ("[output]", "[charge_transfer]\nvelocity_ratio = 1.0\n[output]"),
    ("[output]", "[[pairs]]\nbetween = [\"glass\", \"stel\"]\nfriction = 0.1\n[output]"),
    ("[output]", "[[pairs]]\nbetween = [\"glass\"]\nfriction = 0.1\n[output]"),
    ("[output]", "[[pairs]]\nbetween = [\"glass\", \"steel\"]\n[output]"),
    ("[output]", "[[pairs]]\nfriction = 0.1\n[output]"),
    ("[output]", "[[pairs]]\nbetween = [\"glass\", \"steel\"]\nfriction = -0.1\n[output]"),
    ("[output]", "[[pairs]]\nbetween = [\"glass\", \"steel\"]\nfricton = 0.1\n[output]"),
    (
        "[output]",
        "[[pairs]]\nbetween = [\"glass\", \"steel\"]\nfriction = 0.1\n\
         [[pairs]]\nbetween = [\"steel\", \"glass\"]\nrestitution = 0.5\n[output]",
    ),
    ("[output]", "[contacts]\ncohesion = \"jkr\"\n[output]"),
    ("[output]", "[contacts]\ncohesion = \"jrk\"\n[output]"),
    ("density_kg_m3 = 7800", "density_kg_m3 = 7800\nsurface_energy_J_m2 = -1"),
    ("[output]", "[solver]\nopenfoam_case = \"nowhere\"\n[output]"),
    ("[output]", "[solver]\nopenfoam_case = \".\"\nhosts = \"nowhere\"\n[output]"),
    ("[output]", "[solver]\nopenfoam_case = \".\"\nhosts = \"nowhere\"\nranks = 2\n[output]"),
    ("[domain]", "[domain"),
    ("[domain]", "= 1\n[domain]"),
    ("[time]", "[time]\nstep_s = 1e-5"),
];

/// Changes of the good particles file: the text to replace, and its replacement.
const GRAIN_CHANGES: &[(&str, &str)] = &[
    ("charge_C", "charge"),
    (",charge_C,", ",group,"),
    ("radius_m", "group"),
    ("0.002,", "nan,"),
    ("0.002,", "inf,"),
    ("0.002,", "0.5,"),
    ("0.002,", "zero,"),
    ("0.002,", ","),
    ("2,0.002", "1,0.002"),
    ("2,0.002", "-2,0.002"),
    ("2,0.002", "2.5,0.002"),
    ("2e-4", "-2e-4"),
    ("2e-4", "0"),
    ("2e-4", "1e9"),
    ("2e-4", "1e-300"),
    ("-1e-14", "1e300"),
    ("-1e-14", "1e-300"),
    ("glass,fine", "glas,fine"),
    ("glass,fine", "glass"),
    ("7,0.003", "7,\"0.003"),
];

#[test]
fn bad_scene_values() {
    let mut report = String::new();
    for (from, to) in SCENE_CHANGES {
        let folder = Folder::good();
        assert!(SCENE.contains(from), "{from}");
        folder.write("scene.toml", SCENE.replacen(from, to, 1));
        let _ = writeln!(
            report,
            "{}\n    {}",
            to.replace('\n', "⏎"),
            folder.refusal(&[]).replace('\n', "\n    ")
        );
    }
    insta::assert_snapshot!(report);
}

#[test]
fn bad_grains() {
    let mut report = String::new();
    for (from, to) in GRAIN_CHANGES {
        let folder = Folder::good();
        assert!(GRAINS.contains(from), "{from}");
        folder.write("grains.csv", GRAINS.replacen(from, to, 1));
        let _ = writeln!(report, "{to}\n    {}", folder.refusal(&[]));
    }
    for (name, content) in [
        ("empty", Vec::new()),
        ("header only", b"id,x_m,y_m,z_m,radius_m,charge_C\n".to_vec()),
        ("no charge", b"id,x_m,y_m,z_m,radius_m,material\n1,0,0,0,1e-4,glass\n".to_vec()),
        ("no material", b"id,x_m,y_m,z_m,radius_m,charge_C\n1,0,0,0,1e-4,0\n".to_vec()),
        ("not UTF-8", b"id,x_m\n\xff\xfe".to_vec()),
        ("a million characters", format!("id,{}\n", "x".repeat(1_000_000)).into_bytes()),
        (
            "a million digits",
            format!(
                "id,x_m,y_m,z_m,radius_m,charge_C,material\n1,0,0,0,1e-4,{}z,glass\n",
                "9".repeat(1_000_000)
            )
            .into_bytes(),
        ),
        ("binary", (0..=255).collect()),
    ] {
        let folder = Folder::good();
        folder.write("grains.csv", content);
        let _ = writeln!(report, "{name}\n    {}", folder.refusal(&[]));
    }
    insta::assert_snapshot!(report);
}

#[test]
fn bad_files_and_overrides() {
    let mut report = String::new();
    let mut refuse = |name: &str, folder: &Folder, overrides: &[&str]| {
        let _ = writeln!(report, "{name}\n    {}", folder.refusal(overrides).replace('\n', "\n    "));
    };
    for (name, content) in [
        ("empty scene", Vec::new()),
        ("scene of spaces", b" \n".to_vec()),
        ("not UTF-8", b"[domain]\n\xff".to_vec()),
        ("a million characters", "x".repeat(1_000_000).into_bytes()),
        ("a million brackets", format!("a = {}", "[".repeat(1_000_000)).into_bytes()),
    ] {
        let folder = Folder::good();
        folder.write("scene.toml", content);
        refuse(name, &folder, &[]);
    }
    let folder = Folder::good();
    std::fs::remove_file(folder.file("scene.toml")).unwrap();
    refuse("no scene", &folder, &[]);
    std::fs::create_dir(folder.file("scene.toml")).unwrap();
    refuse("a directory", &folder, &[]);
    for content in [
        "solid\n",
        "solid\nvertex 1 2\n",
        "solid\nvertex 1 2 nan\n",
        "hello",
        "solid\nfacet\nvertex 0 0 0\nendfacet",
    ] {
        let folder = Folder::good();
        folder.write("plate.stl", content);
        refuse(&format!("surface {content:?}"), &folder, &[]);
    }
    let folder = Folder::good();
    folder.write("plate.stl", PLATE.replace("20 0 1", "1e300 0 1"));
    refuse("huge surface", &folder, &[]);
    for set in [
        "electric_field.tolerence=1",
        "electric_field.tolerance=-1",
        "time",
        "time.end_s.x=1",
        "walls.9.charging=none",
        "particles.file=x.csv",
    ] {
        refuse(set, &Folder::good(), &[set]);
    }
    insta::assert_snapshot!(report);
}
