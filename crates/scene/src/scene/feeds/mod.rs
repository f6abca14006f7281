//! Sections `[[feeds]]`.

mod draw;

use crate::SceneError;
use crate::error::Problems;
use crate::generate::{
    ChargeDistribution, RadiusDistribution, read_charges_of_feed, read_radii, read_volume,
};
use crate::materials::Materials;
use crate::particles::ReadParticles;
use crate::source::SceneSource;
use crate::stl::read_stl;
use crate::table::SceneTable;
use amberfield_core::{
    Feed, FeedRegion, Feeds, Fingerprint, GroupId, MaterialId, OnBlocked, TimeSettings, Vector3,
};
use draw::draw;

/// Feeds of a scene.
#[derive(Debug, Default)]
pub(super) struct ReadFeeds {
    pub(super) feeds: Feeds,
    /// Whether any of them says which charge its grains have.
    pub(super) has_charge: bool,
}

/// Parts of a scene that feeds use.
struct FeedContext<'a> {
    materials: &'a Materials,
    /// Names of the groups, to which feeds add theirs.
    groups: &'a mut Vec<String>,
    /// Groups whose grains never move.
    fixed: &'a [GroupId],
    /// End of the run [s].
    end_s: f64,
    source: &'a mut SceneSource,
}

/// Amount by which a feed's time is counted.
#[derive(Clone, Copy, Debug)]
pub(super) enum Rate {
    /// Mass in a second [kg/s].
    Mass(f64),
    /// Grains in a second [1/s].
    Number(f64),
}

/// Quantity of which a charge is so much.
#[derive(Clone, Debug)]
pub(super) enum Charges {
    /// Charge [C].
    Whole(ChargeDistribution),
    /// Charge over mass [C/kg].
    PerMass(ChargeDistribution),
}

/// Feed as it is read, before its grains are drawn.
#[derive(Clone, Debug)]
pub(super) struct FeedSpec {
    pub(super) feed: Feed,
    pub(super) place: String,
    pub(super) material: MaterialId,
    /// Density of the material [kg/m³].
    pub(super) density: f64,
    pub(super) group: GroupId,
    pub(super) rate: Rate,
    /// Begin and end [s].
    pub(super) start_s: f64,
    pub(super) end_s: f64,
    /// Mass at which it ends [kg]; infinite without one.
    pub(super) total_kg: f64,
    /// Number of grains at which it ends.
    pub(super) count: usize,
    pub(super) radii: RadiusDistribution,
    pub(super) charges: Charges,
    /// Standard deviation of each component of the velocity [m/s].
    pub(super) spread: f64,
}

/// Reads `[[feeds]]` and draws all their grains; none where nothing moves. `read` are the grains at the
/// start, whose groups may become more.
pub(super) fn read_feeds(
    document: &SceneTable<'_>,
    time: Option<&TimeSettings>,
    materials: &Materials,
    read: &mut ReadParticles,
    source: &mut SceneSource,
) -> Result<ReadFeeds, SceneError> {
    let Some(time) = time else { return Ok(ReadFeeds::default()) };
    let first_id = read.particles.id.iter().max().map_or(1, |id| id.saturating_add(1));
    let fixed = &read.particles.fixed_groups[..];
    let mut context = FeedContext { materials, groups: &mut read.groups, fixed, end_s: time.end_s, source };
    let mut problems = Problems::default();
    let mut specs: Vec<FeedSpec> = Vec::new();
    let mut has_charge = false;
    for table in document.tables("feeds")?.into_iter().flatten() {
        let read = table.and_then(|table| {
            has_charge |= table.has("charge_C") || table.has("charge_C_kg");
            let spec = read_feed(&table, &mut context)?;
            if specs.iter().any(|other| other.feed.name == spec.feed.name) {
                return Err(table.bad("name", "another feed has this name; rename one"));
            }
            Ok(spec)
        });
        specs.extend(problems.keep(read));
    }
    problems.finish()?;
    // The order of the file does not matter.
    specs.sort_by(|a, b| a.feed.name.cmp(&b.feed.name));
    Ok(ReadFeeds { feeds: draw(specs, first_id)?, has_charge })
}

