//! Text of a plan, and of what a run has and costs.

use amberfield_core::{Conductor, Plan, Wall, WallShape};
use amberfield_dem::Outlook;
use amberfield_scene::Scene;

/// Number of steps above which a run is told how long it takes.
const MANY_STEPS: f64 = 1e9;
/// Seconds that a step takes apart from its grains, and those of a grain in it on one processor: plain beds
/// of 10³ to 10⁶ grains in docs/reports/speed.md, to a factor of some two.
const STEP_TAKES: [f64; 2] = [2e-6, 2e-7];
/// Speed for which restitutions are told where nothing moves [m/s].
const USUAL_SPEED: f64 = 1.0;

/// Lines of a plan: the stages that run, then those that are left out.
pub(crate) fn lines(plan: &Plan) -> Vec<String> {
    let width = plan.stages().iter().chain(plan.left_out()).map(|entry| entry.stage.len()).max().unwrap_or(0);
    let mut lines = vec!["runs:".to_owned()];
    lines.extend(plan.stages().iter().map(|entry| format!("  {:width$}  {}", entry.stage, entry.reason)));
    lines.push("left out:".to_owned());
    lines.extend(plan.left_out().iter().map(|entry| format!("  {:width$}  {}", entry.stage, entry.reason)));
    lines
}

/// Lines with the place of each wall.
pub(crate) fn walls(scene: &Scene) -> Vec<String> {
    let place = |shape: &WallShape| match shape {
        WallShape::Plane { point, normal } => {
            format!("plane through {:?} m, normal {:?}", point.as_slice(), normal.as_slice())
        }
        WallShape::Mesh(mesh) => mesh.bounds().map_or_else(
            || "no triangles".to_owned(),
            |[low, high]| format!("{:?} to {:?} m", low.as_slice(), high.as_slice()),
        ),
    };
    let bounds = |number: usize, wall: &Wall| {
        scene.conductor(number).map(|conductor| facets(scene, wall, conductor)).unwrap_or_default()
    };
    scene
        .walls
        .iter()
        .enumerate()
        .map(|(number, wall)| {
            let moves = if wall.motion.is_empty() { "" } else { ", moves" };
            format!("{}: {}{moves}{}", wall.name, place(&wall.shape), bounds(number, wall))
        })
        .collect()
}

/// Facets of a conductor, over the radius of the smallest grain where grains have one.
fn facets(scene: &Scene, wall: &Wall, conductor: &Conductor) -> String {
    let mut sizes: Vec<f64> = conductor.surface.sizes().collect();
    sizes.sort_by(f64::total_cmp);
    let smallest = scene.smallest_radius();
    let [least, median, most] = [0, sizes.len() / 2, sizes.len() - 1].map(|at| match smallest {
        Some(radius) => format!("{:.2}", sizes[at] / radius),
        None => format!("{:.3e}", sizes[at]),
    });
    let unit = if smallest.is_some() { "radii of the smallest grain" } else { "m" };
    let given = match &wall.shape {
        WallShape::Mesh(mesh) if mesh.triangles.len() != sizes.len() => {
            format!(" (divided from {})", mesh.triangles.len())
        }
        _ => String::new(),
    };
    format!(
        ", bounds the field by {} facets{given} of {least} to {most} {unit}, {median} in the median",
        sizes.len()
    )
}

/// Line with what the step costs in accuracy of impacts.
pub(crate) fn restitution(scene: &Scene, outlook: &Outlook) -> String {
    let fastest = outlook.fastest_m_s;
    let speed = if fastest > 0.0 { 2.0 * fastest } else { USUAL_SPEED };
    let (steps, found) = outlook.restitutions(&scene.materials, speed);
    if !steps.is_finite() {
        return "restitution: no grain moves".to_owned();
    }
    let found: Vec<String> =
        found.iter().map(|of| format!("{} {} acts as {:.4}", of.material, of.asked, of.found)).collect();
    format!("restitution: {steps:.1} steps in a contact at {speed:.3} m/s; {}", found.join(", "))
}

/// Line with how long very many steps take [steps]; `None` where they are not so many.
pub(crate) fn duration(grains: usize, steps: f64) -> Option<String> {
    let [step, grain] = STEP_TAKES;
    #[expect(clippy::cast_precision_loss, reason = "an estimate")]
    let grains = grains as f64 / rayon::current_num_threads() as f64;
    let seconds = steps * (step + grain * grains);
    (steps > MANY_STEPS).then(|| {
        format!(
            "{steps:.2e} steps take some {:.1} days without field and gas; make time.step_s larger, the \
             grains softer (young_Pa), or time.end_s smaller",
            seconds / 86_400.0
        )
    })
}
