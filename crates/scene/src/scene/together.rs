//! Checks of sections against each other.

use super::description::{Purpose, Scene};
use super::unusual::unusual_values;
use super::wall_field::{facets_that_misfit, fit_facets, is_conducting_face, leaves};
use crate::SceneError;
use crate::error::{Problems, shorten};
use crate::table::SceneTable;
use crate::tree::nearest;
use amberfield_core::{
    Axis, Boundary, Cohesion, CouplingInterval, Domain, FieldSettings, LEAST_PER_PERIOD, Method, Step, Wall,
    WallCharging,
};

/// Number of grains beyond which the direct sum causes a warning.
const MANY_FOR_DIRECT: usize = 100_000;
/// Largest number of copies of the box within a cut-off; beyond, the near sum costs far more than the direct
/// sum.
const MOST_COPIES: f64 = 1e3;
/// Largest number of nodes of the internal grid that a workstation holds, padding beside open faces included.
const MOST_NODES: f64 = 2e8;

/// Checks what one section alone cannot check, and adds warnings.
pub(super) fn check_together(
    document: &SceneTable<'_>,
    scene: &mut Scene,
    has_charge: bool,
) -> Result<(), SceneError> {
    let mut problems = Problems::default();
    problems.keep(check_field(document, scene, has_charge));
    if let (Some(field), Some(domain)) = (&scene.electric_field, &scene.domain) {
        problems.keep(check_reach(document, domain, &field.field));
    }
    problems.keep(check_courses(document, scene));
    problems.keep(check_charge_transfer(document, scene));
    problems.keep(check_cohesion(document, scene));
    problems.finish()?;
    warn(scene);
    Ok(())
}

/// Checks that sections of which there may be several are lists.
pub(super) fn check_lists(document: &SceneTable<'_>) -> Result<(), SceneError> {
    let mut problems = Problems::default();
    for section in document.known().into_iter().filter(|section| document.entry(section).form.is_list()) {
        problems.keep(document.tables(section).map(drop));
    }
    problems.finish()
}

/// Checks that the sections that the purpose needs are present.
pub(super) fn check_sections(
    document: &SceneTable<'_>,
    motion: bool,
    purpose: Purpose,
) -> Result<(), SceneError> {
    let mut problems = Problems::default();
    let mut need = |section: &str, advice: &str| {
        if !document.has(section) {
            problems.keep::<()>(Err(document.missing(section, advice)));
        }
    };
    if !document.has("solver") {
        need("domain", "add [domain] with min_m, max_m and [domain.boundary]");
    }
    if !(motion && document.has("feeds")) {
        need("particles", "add [particles] with file = \"grains.csv\" or generate = { … }");
    }
    if motion {
        need("time", "add [time] with step_s and end_s; a run needs it");
        need(
            "materials",
            "add [[materials]] with name, density_kg_m3, young_Pa, poisson, restitution, friction",
        );
    }
    if purpose == Purpose::Field {
        need("electric_field", "add [electric_field]; there is no field to compute without it");
    }
    problems.finish()
}

/// Checks that the electric field has charges, a solver where it needs one, and a group that exists.
fn check_field(document: &SceneTable<'_>, scene: &Scene, has_charge: bool) -> Result<(), SceneError> {
    let Some(field) = &scene.electric_field else { return Ok(()) };
    let mut problems = Problems::default();
    if !has_charge {
        let section = if document.has("particles") { "particles" } else { "feeds" };
        problems.keep::<()>(Err(SceneError::Missing {
            place: document.place_of(section).to_string(),
            key: format!("{section}: charge_C"),
            advice: "the scene has an electric field but its grains have no charge; add the column charge_C \
                     to the file, or charge_C to the generator or the feed (0 where they are neutral)"
                .to_owned(),
        }));
    }
    if !field.use_without_cfd_coupling && scene.solver.is_none() {
        problems.keep::<()>(Err(document.bad_below(
            "electric_field",
            "use_without_cfd_coupling",
            "false",
            "the field is not to be computed here, so a field solver must be configured; \
             add [solver] or set use_without_cfd_coupling = true",
        )));
    }
    if !scene.groups.contains(&field.particle_group) {
        let names: Vec<&str> = scene.groups.iter().map(String::as_str).collect();
        let near = nearest(&field.particle_group, &names).unwrap_or("all");
        problems.keep::<()>(Err(document.bad_below(
            "electric_field",
            "particle_group",
            &format!("\"{}\"", shorten(&field.particle_group)),
            format!("no grain is in this group; the nearest group is \"{near}\""),
        )));
    }
    problems.finish()
}

