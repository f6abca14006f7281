//! Values that physics allows and that are mostly a mistake: a wrong unit, a lost exponent, a missing scale.

use super::description::Scene;
use amberfield_core::constants::VACUUM_PERMITTIVITY;
use amberfield_core::{Axis, Domain, OnExit, Outlet, OutletRegion, Particles, Side, Wall, WallShape};
use std::f64::consts::PI;
use std::ops::RangeInclusive;

/// Work functions of solids [eV].
const WORK_FUNCTION: RangeInclusive<f64> = 1.0..=10.0;
/// Densities of grains [kg/m³].
const DENSITY: RangeInclusive<f64> = 1.0..=25_000.0;
/// Speed that no powder has [m/s].
const SPEED: f64 = 300.0;
/// Field at which air breaks down [V/m].
const BREAKDOWN: f64 = 3e6;
/// Largest charge over that with which a grain's field is the one of breakdown.
const CHARGE: f64 = 10.0;
/// Largest ratio of sizes of a wall and the domain.
const SIZE: f64 = 100.0;

/// Warnings about values of a scene that are mostly a mistake.
pub(super) fn unusual_values(scene: &Scene) -> Vec<String> {
    let mut found = Vec::new();
    for material in &scene.materials {
        if let Some(work) = material.work_function_ev.filter(|work| !WORK_FUNCTION.contains(work)) {
            let name = &material.name;
            found.push(format!(
                "material \"{name}\": work_function_eV = {work} is outside 1 to 10 eV; check the unit"
            ));
        }
    }
    if let Some(domain) = &scene.domain {
        found.extend(scene.walls.iter().filter_map(|wall| unusual_size(wall, domain)));
    }
    found.extend(no_floor(scene));
    // Scenes without motion may have points of unit charge.
    if scene.time.is_some() {
        found.extend(unusual_grains(&scene.particles));
        found.extend(unusual_grains(&scene.feeds.grains));
    }
    found
}

/// Warning about a scene in which gravity pulls grains out of the domain, which ends the run.
fn no_floor(scene: &Scene) -> Option<String> {
    let (domain, time) = (scene.domain.as_ref()?, scene.time.as_ref()?);
    if !scene.walls.is_empty() || time.on_exit != OnExit::Stop {
        return None;
    }
    let pull = |axis: &Axis| time.gravity_m_s2[axis.index()];
    let down = Axis::ALL.into_iter().max_by(|a, b| pull(a).abs().total_cmp(&pull(b).abs()))?;
    if pull(&down) == 0.0 || domain.is_periodic(down) {
        return None;
    }
    let (side, place, towards) = match pull(&down) < 0.0 {
        true => ("min", domain.min(), 1),
        false => ("max", domain.max(), -1),
    };
    let k = down.index();
    let takes = |outlet: &Outlet| match &outlet.region {
        OutletRegion::Face(axis, of) => *axis == down && (*of == Side::Min) == (towards > 0),
        OutletRegion::Volume(volume) => volume.bounds().iter().any(|corner| corner[k] == place[k]),
    };
    if scene.outlets.iter().any(takes) {
        return None;
    }
    let floor = |axis: Axis, at: f64| if axis == down { at } else { 0.0 };
    let point = Axis::ALL.map(|axis| floor(axis, place[axis.index()]));
    let normal = Axis::ALL.map(|axis| if axis == down { towards } else { 0 });
    Some(format!(
        "gravity pulls the grains to the face {down}_{side}, which no wall holds them from: faces \
         bound the field, walls hold grains; add [[walls]] with plane = {{ point_m = {point:?}, \
         normal = {normal:?} }}, or let grains leave with particles.on_exit = \"delete\""
    ))
}

/// Warning about a wall that misses the domain or is far larger.
fn unusual_size(wall: &Wall, domain: &Domain) -> Option<String> {
    let WallShape::Mesh(mesh) = &wall.shape else { return None };
    let [low, high] = mesh.bounds()?;
    let misses = (0..3).any(|axis| low[axis] > domain.max()[axis] || high[axis] < domain.min()[axis]);
    let is_large = (high - low).max() > SIZE * domain.extent().max();
    let what = match (misses, is_large) {
        (false, false) => return None,
        (true, _) => "is outside the domain",
        (false, true) => "is more than 100 times as large as the domain",
    };
    Some(format!(
        "wall {}, from {:?} to {:?} m, {what}; check its scale (0.001 for a file in mm)",
        wall.name,
        low.as_slice(),
        high.as_slice()
    ))
}

