//! Section `particles.generate`.

use super::distribution::{read_charges_spec, read_radii};
use super::fill::fill;
use super::region::read_region;
use crate::SceneError;
use crate::materials::Materials;
use crate::particles::ReadParticles;
use crate::source::SceneSource;
use crate::table::SceneTable;
use amberfield_core::{Domain, Grain, GroupId, Particles, Wall};
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Stream of random numbers for places. Each quantity has its own stream of the one seed, so that another
/// charge distribution leaves the places as they are.
const PLACES: u64 = 0;
/// Stream of random numbers for radii.
const RADII: u64 = 1;
/// Stream of random numbers for charges.
const CHARGES: u64 = 2;

/// Parts of the scene that a generator uses.
pub(crate) struct GenerateContext<'a> {
    /// Box of the scene.
    pub(crate) domain: &'a Domain,
    /// Materials by name.
    pub(crate) materials: &'a Materials,
    /// Walls; grains keep clear of them, and of what lies behind closed ones.
    pub(crate) walls: &'a [Wall],
    /// Reader of the files that the generator names.
    pub(crate) source: &'a mut SceneSource,
}

/// Makes the particles that `particles.generate` describes; their ids are 1 to `count`.
///
/// # Errors
/// Bad keys, and fills that cannot be reached.
pub(crate) fn generate(
    table: &SceneTable<'_>,
    context: &mut GenerateContext<'_>,
) -> Result<ReadParticles, SceneError> {
    let material = context.materials.named_by(table, "material")?;
    let count = table.integer("count")?;
    let count = table.need(count, "count", "give the number of grains")?;
    let count = usize::try_from(count).expect("the range is positive");
    let seed = table.integer("seed")?.unwrap_or(0).unsigned_abs();
    let radii = read_radii(table, context.materials.ignored)?;
    let charges = read_charges_spec(table, count, context)?;
    let region = read_region(table, context)?;
    let velocity = table.vector("velocity_m_s")?.unwrap_or_else(Vector3::zeros);
    let group = table.text("group")?;

    let stream = |stream: u64| {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(stream);
        random
    };
    let refused = |problem: String| SceneError::Fill { place: table.place().to_string(), problem };
    let radii = radii.draw(count, &mut stream(RADII)).map_err(refused)?;
    let charge = match &charges {
        Some(charges) => charges.draw(count, &mut stream(CHARGES)).map_err(refused)?,
        None => vec![0.0; count],
    };
    let centres = fill(&region, &radii, &mut stream(PLACES)).map_err(refused)?;

    let mut groups = vec!["all".to_owned()];
    groups.extend(group.filter(|name| *name != "all").map(ToOwned::to_owned));
    let group = GroupId(if groups.len() == 2 { 1 } else { 0 });
    let density = context.materials.density(material);
    let particles: Particles = (0..count)
        .map(|index| Grain {
            id: index as u64 + 1,
            position: centres[index],
            velocity,
            angular_velocity: Vector3::zeros(),
            radius: radii[index],
            density,
            charge: charge[index],
            material,
            group,
        })
        .collect();
    Ok(ReadParticles { particles, groups, has_charge: charges.is_some() })
}
