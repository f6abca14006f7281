//! Random fills: no overlaps, no contact with faces, the distribution of the scene, one seed.

use crate::common::Folder;
use amberfield_core::{Domain, Particles};
use amberfield_scene::Scene;
use nalgebra::Vector3;

const SCENE: &str = r#"
[domain]
min_m = [0, 0, 0]
max_m = [1e-2, 1e-2, 1e-2]
[domain.boundary]
x = "periodic"
y = "periodic"
z = "grounded"
[[materials]]
name = "glass"
density_kg_m3 = 2500.0
young_Pa = 1e7
poisson = 0.22
restitution = 0.9
friction = 0.3
[time]
step_s = "auto"
end_s = 1.0
"#;

fn scene(generate: &str, more: &str) -> Result<Scene, String> {
    let folder = Folder::good();
    folder.write("scene.toml", format!("{SCENE}{more}\n[particles.generate]\n{generate}\n"));
    folder.read(&[]).map_err(|error| error.to_string())
}

fn shortest(domain: &Domain, mut difference: Vector3<f64>) -> Vector3<f64> {
    for axis in amberfield_core::Axis::ALL {
        if domain.is_periodic(axis) {
            let length = domain.extent()[axis.index()];
            difference[axis.index()] -= length * (difference[axis.index()] / length).round();
        }
    }
    difference
}

/// Smallest distance between the surfaces of two grains, over the sum of their radii.
fn smallest_gap(scene: &Scene) -> f64 {
    let (domain, grains) = (scene.domain.as_ref().unwrap(), &scene.particles);
    let mut smallest = f64::INFINITY;
    for i in 0..grains.len() {
        for j in 0..i {
            let distance = shortest(domain, grains.position[i] - grains.position[j]).norm();
            smallest = smallest.min(distance / (grains.radius[i] + grains.radius[j]) - 1.0);
        }
    }
    smallest
}

fn clear_of_faces(scene: &Scene) -> bool {
    let grains: &Particles = &scene.particles;
    (0..grains.len()).all(|i| {
        let z = grains.position[i].z;
        z >= grains.radius[i]
            && z <= 1e-2 - grains.radius[i]
            && scene.domain.as_ref().unwrap().contains(&grains.position[i])
    })
}

#[test]
fn sequential_addition_leaves_no_overlap() {
    let scene = scene("count = 2000\nradius_m = 3e-4\nseed = 3\ncharge_C = { bipolar = 1e-14 }", "").unwrap();
    assert!(smallest_gap(&scene) > 0.0 && clear_of_faces(&scene), "{}", smallest_gap(&scene));
    assert_eq!(scene.particles.id, (1..=2000).collect::<Vec<_>>());
    let positive = scene.particles.charge.iter().filter(|charge| **charge == 1e-14).count();
    let negative = scene.particles.charge.iter().filter(|charge| **charge == -1e-14).count();
    assert_eq!((positive, negative), (1000, 1000));
}

#[test]
fn dense_fills_are_relaxed() {
    // 1430 spheres of 0.46 mm: volume fraction 0.583.
    let scene = scene("count = 1430\nradius_m = 4.6e-4\nseed = 1", "").unwrap();
    assert!(smallest_gap(&scene) > 0.0 && clear_of_faces(&scene), "{}", smallest_gap(&scene));
}

#[test]
fn mixed_sizes_and_planes_are_respected() {
    let plane = "[[walls]]\nplane = { point_m = [0, 0, 5e-3], normal = [0, 1, 1] }\n";
    let generate = "count = 1500\n\
                    radius_m = { sizes = { radius_m = [1e-3, 1e-4, 1e-5], fraction = [0.01, 0.5, 0.49] } }";
    let scene = scene(generate, plane).unwrap();
    assert!(smallest_gap(&scene) > 0.0 && clear_of_faces(&scene));
    let normal = Vector3::new(0.0, 1.0, 1.0).normalize();
    for (position, radius) in scene.particles.position.iter().zip(&scene.particles.radius) {
        assert!((position - Vector3::new(0.0, 0.0, 5e-3)).dot(&normal) >= *radius);
    }
    let large = scene.particles.radius.iter().filter(|radius| **radius == 1e-3).count();
    assert_eq!(large, 15);
}

#[test]
fn cylinders_hold_their_grains() {
    let generate = "count = 800\nradius_m = { uniform = { min = 1e-4, max = 4e-4 } }\n\
        region = { cylinder = { base_m = [5e-3, 5e-3, 1e-3], axis = [0, 0, 1], \
        radius_m = 4e-3, length_m = 8e-3 } }\n\
        charge_C = { normal = { mean = 0.0, std = 1e-14 } }";
    let scene = scene(generate, "").unwrap();
    assert!(smallest_gap(&scene) > 0.0);
    for (position, radius) in scene.particles.position.iter().zip(&scene.particles.radius) {
        let across = ((position.x - 5e-3).powi(2) + (position.y - 5e-3).powi(2)).sqrt();
        assert!(across + radius <= 4e-3 && position.z - radius >= 1e-3 && position.z + radius <= 9e-3);
    }
}