/// Warnings about densities, speeds and charges of grains, one for each kind.
fn unusual_grains(particles: &Particles) -> Vec<String> {
    let breakdown = |i: usize| {
        let radius = particles.radius[i];
        4.0 * PI * VACUUM_PERMITTIVITY * radius * radius * BREAKDOWN
    };
    let density = |i: usize| particles.density[i];
    let speed = |i: usize| particles.velocity[i].norm();
    let charge = |i: usize| match particles.radius[i] > 0.0 {
        true => particles.charge[i].abs() / breakdown(i),
        // A point has no surface.
        false => 0.0,
    };
    let mut found = Vec::new();
    let mut tell = |what: &str, value: &dyn Fn(usize) -> f64, is_unusual: &dyn Fn(f64) -> bool| {
        let unusual: Vec<usize> = (0..particles.len()).filter(|&i| is_unusual(value(i))).collect();
        if let Some(&first) = unusual.first() {
            let (count, id, value) = (unusual.len(), particles.id[first], value(first));
            found
                .push(format!("{count} grain(s), first grain {id} with {value:.3e}: {what}; check the unit"));
        }
    };
    tell("a density in kg/m3 outside 1 to 25 000", &density, &|density| !DENSITY.contains(&density));
    tell("a speed in m/s that no powder has, above 300", &speed, &|speed| speed > SPEED);
    let what = "times the charge at which air breaks down at a grain's surface, which is above 10";
    tell(what, &charge, &|charge| charge > CHARGE);
    found
}

#[cfg(test)]
mod tests {
    use super::super::{Purpose, parse_scene};

    /// Warnings of a scene with one grain, a floor of triangles from 0 to `size` [m] and some values.
    fn warnings(size: f64, density: f64, charge: f64, speed: f64) -> Vec<String> {
        let folder = tempfile::tempdir().expect("a folder");
        let file = |name: &str, text: String| std::fs::write(folder.path().join(name), text).expect("a file");
        file(
            "floor.stl",
            format!(
                "solid\nfacet normal 0 0 1\nouter loop\nvertex {size} {size} 0\nvertex {} {size} 0\n\
                 vertex {size} {} 0\nendloop\nendfacet\nendsolid\n",
                2.0 * size,
                2.0 * size
            ),
        );
        file(
            "g.csv",
            format!("id,x_m,y_m,z_m,radius_m,charge_C,vx_m_s\n1,0.05,0.05,0.05,1e-3,{charge:e},{speed}\n"),
        );
        let text = format!(
            "[domain]\nmin_m = [0, 0, 0]\nmax_m = [0.1, 0.1, 0.1]\n\
             boundary = {{ x = \"open\", y = \"open\", z = \"open\" }}\n\
             [[walls]]\nstl = \"floor.stl\"\n\
             [[materials]]\nname = \"m\"\ndensity_kg_m3 = {density:e}\nyoung_Pa = 1e6\npoisson = 0.3\n\
             restitution = 0.5\nfriction = 0.0\n[particles]\nfile = \"g.csv\"\n\
             [time]\nstep_s = 1e-6\nend_s = 1e-3\n"
        );
        let path = folder.path();
        let scene = parse_scene(&text, "scene.toml", path, &[], Purpose::Run).expect("a good scene");
        scene.warnings
    }

    #[test]
    fn gravity_without_a_wall_is_named_with_the_wall_that_is_missing() {
        let scene = |z: &str, gravity: &str, exit: &str| {
            let text = format!(
                "[domain]\nmin_m = [0, 0, -0.1]\nmax_m = [0.1, 0.1, 0.1]\n\
                 boundary = {{ x = \"open\", y = \"open\", z = \"{z}\" }}\n\
                 [[materials]]\nname = \"m\"\ndensity_kg_m3 = 2500\nyoung_Pa = 1e6\npoisson = 0.3\n\
                 restitution = 0.5\nfriction = 0.0\n[particles]\non_exit = \"{exit}\"\n\
                 generate = {{ material = \"m\", count = 1, radius_m = 1e-3 }}\n\
                 [time]\nstep_s = 1e-6\nend_s = 1e-3\ngravity_m_s2 = {gravity}\n"
            );
            let folder = std::path::Path::new("");
            parse_scene(&text, "scene.toml", folder, &[], Purpose::Run).expect("a good scene").warnings
        };
        let found = scene("grounded", "[0, 0, -9.81]", "stop");
        assert!(found.len() == 1 && found[0].contains("z_min"), "{found:?}");
        assert!(found[0].contains("point_m = [0.0, 0.0, -0.1], normal = [0, 0, 1]"), "{found:?}");
        assert!(scene("open", "[0, 2, 1]", "stop")[0].contains("normal = [0, -1, 0]"));
        for (z, gravity, exit) in [
            ("periodic", "[0, 0, -9.81]", "stop"),
            ("open", "[0, 0, 0]", "stop"),
            ("open", "[0, 0, -9.81]", "delete"),
        ] {
            assert_eq!(scene(z, gravity, exit), Vec::<String>::new());
        }
    }

    #[test]
    fn usual_values_are_silent_and_each_unusual_one_is_named() {
        assert_eq!(warnings(0.03, 2500.0, 1e-12, 1.0), Vec::<String>::new());
        for (size, density, charge, speed, word) in [
            (30.0, 2500.0, 1e-12, 1.0, "scale"),
            (0.03, 2.7e6, 1e-12, 1.0, "density"),
            (0.03, 2500.0, 1e-8, 1.0, "breaks down"),
            (0.03, 2500.0, 1e-12, 2000.0, "speed"),
        ] {
            let found = warnings(size, density, charge, speed);
            assert!(found.len() == 1 && found[0].contains(word), "{word}: {found:?}");
        }
    }
}
