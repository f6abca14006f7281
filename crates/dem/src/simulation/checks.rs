//! Checks of a set-up, and of a state that is to go on with it.

use super::check_motion;
use super::state::State;
use crate::books::Books;
use crate::contacts::Contacts;
use crate::contacts::cells::INDEX_MASK;
use crate::contacts::material_pairs::PairTable;
use crate::contacts::neighbours::Listed;
use crate::error::{DemError, SceneKey};
use crate::feeding;
use crate::motion::grains::Grains;
use crate::outlets;
use crate::setup::Setup;
use amberfield_core::{Axis, Boundary, Material, MaterialPair, Particles, Skin, Step};
use std::cmp::Ordering;

/// `skin_m = "auto"` is this fraction of a small radius (see [`skin`]).
const SKIN_OVER_RADIUS: f64 = 0.2;
/// The small radius of the automatic skin: this fraction of the grains is smaller.
const SKIN_QUANTILE: f64 = 0.1;

fn bad(text: String) -> DemError {
    DemError::Setup(text)
}

/// Checks everything that can be checked without neighbours.
pub(crate) fn check(setup: &Setup) -> Result<(), DemError> {
    check_particles(&setup.particles, setup)?;
    check_fixed(setup)?;
    outlets::check(setup)?;
    feeding::check(setup)?;
    for material in &setup.materials {
        check_material(material)?;
    }
    for pair in &setup.pairs {
        check_pair(pair, setup)?;
    }
    let transfers = setup.field.as_ref().is_some_and(|field| field.transfer.is_some());
    for (number, wall) in setup.walls.iter().enumerate() {
        if wall.material.0 as usize >= setup.materials.len() {
            return Err(bad(format!("wall '{}' has unknown material {}", wall.name, wall.material.0)));
        }
        check_motion::check(wall, &setup.domain, transfers)
            .map_err(|problem| SceneKey { section: "walls", number, names: &["motion"] }.refuse(problem))?;
    }
    let time = &setup.time;
    if let Step::Seconds(step) = time.step
        && !(step.is_finite() && step > 0.0)
    {
        return Err(bad(format!("step_s must be positive and finite, got {step}")));
    }
    if let Skin::Metres(skin) = time.skin
        && !(skin.is_finite() && skin > 0.0)
    {
        return Err(bad(format!("skin_m must be positive and finite, got {skin}")));
    }
    if !time.gravity_m_s2.iter().all(|g| g.is_finite()) {
        return Err(bad("gravity_m_s2 must be finite".to_owned()));
    }
    if let Some(field) = &setup.field
        && field.member.len() != setup.particles.len()
    {
        return Err(bad(format!(
            "field membership is given for {} of {} grains",
            field.member.len(),
            setup.particles.len()
        )));
    }
    Ok(())
}

/// Id that two grains have.
fn used_twice(ids: &[u64]) -> Option<u64> {
    if ids.is_sorted_by(|a, b| a < b) {
        return None;
    }
    let mut ids = ids.to_vec();
    ids.sort_unstable();
    ids.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0])
}

fn check_particles(particles: &Particles, setup: &Setup) -> Result<(), DemError> {
    if particles.len() > INDEX_MASK as usize {
        return Err(bad(format!("{} grains are more than the {INDEX_MASK} that fit", particles.len())));
    }
    if let Some(id) = used_twice(&particles.id) {
        return Err(bad(format!("grain id {id} is used twice; give every grain its own id")));
    }
    for i in 0..particles.len() {
        let grain = particles.grain(i);
        let id = grain.id;
        if !(grain.radius.is_finite() && grain.radius > 0.0) {
            return Err(bad(format!(
                "grain {id}: radius must be positive and finite, got {} m",
                grain.radius
            )));
        }
        if !(grain.density.is_finite() && grain.density > 0.0) {
            return Err(bad(format!(
                "grain {id}: density must be positive and finite, got {} kg/m³",
                grain.density
            )));
        }
        if grain.material.0 as usize >= setup.materials.len() {
            return Err(bad(format!("grain {id} has unknown material {}", grain.material.0)));
        }
        let motion = [grain.velocity, grain.angular_velocity];
        if particles.is_fixed(i) && motion.iter().any(|vector| vector.norm() != 0.0) {
            return Err(bad(format!(
                "grain {id} is in a group that never moves, but has a velocity or an angular velocity; give \
                 it zeros, or take its group out of particles.fixed_groups"
            )));
        }
        if !motion.iter().flatten().chain([&grain.charge]).all(|x| x.is_finite()) {
            return Err(bad(format!("grain {id}: velocity, angular velocity and charge must be finite")));
        }
        if !setup.domain.contains(&grain.position) {
            let p = grain.position;
            return Err(bad(format!("grain {id} is outside the domain at ({}, {}, {}) m", p.x, p.y, p.z)));
        }
    }
    Ok(())
}

