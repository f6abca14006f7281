//! Command `amberfield explain`.

use crate::arguments::ExplainOptions;
use crate::failure::Failure;
use crate::print::line;
use crate::run::{
    Charges, SolverConnections, SolverFolder, begin, charges_of, connect_solver, domain_of, field_of,
    read_scene, scene_name, setup_of,
};
use crate::{limits, machine, plan_text};
use amberfield_core::{Axis, Boundary, Course, Domain, OutletRegion, PotentialCourse, Side};
use amberfield_dem::Outlook;
use amberfield_field::ElectricField;
use amberfield_field::far::Connect;
use amberfield_scene::{ElectricFieldSettings, Purpose, Scene};
use std::mem::size_of;

/// Memory for the motion of a grain [bytes]: state, forces, and neighbour lists with the usual 8 to 12
/// partners.
const BYTES_PER_MOVING_GRAIN: usize = 1200;

/// Number of grains above which a scene without a field is explained without placing them.
const MANY: usize = 1_000_000;

/// Prints what a scene will do.
pub(crate) fn explain(options: &ExplainOptions) -> Result<(), Failure> {
    let folder = SolverFolder::temporary()?;
    let mut scene = read_scene(&options.scene, &options.set, Purpose::Explain, &folder)?;
    print_scene(&scene_name(&options.scene), &scene);
    if let Some(field) = &scene.electric_field {
        print_settings(field);
    }
    for warning in &scene.warnings {
        line(format_args!("warning: {warning}"));
    }
    let solver = connect_solver(&mut scene, &folder)?;
    for warning in &solver.warnings {
        line(format_args!("warning: {warning}"));
    }
    if scene.time.is_some() { explain_run(&mut scene, solver) } else { explain_field(&scene, solver.field) }
}

/// Prints the content of a scene.
fn print_scene(name: &str, scene: &Scene) {
    let particles = &scene.particles;
    let range = |values: &[f64]| {
        if values.is_empty() {
            return "-".to_owned();
        }
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        format!("{low:.4e} to {high:.4e}")
    };
    line(format_args!("scene: {name}"));
    line(format_args!(
        "grains: {}, radii {} m, charges {} C, net charge {:.4e} C",
        particles.len(),
        range(&particles.radius),
        range(&particles.charge),
        particles.net_charge()
    ));
    if let Some(filled) = &scene.filled {
        line(format_args!("  from {}", filled.checkpoint.display()));
    }
    for (number, feed) in (0..).zip(&scene.feeds.list) {
        let (mut count, mut mass) = (0, 0.0);
        for k in (0..scene.feeds.due_s.len()).filter(|k| scene.feeds.feed[*k] == number) {
            (count, mass) = (count + 1, mass + scene.feeds.grains.mass(k));
        }
        line(format_args!("feed \"{}\": {count} grains, {mass:.4e} kg, up to the end", feed.name));
    }
    for outlet in &scene.outlets {
        line(format_args!("outlet \"{}\": {}", outlet.name, place_of(&outlet.region)));
    }
    line(format_args!("walls: {}, materials: {}", scene.walls.len(), scene.materials.len()));
    for wall in plan_text::walls(scene) {
        line(format_args!("  {wall}"));
    }
    if let Some(domain) = &scene.domain {
        let (min, max) = (domain.min(), domain.max());
        line(format_args!("domain: {:?} to {:?} m; {}", min.as_slice(), max.as_slice(), faces(domain)));
    }
}

/// Text of where an outlet is.
fn place_of(region: &OutletRegion) -> String {
    match region {
        OutletRegion::Face(axis, side) => format!("face {}", axis.face_name(*side)),
        OutletRegion::Volume(volume) => {
            let [low, high] = volume.bounds();
            format!("within {:?} to {:?} m, {:.4e} m³", low.as_slice(), high.as_slice(), volume.size())
        }
    }
}

/// Text of the boundary conditions.
fn faces(domain: &Domain) -> String {
    let name = |face: Boundary| match face {
        Boundary::Grounded => "grounded".to_owned(),
        Boundary::Potential(volts) => format!("at {volts} V"),
        Boundary::Insulating { normal_field_v_m: 0.0 } => "insulating".to_owned(),
        Boundary::Insulating { normal_field_v_m } => format!("normal field {normal_field_v_m} V/m"),
        Boundary::Periodic => "periodic".to_owned(),
        Boundary::Open => "open".to_owned(),
        other => format!("{other:?}"),
    };
    let axes = Axis::ALL.map(|axis| {
        let [low, high] = [Side::Min, Side::Max].map(|side| {
            let course = domain.courses().iter().find(|face| face.axis == axis && face.side == side);
            course.map_or_else(|| name(domain.face(axis, side)), |face| potential(&face.course))
        });
        if low == high { format!("{axis} {low}") } else { format!("{axis} {low} / {high}") }
    });
    axes.join(", ")
}