/// Checks that the cut-off and the grid of the scene fit the box.
pub(super) fn check_reach(
    document: &SceneTable<'_>,
    domain: &Domain,
    field: &FieldSettings,
) -> Result<(), SceneError> {
    if field.method == Method::Direct {
        return Ok(());
    }
    let mut problems = Problems::default();
    let cutoff = field.cutoff_radius_m.unwrap_or(0.0);
    if copies_within(domain, field.method, cutoff) > MOST_COPIES {
        problems.keep::<()>(Err(document.bad_below(
            "electric_field",
            "field_cutoff_radius",
            &format!("{cutoff:e}"),
            format!(
                "reaches over {MOST_COPIES} copies of the box; give a radius within a few box lengths, \
                 or method = \"direct\" without a cut-off"
            ),
        )));
    }
    // The grid is doubled along an axis with an open face.
    let padded = |axis: Axis| if domain.faces()[axis.index()].contains(&Boundary::Open) { 2.0 } else { 1.0 };
    let nodes = |cells: [usize; 3]| -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "at most 2^16 cells per axis")]
        Axis::ALL.iter().map(|&axis| cells[axis.index()] as f64 * padded(axis)).product()
    };
    if let Some(cells) = field.grid_cells.filter(|&cells| nodes(cells) > MOST_NODES) {
        problems.keep::<()>(Err(document.bad_below(
            "electric_field",
            "grid",
            &format!("{{ cells = {cells:?} }}"),
            format!(
                "{:e} nodes with the padding beside open faces are more than {MOST_NODES:e}; \
                 take fewer, or \"auto\"",
                nodes(cells)
            ),
        )));
    }
    problems.finish()
}

/// Checks that the method knows potentials that change, and that the step shows them.
fn check_courses(document: &SceneTable<'_>, scene: &Scene) -> Result<(), SceneError> {
    let Some(field) = scene.electric_field.as_ref().map(|field| &field.field) else { return Ok(()) };
    let faces = scene.domain.as_ref().map_or(&[][..], Domain::courses);
    let mut problems = Problems::default();
    if field.method == Method::Kolehmainen && !faces.is_empty() {
        problems.keep::<()>(Err(document.bad_below(
            "electric_field",
            "method",
            "\"kolehmainen\"",
            "it has no potentials that change with time; choose method = \"p3m\", or give potential_V as a \
             number",
        )));
    }
    let changes = field.external_course.is_some() || !faces.is_empty();
    let follows = field.coupling_interval == CouplingInterval::Steps(1);
    if changes && !field.conductors.is_empty() && scene.time.is_some() && !follows {
        let interval = match field.coupling_interval {
            CouplingInterval::Auto => "\"auto\"".to_owned(),
            CouplingInterval::Steps(steps) => steps.to_string(),
        };
        problems.keep::<()>(Err(document.bad_below(
            "electric_field",
            "coupling_interval",
            &interval,
            "walls with a field answer to a potential or external field that changes with time only where \
             the field is evaluated; give coupling_interval = 1, or constants",
        )));
    }
    let longest = field.longest_step_s(faces);
    if let Some(Step::Seconds(step)) = scene.time.as_ref().map(|time| time.step)
        && step > longest
    {
        problems.keep::<()>(Err(document.bad_below(
            "time",
            "step_s",
            &format!("{step:e}"),
            format!(
                "a potential or the external field has a frequency of {:.3e} Hz, and fewer than \
                 {LEAST_PER_PERIOD} steps in a period do not show it; give a step of at most {longest:e} s",
                1.0 / (LEAST_PER_PERIOD * longest)
            ),
        )));
    }
    problems.finish()
}

