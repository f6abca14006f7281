//! Checks of feeds before a run: whether all that they bring can come.

use super::cross_section;
use super::places::{Places, Random};
use crate::error::{DemError, SceneKey};
use crate::outlets::Outlets;
use crate::setup::Setup;
use amberfield_core::{Feed, FeedRegion, TriangleMesh};
use std::f64::consts::PI;

/// Largest share of a region's volume that grains fill which come one after another.
const FILLS: f64 = 0.6;
/// Smallest share of a face's area that grains see which come through it along their velocity: 6° off it.
const SLANT: f64 = 0.1;
/// Places that are tried to find out whether a grain fits through a face, and whether outlets take it.
const TRIES: u64 = 10_000;

/// Feed with its number, for messages.
#[derive(Clone, Copy)]
struct Checked<'a> {
    feed: &'a Feed,
    number: usize,
}

impl Checked<'_> {
    /// Error about a key of the feed.
    fn bad(self, names: &'static [&'static str], problem: &str) -> DemError {
        let key = SceneKey { section: "feeds", number: self.number, names };
        key.refuse(format!("feed \"{}\": {problem}", self.feed.name))
    }
}

/// Checks the feeds of a merged set-up.
pub(crate) fn check(setup: &Setup) -> Result<(), DemError> {
    let feeds = &setup.feeds;
    let (count, total) = (feeds.due_s.len(), setup.particles.len());
    let fits = feeds.feed.len() == count
        && count <= total
        && feeds.due_s.is_sorted()
        && feeds.feed.iter().all(|feed| usize::from(*feed) < feeds.list.len());
    if !fits {
        return Err(DemError::Setup(format!(
            "{count} grains of feeds, of {total} grains in all, do not fit together; give each its feed and \
             its time, in their order"
        )));
    }
    for (number, feed) in feeds.list.iter().enumerate() {
        let is_own = |k: &usize| usize::from(feeds.feed[*k]) == number;
        let grains = || (0..count).filter(is_own).map(|k| (total - count + k, k));
        let checked = Checked { feed, number };
        check_region(checked, setup)?;
        let radius = |grain: usize| setup.particles.radius[grain];
        let largest = grains().map(|(grain, _)| radius(grain)).fold(0.0, f64::max);
        check_size(checked, largest)?;
        check_outlets(checked, setup)?;
        let Some(((_, first), (last, end))) = grains().next().zip(grains().next_back()) else { continue };
        let volume = |grain: usize| 4.0 / 3.0 * PI * radius(grain).powi(3);
        let brought: f64 = grains().filter(|(grain, _)| *grain != last).map(|(grain, _)| volume(grain)).sum();
        let time_s = feeds.due_s[end] - feeds.due_s[first];
        if time_s > 0.0 {
            check_rate(checked, brought / time_s, setup)?;
        }
    }
    Ok(())
}

/// Refuses a region that reaches out of the box, and a face through which no grain comes.
fn check_region(checked: Checked<'_>, setup: &Setup) -> Result<(), DemError> {
    let region = &checked.feed.region;
    let Some(bounds) = region.bounds() else {
        return Err(checked.bad(&["region"], "its face has no triangles; give it a surface"));
    };
    if let Some(overrun) = setup.domain.overrun(&bounds) {
        let problem = format!("its region {overrun}; shrink the region or enlarge the domain");
        return Err(checked.bad(&["region"], &problem));
    }
    match region {
        FeedRegion::Face(mesh) => check_face(checked, mesh),
        FeedRegion::Volume(_) => Ok(()),
    }
}

/// Refuses a velocity that does not lead through a face.
fn check_face(checked: Checked<'_>, mesh: &TriangleMesh) -> Result<(), DemError> {
    let bad = |problem: &str| Err(checked.bad(&["velocity_m_s"], problem));
    let Some(direction) = checked.feed.velocity.try_normalize(0.0) else {
        return bad(
            "velocity_m_s is zero, and grains come through a face with their velocity; give one, into the \
             domain",
        );
    };
    let areas = mesh.triangles.iter().map(|corners| {
        let [a, b, c] = corners.map(|corner| mesh.vertices[corner as usize]);
        (b - a).cross(&(c - a)) * 0.5
    });
    let (whole, across) = areas
        .fold((0.0, 0.0), |(whole, across), area| (whole + area.norm(), across + area.dot(&direction).abs()));
    // `!(a >= b)`: a face without an area lets nothing through either.
    let leads_through = across >= SLANT * whole && whole > 0.0;
    if leads_through {
        return Ok(());
    }
    bad(&format!(
        "velocity_m_s leads along its face, {:.1}° off it, and grains come through a face with their \
         velocity; turn it to {:.0}° from the face at least",
        (across / whole).asin().to_degrees(),
        SLANT.asin().to_degrees().ceil()
    ))
}

/// Refuses a feed whose grains would leave where they come.
fn check_outlets(checked: Checked<'_>, setup: &Setup) -> Result<(), DemError> {
    let Some(outlets) = Outlets::new(&setup.outlets) else { return Ok(()) };
    let places = Places::of(checked.feed);
    let mut random = Random::new([checked.feed.seed, 0, 0]);
    for _ in 0..TRIES {
        let place = places.draw(0.0, &mut random);
        if let Some(number) = place.and_then(|place| outlets.holding(&setup.domain, place)) {
            let problem = format!(
                "outlet \"{}\" reaches into its region, and would take its grains at once; move one of them",
                setup.outlets[usize::from(number)].name
            );
            return Err(checked.bad(&["region"], &problem));
        }
    }
    Ok(())
}

/// Refuses a region that the largest grain [m] does not fit into.
fn check_size(checked: Checked<'_>, largest: f64) -> Result<(), DemError> {
    let fits = match &checked.feed.region {
        FeedRegion::Volume(volume) => volume.inner_radius() >= largest,
        FeedRegion::Face(_) => {
            let places = Places::of(checked.feed);
            let mut random = Random::new([checked.feed.seed, 0, 0]);
            (0..TRIES).any(|_| places.draw(largest, &mut random).is_some())
        }
    };
    if fits {
        return Ok(());
    }
    let problem = format!(
        "a grain of radius {largest:e} m does not fit into its region; make the region larger or radius_m \
         smaller"
    );
    Err(checked.bad(&["region"], &problem))
}

/// Refuses a rate [m³/s] that is more than grains can carry out of the region, even if they filled it and
/// left it as fast as they fall.
fn check_rate(checked: Checked<'_>, rate: f64, setup: &Setup) -> Result<(), DemError> {
    let Feed { region, velocity, .. } = checked.feed;
    let gravity = setup.time.gravity_m_s2;
    let direction = [*velocity, gravity].into_iter().find_map(|v| v.try_normalize(0.0));
    let (Some(direction), Some([low, high])) = (direction, region.bounds()) else { return Ok(()) };
    let Some(area) = cross_section(region, &direction) else { return Ok(()) };
    // The field or a gas may drive grains faster.
    if setup.field.is_some() || setup.gas.is_some() {
        return Ok(());
    }
    let fall2 = 2.0 * gravity.norm() * (high - low).norm();
    let speed = (velocity.norm_squared() + fall2).sqrt();
    let most = FILLS * area * speed;
    if rate <= most {
        return Ok(());
    }
    let problem = format!(
        "it brings {rate:.3e} m³/s of grains, more than the {most:.3e} m³/s that its region lets through at \
         {speed:.3e} m/s; make rate_kg_s or rate_per_s smaller, the region larger, or velocity_m_s faster"
    );
    Err(checked.bad(&["rate_kg_s", "rate_per_s"], &problem))
}