/// Checks grains that never move: feeds bring none, no two are at one place, and none is at its own image.
fn check_fixed(setup: &Setup) -> Result<(), DemError> {
    let (particles, domain) = (&setup.particles, &setup.domain);
    if particles.fixed_groups.is_empty() {
        return Ok(());
    }
    let starters = particles.len() - setup.feeds.due_s.len().min(particles.len());
    let mut fixed: Vec<usize> = (0..particles.len()).filter(|&i| particles.is_fixed(i)).collect();
    if let Some(&grain) = fixed.iter().find(|&&grain| grain >= starters) {
        let id = particles.id[grain];
        return Err(bad(format!(
            "grain {id} of a feed is in a group that never moves; give the feed another group"
        )));
    }
    let charged = setup.field.as_ref().filter(|field| field.solver.is_none());
    for &grain in fixed.iter().filter(|&&grain| charged.is_some_and(|field| field.member[grain])) {
        let place = particles.position[grain];
        for axis in Axis::ALL {
            let (k, faces) = (axis.index(), &domain.faces()[axis.index()]);
            let mirrors = |face: &Boundary| face.is_conductor() || face.is_insulating();
            let on = |face: &Boundary, end: f64| mirrors(face) && place[k] == end;
            if on(&faces[0], domain.min()[k]) || on(&faces[1], domain.max()[k]) {
                let id = particles.id[grain];
                return Err(bad(format!(
                    "grain {id} never moves and has its centre on a face along {axis} that mirrors its \
                     charge, where the field has no value; move it off the face"
                )));
            }
        }
    }
    let compare = |a: &usize, b: &usize| {
        let [a, b] = [a, b].map(|grain| particles.position[*grain]);
        (0..3).map(|k| a[k].total_cmp(&b[k])).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    };
    fixed.sort_by(compare);
    // Lists have no pairs of them, so that nobody else would see it.
    let same = fixed.windows(2).find(|pair| particles.position[pair[0]] == particles.position[pair[1]]);
    same.map_or(Ok(()), |pair| {
        let [a, b] = [particles.id[pair[0]], particles.id[pair[1]]];
        Err(DemError::Coincident { id_i: a.min(b), id_j: a.max(b) })
    })
}

fn check_material(material: &Material) -> Result<(), DemError> {
    let name = &material.name;
    let rules = [
        ("young_Pa", material.young_pa, material.young_pa > 0.0, "above 0"),
        ("poisson", material.poisson, material.poisson > -1.0 && material.poisson <= 0.5, "in (-1, 0.5]"),
        (
            "restitution",
            material.restitution,
            material.restitution > 0.0 && material.restitution <= 1.0,
            "in (0, 1]",
        ),
        ("friction", material.friction, material.friction >= 0.0, "0 or more"),
        ("rolling_friction", material.rolling_friction, material.rolling_friction >= 0.0, "0 or more"),
        (
            "surface_energy_J_m2",
            material.surface_energy_j_m2,
            material.surface_energy_j_m2 >= 0.0,
            "0 or more",
        ),
    ];
    for (key, value, holds, range) in rules {
        if !(holds && value.is_finite()) {
            return Err(bad(format!("material '{name}': {key} must be {range}, got {value}")));
        }
    }
    Ok(())
}

fn check_pair(pair: &MaterialPair, setup: &Setup) -> Result<(), DemError> {
    let names = pair.between.map(|id| setup.materials.get(usize::from(id.0)).map(|material| &material.name));
    let [Some(one), Some(other)] = names else {
        let [a, b] = pair.between;
        return Err(bad(format!("the pair of materials {} and {} has an unknown one", a.0, b.0)));
    };
    let [a, b] = pair.between;
    if setup.pairs.iter().filter(|known| known.is_between(a, b)).count() > 1 {
        return Err(bad(format!("the pair of materials '{one}' and '{other}' is given twice; merge them")));
    }
    let zero = |value: f64| value >= 0.0 && value.is_finite();
    let rules = [
        ("restitution", pair.restitution, pair.restitution.is_none_or(|e| e > 0.0 && e <= 1.0), "in (0, 1]"),
        ("friction", pair.friction, pair.friction.is_none_or(zero), "0 or more"),
        ("rolling_friction", pair.rolling_friction, pair.rolling_friction.is_none_or(zero), "0 or more"),
        (
            "surface_energy_J_m2",
            pair.surface_energy_j_m2,
            pair.surface_energy_j_m2.is_none_or(zero),
            "0 or more",
        ),
    ];
    for (key, value, holds, range) in rules {
        if !holds {
            let value = value.unwrap_or(f64::NAN);
            return Err(bad(format!(
                "pair of materials '{one}' and '{other}': {key} must be {range}, got {value}"
            )));
        }
    }
    Ok(())
}