/// Number of copies of the box within a radius [m]: periodic copies and, for p3m, images in pairs of walls.
fn copies_within(domain: &Domain, method: Method, radius_m: f64) -> f64 {
    let repeats = |axis: &Axis| match method {
        Method::P3m => !domain.faces()[axis.index()].contains(&Boundary::Open),
        _ => domain.faces()[axis.index()].contains(&Boundary::Periodic),
    };
    let copies = |axis: Axis| 1.0 + 2.0 * radius_m / domain.extent()[axis.index()];
    Axis::ALL.into_iter().filter(repeats).map(copies).product()
}

/// Checks that charge transfer is on where it is refined, and that materials have what it needs.
fn check_charge_transfer(document: &SceneTable<'_>, scene: &Scene) -> Result<(), SceneError> {
    let on = scene.electric_field.as_ref().is_some_and(|field| field.enable_collision_charge_transfer);
    if let (Some(_), false) = (&scene.charge_transfer, on) {
        return Err(SceneError::Missing {
            place: document.place_of("charge_transfer").to_string(),
            key: "electric_field.enable_collision_charge_transfer".to_owned(),
            advice: "set it to true, or remove the section [charge_transfer]".to_owned(),
        });
    }
    if !on {
        return Ok(());
    }
    let correction = scene.charge_transfer.as_ref().is_some_and(|transfer| transfer.stiffness_correction);
    for (index, material) in scene.materials.iter().enumerate() {
        let missing = |key: &str, why: &str| SceneError::Missing {
            place: document.place_of("materials").to_string(),
            key: format!("materials[{index}].{key}"),
            advice: format!("material \"{}\" needs it because {why} is on", material.name),
        };
        if material.work_function_ev.is_none() {
            return Err(missing("work_function_eV", "enable_collision_charge_transfer"));
        }
        if correction && material.young_real_pa.is_none() {
            return Err(missing("young_real_Pa", "stiffness_correction"));
        }
    }
    Ok(())
}

/// Checks that something sticks where cohesion is asked for.
fn check_cohesion(document: &SceneTable<'_>, scene: &Scene) -> Result<(), SceneError> {
    if scene.cohesion == Cohesion::None || sticks(scene) || scene.materials.is_empty() {
        return Ok(());
    }
    Err(document.bad_below(
        "contacts",
        "cohesion",
        &format!("\"{}\"", scene.cohesion.name()),
        "no two materials stick; give surface_energy_J_m2 of materials or of [[pairs]]",
    ))
}

/// Whether any material or pair has a surface energy.
fn sticks(scene: &Scene) -> bool {
    scene.materials.iter().any(|material| material.surface_energy_j_m2 > 0.0)
        || scene.pairs.iter().any(|pair| pair.surface_energy_j_m2.is_some_and(|energy| energy > 0.0))
}