#[test]
fn a_seed_is_a_fill() {
    let text = "count = 300\nradius_m = { log_normal = { median = 2e-4, sigma = 0.3 } }\nseed = ";
    let first = scene(&format!("{text}5"), "").unwrap().particles;
    assert_eq!(scene(&format!("{text}5"), "").unwrap().particles, first);
    assert_ne!(scene(&format!("{text}6"), "").unwrap().particles.position, first.position);
}

#[test]
fn impossible_fills_are_refused_with_numbers() {
    for (generate, part) in [
        ("count = 2000\nradius_m = 4.6e-4", "fraction 0.815"),
        ("count = 1\nradius_m = 6e-3", "does not fit"),
        (
            "count = 10\nradius_m = 1e-4\nregion = { box = { min_m = [0, 0, 0], max_m = [1, 1, 1] } }",
            "beyond the domain",
        ),
        ("count = 10\nradius_m = { normal = { mean = 1e-4, std = 1e-5, min = 2e-4 } }", "must lie between"),
    ] {
        let message = scene(generate, "").unwrap_err();
        assert!(message.contains(part), "{message}");
    }
    let sealed = "[[walls]]\nplane = { point_m = [0, 0, 1e-2], normal = [0, 0, 1] }\n";
    assert!(scene("count = 1\nradius_m = 1e-4", sealed).unwrap_err().contains("every wall"));
}

/// Closed tube along z of a radius and half a height [m], as text of an STL file; open without its lids.
fn tube(radius: f64, half: f64, lids: bool) -> String {
    let sides = 32;
    let at = |k: usize, z: f64| {
        let angle = 2.0 * std::f64::consts::PI * (k % sides) as f64 / sides as f64;
        [5e-3 + radius * angle.cos(), 5e-3 + radius * angle.sin(), 5e-3 + z]
    };
    let mut text = "solid tube\n".to_owned();
    let mut facet = |corners: [[f64; 3]; 3]| {
        text += "facet normal 0 0 0\nouter loop\n";
        for [x, y, z] in corners {
            text += &format!("vertex {x:e} {y:e} {z:e}\n");
        }
        text += "endloop\nendfacet\n";
    };
    for k in 0..sides {
        facet([at(k, -half), at(k + 1, -half), at(k + 1, half)]);
        facet([at(k, -half), at(k + 1, half), at(k, half)]);
        for z in [-half, half].into_iter().filter(|_| lids) {
            facet([[5e-3, 5e-3, 5e-3 + z], at(k, z), at(k + 1, z)]);
        }
    }
    text + "endsolid\n"
}

#[test]
fn grains_keep_clear_of_surfaces_and_of_what_is_behind_closed_ones() {
    let radius = 2e-4;
    // A drum around most of the region, a drum that is an obstacle, and an open tube.
    for (outer, half, lids, inside) in
        [(4.6e-3, 4.6e-3, true, Some(true)), (2e-3, 2e-3, true, Some(false)), (3e-3, 3e-3, false, None)]
    {
        // The last one jams in the drum: overlaps are removed there.
        for count in [300, 1500, 7000].into_iter().filter(|count| *count < 7000 || inside == Some(true)) {
            let folder = Folder::good();
            folder.write("tube.stl", tube(outer, half, lids));
            let generate = format!("material = \"glass\"\ncount = {count}\nradius_m = {radius}\nseed = 3\n");
            let walls = "[[walls]]\nstl = \"tube.stl\"\nmaterial = \"glass\"\n";
            folder.write("scene.toml", format!("{SCENE}{walls}\n[particles.generate]\n{generate}"));
            let scene = folder.read(&[]).expect("a good scene");
            for centre in &scene.particles.position {
                let across = (centre.x - 5e-3).hypot(centre.y - 5e-3);
                let along = (centre.z - 5e-3).abs();
                // Chords are nearer to the axis by half of a percent.
                let is_inside = across < outer - 0.999 * radius && along < half - 0.999 * radius;
                let off = (across - outer).max(0.0).hypot((along - half).max(0.0));
                let is_outside = off > 0.99 * radius - 0.005 * outer && off > 0.0;
                let is_good = match inside {
                    Some(true) => is_inside,
                    Some(false) => is_outside,
                    None => (across - outer).abs() > radius * 0.99 - 0.005 * outer || along > half,
                };
                assert!(is_good, "{outer} {lids} {count}: {centre:?}");
            }
        }
    }
}