/// The neighbour-list skin [m]. Auto: a fifth of the radius that a tenth of the grains are below; a few large
/// grains among many small ones, or a few small among large, then cost neither long lists nor many rebuilds.
pub(crate) fn skin(setup: &Setup) -> f64 {
    match setup.time.skin {
        Skin::Metres(skin) => skin,
        Skin::Auto => {
            let mut radii = setup.particles.radius.clone();
            if radii.is_empty() {
                return 0.0;
            }
            let k = (SKIN_QUANTILE * (radii.len() - 1) as f64) as usize;
            let (_, radius, _) = radii.select_nth_unstable_by(k, f64::total_cmp);
            SKIN_OVER_RADIUS * *radius
        }
    }
}

/// Periodic axes must hold two of the largest grains with their skins, so that a grain never meets another
/// one through two faces, nor itself.
pub(crate) fn check_periods(setup: &Setup, skin: f64) -> Result<(), DemError> {
    let largest = setup.particles.radius.iter().copied().fold(0.0, f64::max);
    let table = PairTable::new(&setup.materials, &setup.pairs, setup.cohesion);
    let skin = skin + table.longest_stretch(largest);
    for axis in Axis::ALL {
        let length = setup.domain.extent()[axis.index()];
        let needed = 2.0 * (2.0 * largest + skin);
        if setup.domain.is_periodic(axis) && length <= needed {
            return Err(SceneKey::of("domain", &["max_m"]).refuse(format!(
                "the periodic axis {axis} is {length:e} m long; it must exceed {needed:e} m \
                 (two largest diameters and two skins), else a grain meets itself; \
                 enlarge the domain or reduce skin_m"
            )));
        }
    }
    Ok(())
}

/// Grains with the same centre, whose contact has no direction.
pub(crate) fn check_centres(
    grains: &Grains,
    contacts: &Contacts,
    particles: &Particles,
) -> Result<(), DemError> {
    let id = |i: usize| particles.id[grains.original[i].index()];
    let same = |pair: &Listed| pair.distance(grains, &contacts.neighbours.shifts) == 0.0;
    contacts.neighbours.pairs().find(same).map_or(Ok(()), |pair| {
        let (id_i, id_j) = (id(pair.i).min(id(pair.j)), id(pair.i).max(id(pair.j)));
        Err(DemError::Coincident { id_i, id_j })
    })
}

/// Whether a state belongs to a set-up.
pub(crate) fn check_state(setup: &Setup, state: &State) -> Result<(), DemError> {
    let misfit = |text: &str| Err(DemError::State(text.to_owned()));
    let State { grains, contacts, field, charging, gas, feeding, books, .. } = state;
    if feeding.is_some() == setup.feeds.is_empty() {
        return misfit("its feeds are not those of the scene");
    }
    if books.is_some() != Books::are_kept(setup) {
        return misfit("its books are not those of the scene");
    }
    let count = grains.original.len();
    let total = setup.particles.len();
    let mut seen = vec![false; total];
    for &original in &grains.original {
        let slot = seen.get_mut(original.index());
        if slot.is_none_or(|seen| std::mem::replace(seen, true)) {
            let text = format!("grain {} of {total} is unknown or named twice", original.index());
            return Err(DemError::State(text));
        }
    }
    let transfers = setup.field.as_ref().is_some_and(|field| field.transfer.is_some());
    if charging.as_ref().map(|charging| charging.charge.len()) != transfers.then_some(total) {
        return misfit("its charging does not match the scene's");
    }
    let lengths = [
        grains.centre.len(),
        grains.velocity.len(),
        grains.angular.len(),
        grains.force.len(),
        grains.slowing.len(),
    ];
    if lengths.iter().any(|&n| n != count) || contacts.reference.len() != count {
        return misfit("its arrays differ in length");
    }
    let rotation = PairTable::new(&setup.materials, &setup.pairs, setup.cohesion).features().rotation();
    if grains.torque.len() != if rotation { count } else { 0 } {
        return misfit("its torques do not match the materials' friction");
    }
    let flows = setup.gas.as_ref().is_some_and(|gas| gas.gas.flow.is_some());
    if gas.is_some() != flows || gas.as_ref().is_some_and(|gas| !gas.fits(count)) {
        return misfit("its gas does not match the scene's");
    }
    if field.as_ref().is_some_and(|f| !f.fits(count)) {
        return misfit("its field forces differ in length");
    }
    Ok(())
}