/// Adds warnings about keys that have no effect or cost much time, and about unusual values.
fn warn(scene: &mut Scene) {
    let unusual = unusual_values(scene);
    scene.warnings.extend(unusual);
    if scene.cohesion == Cohesion::None && sticks(scene) {
        scene.warnings.push(
            "surface_energy_J_m2 has no effect without contacts.cohesion = \"jkr\" or \"dmt\"".to_owned(),
        );
    }
    let count = scene.particles.len();
    let method = scene.electric_field.as_ref().map(|field| field.field.method);
    if method == Some(Method::Direct) && count > MANY_FOR_DIRECT {
        scene.warnings.push(format!(
            "method direct sums over every pair of {count} grains, which takes long; \
             p3m gives a stated error in a fraction of the time"
        ));
    }
    if scene.solver.is_none() && scene.wall_patches.iter().any(Option::is_some) {
        scene.warnings.push("walls.patch has no effect without [solver]".to_owned());
    }
    if scene.solver.is_none() {
        let patches = scene.walls.iter_mut().zip(&scene.wall_patches);
        patches.filter(|(_, patch)| patch.is_some()).for_each(|(wall, _)| wall.bounds_field = false);
    }
    let far_tolerance = scene.electric_field.as_ref().is_some_and(|field| field.far_tolerance.is_some());
    if scene.solver.is_none() && far_tolerance {
        scene.warnings.push(
            "electric_field.far_tolerance has no effect without [solver]: the internal grid is solved exactly"
                .to_owned(),
        );
    }
    if scene.solver.is_none() && scene.electric_field.as_ref().is_some_and(|field| field.field.overlap) {
        scene.warnings.push(
            "electric_field.overlap has no effect without [solver]: there is no other process to wait for"
                .to_owned(),
        );
    }
    let solved = scene.solver.is_some();
    let moving = scene.walls.iter().filter(|wall| leaves(wall) && solved && wall.bounds_field);
    let moving: Vec<String> = moving.map(|wall| mesh_stays(&wall.name)).collect();
    scene.warnings.extend(moving);
    if method.is_some() {
        let beside = Beside::of(scene);
        let unknown: Vec<String> =
            unknown_grounded_walls(scene).map(|wall| unknown_grounded(&wall.name, beside)).collect();
        scene.warnings.extend(unknown);
    }
    let smallest = scene.smallest_radius();
    if let (Some(settings), Some(radius)) = (&mut scene.electric_field, smallest) {
        let conductors = &mut settings.field.conductors;
        fit_facets(conductors, radius, scene.domain.as_ref());
        scene.warnings.extend(conductors.iter().flat_map(|one| facets_that_misfit(one, radius)));
    }
}

/// Grounded walls at which the field does not end.
fn unknown_grounded_walls(scene: &Scene) -> impl Iterator<Item = &Wall> {
    let is_known = |wall: &Wall| match (&scene.solver, &scene.domain) {
        (Some(_), _) => wall.bounds_field,
        (None, Some(domain)) => {
            wall.bounds_field || (!leaves(wall) && is_conducting_face(domain, &wall.shape))
        }
        (None, None) => false,
    };
    scene.walls.iter().filter(move |wall| wall.charging == WallCharging::Grounded && !is_known(wall))
}

/// Kind of what bounds the field beside a wall that does not.
#[derive(Clone, Copy)]
enum Beside {
    Faces,
    Mesh,
    Conductors,
}

impl Beside {
    fn of(scene: &Scene) -> Self {
        let has_conductors =
            scene.electric_field.as_ref().is_some_and(|field| !field.field.conductors.is_empty());
        match (scene.solver.is_some(), has_conductors) {
            (true, _) => Self::Mesh,
            (false, true) => Self::Conductors,
            (false, false) => Self::Faces,
        }
    }
}

/// Warning about a grounded wall at which the field does not end.
fn unknown_grounded(name: &str, beside: Beside) -> String {
    match beside {
        Beside::Mesh => format!(
            "{name}: the wall takes charge, but is no patch of the solver's mesh: at its contacts all of the \
             field counts twice, that of electrodes too; name its patch with patch = \"…\", or set charging \
             = \"none\""
        ),
        Beside::Conductors => format!(
            "{name}: the wall takes charge, but does not bound the field, while others do: at its contacts \
             the field of charges counts twice, that of the walls with a field too; give it field = \
             \"grounded\" as well, or set charging = \"none\""
        ),
        Beside::Faces => format!(
            "{name}: the internal grid does not know this grounded surface; it takes charge, but does not \
             bound the field: at its contacts the field of charges counts twice, for their images, and \
             fields of electrodes and external ones as they are"
        ),
    }
}

/// Warning about a wall that moves in a mesh that does not.
fn mesh_stays(name: &str) -> String {
    format!(
        "{name}: the wall moves for the grains that touch it, but the solver's mesh stays: field and gas see \
         its patch where the case has it; keep the motion small beside the cells, or let the surface slide \
         with surface_velocity_m_s"
    )
}
