//! Limits of the model that a scene runs into, as `docs/equations.md` lists them.

use amberfield_core::{Boundary, ConductorState, Step, WallCharging};
use amberfield_scene::Scene;

/// Lines about the limits of the model that bear on a scene; none without charge transfer.
pub(crate) fn lines(scene: &Scene) -> Vec<String> {
    if scene.time.is_none() || !trades(scene) {
        return Vec::new();
    }
    let mut found = vec![
        "charge moves while contacts grow, never at rest: grains and walls that conduct within the run do \
         not relax, and an insulator keeps its charge where it was left"
            .to_owned(),
    ];
    if is_of_one_work_function(scene) && has_sizes(scene) {
        found.push(
            "every work function is the same: grains of different size do not charge each other, and without \
             a charge or a field at the start nothing does"
                .to_owned(),
        );
    }
    if has_given_field(scene) && scene.walls.iter().any(|wall| wall.charging == WallCharging::Grounded) {
        found.push(
            "a field is given at grounded walls: there the model charges a grain up to 3/π² = 0.30 of what a \
             conducting sphere has that touches the wall, and grains do not polarise"
                .to_owned(),
        );
    }
    if scene.charge_transfer.as_ref().is_none_or(|settings| settings.breakdown_field_v_m.is_none()) {
        found.push(
            "no breakdown: charges may grow beyond what air bears; set charge_transfer.breakdown_field_V_m = \
             3e6 for air"
                .to_owned(),
        );
    }
    found.extend(of_step(scene));
    found
}

/// Line about charges that an automatic step does not know; `None` where it knows all.
pub(crate) fn of_step(scene: &Scene) -> Option<String> {
    let is_automatic = scene.time.as_ref().is_some_and(|time| time.step == Step::Auto);
    (is_automatic && trades(scene)).then(|| {
        "step_s = \"auto\" fits charges at the start and those that feeds bring; how large contacts make \
         them is not known, and a guard ends the run where they need a shorter step: give time.step_s as a \
         number then"
            .to_owned()
    })
}

/// Whether contacts move charge.
fn trades(scene: &Scene) -> bool {
    scene.electric_field.as_ref().is_some_and(|field| field.enable_collision_charge_transfer)
}

/// Whether no two materials differ in their work function.
fn is_of_one_work_function(scene: &Scene) -> bool {
    scene.materials.windows(2).all(|pair| pair[0].work_function_ev == pair[1].work_function_ev)
}

/// Whether grains differ in size.
fn has_sizes(scene: &Scene) -> bool {
    scene.particles.radius.windows(2).any(|pair| pair[0] != pair[1])
}

/// Whether there is a field without charges.
fn has_given_field(scene: &Scene) -> bool {
    let external = scene.electric_field.as_ref().map(|field| field.field.external_field_v_m.norm());
    let has_value = |face: &Boundary| match face {
        Boundary::Potential(volts) => *volts != 0.0,
        Boundary::Insulating { normal_field_v_m } => *normal_field_v_m != 0.0,
        _ => false,
    };
    let changes = scene.electric_field.as_ref().is_some_and(|field| field.field.external_course.is_some())
        || scene.domain.as_ref().is_some_and(|domain| !domain.courses().is_empty());
    let conductors = scene.electric_field.iter().flat_map(|field| &field.field.conductors);
    let has_conductor = conductors.into_iter().any(|conductor| match conductor.state {
        ConductorState::Potential(given) | ConductorState::Charge(given) => given != 0.0,
    });
    changes
        || has_conductor
        || external.is_some_and(|external| external > 0.0)
        || scene.domain.as_ref().is_some_and(|domain| domain.faces().iter().flatten().any(has_value))
}