fn read_feed(table: &SceneTable<'_>, context: &mut FeedContext<'_>) -> Result<FeedSpec, SceneError> {
    let name = table.text("name")?;
    let name = table.need(name, "name", "give the feed a name, as name = \"hopper\"")?.to_owned();
    let material = context.materials.named_by(table, "material")?;
    let rate = match (table.number("rate_kg_s")?, table.number("rate_per_s")?) {
        (Some(mass), None) => Rate::Mass(mass),
        (None, Some(number)) => Rate::Number(number),
        (Some(_), Some(_)) => {
            return Err(table.bad("rate_per_s", "rate_kg_s is given too; give exactly one of them"));
        }
        (None, None) => {
            return Err(
                table.missing("rate_kg_s", "give rate_kg_s in kg/s, or rate_per_s in grains per second")
            );
        }
    };
    let start_s = table.number("start_s")?.unwrap_or(0.0);
    let end_s = table.number("end_s")?;
    if let Some(end_s) = end_s.filter(|end_s| *end_s <= start_s) {
        return Err(
            table.bad("end_s", format!("{end_s} s is not after start_s = {start_s} s; give a later end"))
        );
    }
    let charges = match (table.has("charge_C"), table.has("charge_C_kg")) {
        (true, true) => {
            return Err(table.bad("charge_C_kg", "charge_C is given too; give at most one of them"));
        }
        (_, true) => Charges::PerMass(read_charges_of_feed(table, "charge_C_kg")?),
        _ => Charges::Whole(read_charges_of_feed(table, "charge_C")?),
    };
    let velocity = table.vector("velocity_m_s")?.unwrap_or_else(Vector3::zeros);
    let blocked = [("wait", OnBlocked::Wait), ("stop", OnBlocked::Stop)];
    let seed = table.integer("seed")?.unwrap_or(0).unsigned_abs();
    let feed = Feed {
        region: read_feed_region(table, context.source)?,
        velocity,
        on_blocked: table.word("on_blocked", &blocked)?.unwrap_or_default(),
        seed: seed_of(&name, seed),
        name,
    };
    Ok(FeedSpec {
        feed,
        place: table.place().to_string(),
        material,
        density: context.materials.density(material),
        group: group_of(table, context)?,
        rate,
        start_s,
        end_s: end_s.unwrap_or(f64::INFINITY).min(context.end_s),
        total_kg: table.number("total_kg")?.unwrap_or(f64::INFINITY),
        count: table.integer("count")?.map_or(usize::MAX, |count| count.unsigned_abs() as usize),
        radii: read_radii(table, false)?,
        charges,
        spread: table.number("velocity_spread_m_s")?.unwrap_or(0.0),
    })
}

/// Seed of a feed: feeds of other names draw other numbers from the same seed.
fn seed_of(name: &str, seed: u64) -> u64 {
    let mut print = Fingerprint::new();
    print.add(name.as_bytes());
    print.add(&seed.to_le_bytes());
    print.value()
}

/// Group of a feed's grains, which begins to exist where it does not.
fn group_of(table: &SceneTable<'_>, context: &mut FeedContext<'_>) -> Result<GroupId, SceneError> {
    let groups = &mut *context.groups;
    let group = table.text("group")?.unwrap_or("all");
    let index = groups.iter().position(|known| known == group).unwrap_or_else(|| {
        groups.push(group.to_owned());
        groups.len() - 1
    });
    let too_many = |_| table.bad("group", "more than 65536 groups; merge some");
    let id = u16::try_from(index).map(GroupId).map_err(too_many)?;
    if context.fixed.contains(&id) {
        let problem = format!(
            "grains of \"{group}\" never move (particles.fixed_groups), and those of a feed must; give the \
             feed another group"
        );
        return Err(table.bad("group", problem));
    }
    Ok(id)
}

/// Reads the key `region`.
fn read_feed_region(table: &SceneTable<'_>, source: &mut SceneSource) -> Result<FeedRegion, SceneError> {
    let region = table.table("region")?;
    let region = table.need(
        region,
        "region",
        "give { box = { min_m, max_m } }, { cylinder = { base_m, top_m, radius_m } } or \
         { stl = \"face.stl\" }",
    )?;
    let Some(stl) = region.text("stl")? else {
        if region.has("scale") {
            return Err(region.bad("scale", "only an stl has a scale; remove it"));
        }
        return read_volume(table, &region, "box, cylinder, stl").map(FeedRegion::Volume);
    };
    if region.has("box") || region.has("cylinder") {
        return Err(region.bad("stl", "the region has another shape too; give one of box, cylinder, stl"));
    }
    let scale = region.number("scale")?.unwrap_or(1.0);
    let bytes = source.read_file(&region, "stl", stl)?;
    Ok(FeedRegion::Face(read_stl(stl, &bytes, scale)?.mesh))
}