/// Text of a potential that changes with time.
fn potential(course: &PotentialCourse) -> String {
    match course {
        Course::Sine { amplitude, frequency_hz, phase, offset } => {
            format!("at {amplitude} V sin(2π {frequency_hz} Hz t + {phase}) + {offset} V")
        }
        Course::Table { name, rows } => format!("at the potential of {name}, {} rows", rows.len()),
        other => format!("{other:?}"),
    }
}

/// Prints the settings of the electric field in both of their forms.
fn print_settings(field: &ElectricFieldSettings) {
    line(format_args!("\nelectric field as keys:\n{}", field.as_section()));
    match field.as_command() {
        Ok(command) => line(format_args!("electric field as one line:\n{command}")),
        Err(reason) => line(format_args!("electric field as one line: not possible, {reason}\n")),
    }
}

/// Prints the plan, the error, the memory and the step of a run.
///
/// Very many grains are not placed for it.
fn explain_run(scene: &mut Scene, solver: SolverConnections) -> Result<(), Failure> {
    let setup = setup_of(scene, None, solver)?;
    if setup.particles.len() > MANY
        && scene.filled.is_none()
        && let Some(outlook) = Outlook::of(&setup).map_err(|error| Failure::of_scene(scene, &error))?
    {
        print_outlook(scene, &outlook, None);
        line(format_args!("more than {MANY} grains: overlaps are looked for when the run starts"));
        return Ok(());
    }
    let simulation = begin(scene, setup)?;
    print_outlook(scene, &simulation.outlook(), simulation.field());
    Ok(())
}

/// Prints the plan, the error, the memory and the step.
fn print_outlook(scene: &Scene, outlook: &Outlook, field: Option<&ElectricField>) {
    for text in plan_text::lines(&outlook.plan) {
        line(format_args!("{text}"));
    }
    for limit in limits::lines(scene) {
        line(format_args!("limit of the model: {limit}"));
    }
    if let Some(field) = field {
        print_error(scene, field);
    }
    print_memory(outlook.grains * BYTES_PER_MOVING_GRAIN, field);
    let end_s = scene.time.as_ref().map_or(0.0, |time| time.end_s);
    let steps = (end_s / outlook.step_s).ceil();
    line(format_args!(
        "time step: {:e} s, {steps:.0} steps to {end_s} s; neighbour skin {:e} m",
        outlook.step_s, outlook.skin_m
    ));
    if let Some(text) = plan_text::duration(outlook.grains, steps) {
        line(format_args!("warning: {text}"));
    }
    if outlook.grains > 0 || !scene.feeds.is_empty() {
        line(format_args!("{}", plan_text::restitution(scene, outlook)));
    }
    line(format_args!("limits on the time step now:"));
    for guard in &outlook.guards {
        if guard.limit_s.is_finite() {
            line(format_args!(
                "  {:14}  {:.4e} s, {:.1} times the step",
                guard.name, guard.limit_s, guard.margin
            ));
        } else {
            line(format_args!("  {:14}  none", guard.name));
        }
    }
}

/// Prints the plan, the error and the memory of a field without motion.
fn explain_field(scene: &Scene, solver: Option<Connect>) -> Result<(), Failure> {
    let Some(settings) = &scene.electric_field else {
        line(format_args!("nothing to compute: the scene has neither [time] nor [electric_field]"));
        return Ok(());
    };
    let domain = domain_of(scene)?;
    let Charges { position, charge, .. } = charges_of(scene);
    let field = field_of(domain, &settings.field, solver, &position, &charge)?;
    for text in plan_text::lines(&field.plan()) {
        line(format_args!("{text}"));
    }
    print_error(scene, &field);
    print_memory(position.len() * 4 * size_of::<f64>(), Some(&field));
    Ok(())
}

/// Prints the estimated and the measured error of the field.
fn print_error(scene: &Scene, field: &ElectricField) {
    let tolerance = scene.electric_field.as_ref().map_or(0.0, |settings| settings.field.tolerance);
    let measured = field.error_measured().map(|measured| measured.relative_rms);
    let stated: Vec<String> = [(field.error_estimated(), "estimated"), (measured, "measured")]
        .into_iter()
        .filter_map(|(error, how)| Some(format!("{:.2e} {how}", error?)))
        .collect();
    let stated = if stated.is_empty() { "none beyond round-off".to_owned() } else { stated.join(", ") };
    line(format_args!("relative error of E: {stated}, tolerance {tolerance:e}"));
}

/// Prints the memory for the grains [bytes] and for the field.
fn print_memory(grains: usize, field: Option<&ElectricField>) {
    let field = field.map_or(0, ElectricField::memory_bytes);
    line(format_args!(
        "memory: about {} for the grains, {} for the field",
        machine::bytes(grains as u64),
        machine::bytes(field as u64)
    ));
}
