//! Checks of a set-up before anything is built from it.

use crate::contacts::cells::{INDEX_BITS, INDEX_MASK};
use crate::contacts::neighbours::Neighbours;
use crate::error::DemError;
use crate::motion::chunks::CHUNK;
use crate::motion::grains::Grains;
use crate::setup::Setup;
use amberfield_core::{Axis, Material, Particles, Skin, Step};
use std::collections::HashSet;

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
    for material in &setup.materials {
        check_material(material)?;
    }
    for wall in &setup.walls {
        if wall.material.0 as usize >= setup.materials.len() {
            return Err(bad(format!("wall '{}' has unknown material {}", wall.name, wall.material.0)));
        }
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

fn check_particles(particles: &Particles, setup: &Setup) -> Result<(), DemError> {
    if particles.len() > INDEX_MASK as usize {
        return Err(bad(format!("{} grains are more than the {INDEX_MASK} that fit", particles.len())));
    }
    let mut ids = HashSet::with_capacity(particles.len());
    for i in 0..particles.len() {
        let grain = particles.grain(i);
        let id = grain.id;
        if !ids.insert(id) {
            return Err(bad(format!("grain id {id} is used twice; give every grain its own id")));
        }
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
    ];
    for (key, value, holds, range) in rules {
        if !(holds && value.is_finite()) {
            return Err(bad(format!("material '{name}': {key} must be {range}, got {value}")));
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
    for axis in Axis::ALL {
        let length = setup.domain.extent()[axis.index()];
        let needed = 2.0 * (2.0 * largest + skin);
        if setup.domain.is_periodic(axis) && length <= needed {
            return Err(bad(format!(
                "the periodic axis {axis} is {length:e} m long; it must exceed {needed:e} m (two largest diameters and two skins), else a grain meets itself; enlarge the domain or reduce skin_m"
            )));
        }
    }
    Ok(())
}

/// Overlaps of grains at the start.
pub(crate) fn check_overlaps(
    grains: &Grains,
    neighbours: &Neighbours,
    particles: &Particles,
    allow_overlap: bool,
) -> Result<(), DemError> {
    for (k, list) in neighbours.lists.iter().enumerate() {
        for local in 0..list.start.len() - 1 {
            let i = k * CHUNK + local;
            for &code in &list.partner[list.start[local] as usize..list.start[local + 1] as usize] {
                let j = (code & INDEX_MASK) as usize;
                let (a, b) = (&grains.centre[i], &grains.centre[j]);
                let shift = neighbours.shifts[(code >> INDEX_BITS) as usize];
                let distance = (0..3).map(|x| (b[x] + shift[x] - a[x]).powi(2)).sum::<f64>().sqrt();
                let id = |k: usize| particles.id[grains.original[k] as usize];
                let (id_i, id_j) = (id(i).min(id(j)), id(i).max(id(j)));
                if distance == 0.0 {
                    return Err(DemError::Coincident { id_i, id_j });
                }
                let (overlap_m, limit_m) = (a[3] + b[3] - distance, 0.5 * a[3].min(b[3]));
                if overlap_m > limit_m && !allow_overlap {
                    return Err(DemError::Overlap { id_i, id_j, overlap_m, limit_m });
                }
            }
        }
    }
    Ok(())
}
