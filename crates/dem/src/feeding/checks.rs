//! Checks of feeds before a run: whether all that they bring can come.

use super::cross_section;
use super::places::{Places, Random};
use crate::error::DemError;
use crate::outlets::Outlets;
use crate::setup::Setup;
use amberfield_core::{Feed, FeedRegion};
use std::f64::consts::PI;

/// Largest share of a region's volume that grains fill which come one after another.
const FILLS: f64 = 0.6;
/// Places that are tried to find out whether a grain fits through a face, and whether outlets take it.
const TRIES: u64 = 10_000;

fn bad(text: String) -> DemError {
    DemError::Setup(text)
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
        return Err(bad(format!(
            "{count} grains of feeds, of {total} grains in all, do not fit together; give each its feed and \
             its time, in their order"
        )));
    }
    for (number, feed) in (0..).zip(&feeds.list) {
        let grains = || (0..count).filter(|k| feeds.feed[*k] == number).map(|k| (total - count + k, k));
        check_region(feed, setup)?;
        let radius = |grain: usize| setup.particles.radius[grain];
        let largest = grains().map(|(grain, _)| radius(grain)).fold(0.0, f64::max);
        check_size(feed, largest)?;
        check_outlets(feed, setup)?;
        let Some(((_, first), (last, end))) = grains().next().zip(grains().next_back()) else { continue };
        let volume = |grain: usize| 4.0 / 3.0 * PI * radius(grain).powi(3);
        let brought: f64 = grains().filter(|(grain, _)| *grain != last).map(|(grain, _)| volume(grain)).sum();
        let time_s = feeds.due_s[end] - feeds.due_s[first];
        if time_s > 0.0 {
            check_rate(feed, brought / time_s, setup)?;
        }
    }
    Ok(())
}

/// Refuses a region that reaches out of the box.
fn check_region(feed: &Feed, setup: &Setup) -> Result<(), DemError> {
    let name = &feed.name;
    let Some(bounds) = feed.region.bounds() else {
        return Err(bad(format!("feed \"{name}\": its face has no triangles; give it a surface")));
    };
    if let Some(overrun) = setup.domain.overrun(&bounds) {
        return Err(bad(format!(
            "feed \"{name}\": its region {overrun}; shrink the region or enlarge the domain"
        )));
    }
    if matches!(feed.region, FeedRegion::Face(_)) && feed.velocity.norm() == 0.0 {
        return Err(bad(format!(
            "feed \"{name}\": velocity_m_s is zero, and grains come through a face with their velocity; \
             give one, into the domain"
        )));
    }
    Ok(())
}

/// Refuses a feed whose grains would leave where they come.
fn check_outlets(feed: &Feed, setup: &Setup) -> Result<(), DemError> {
    let Some(outlets) = Outlets::new(&setup.outlets) else { return Ok(()) };
    let places = Places::of(feed);
    let mut random = Random::new([feed.seed, 0, 0]);
    for _ in 0..TRIES {
        let place = places.draw(0.0, &mut random);
        if let Some(number) = place.and_then(|place| outlets.holding(&setup.domain, place)) {
            return Err(bad(format!(
                "feed \"{}\": outlet \"{}\" reaches into its region, and would take its grains at once; \
                 move one of them",
                feed.name,
                setup.outlets[usize::from(number)].name
            )));
        }
    }
    Ok(())
}

/// Refuses a region that the largest grain [m] does not fit into.
fn check_size(feed: &Feed, largest: f64) -> Result<(), DemError> {
    let fits = match &feed.region {
        FeedRegion::Volume(volume) => volume.inner_radius() >= largest,
        FeedRegion::Face(_) => {
            let places = Places::of(feed);
            let mut random = Random::new([feed.seed, 0, 0]);
            (0..TRIES).any(|_| places.draw(largest, &mut random).is_some())
        }
    };
    if fits {
        return Ok(());
    }
    Err(bad(format!(
        "feed \"{}\": a grain of radius {largest:e} m does not fit into its region; make the region \
         larger or radius_m smaller",
        feed.name
    )))
}

/// Refuses a rate [m³/s] that is more than grains can carry out of the region, even if they filled it and
/// left it as fast as they fall.
fn check_rate(feed: &Feed, rate: f64, setup: &Setup) -> Result<(), DemError> {
    let gravity = setup.time.gravity_m_s2;
    let direction = [feed.velocity, gravity].into_iter().find_map(|v| v.try_normalize(0.0));
    let (Some(direction), Some([low, high])) = (direction, feed.region.bounds()) else { return Ok(()) };
    let Some(area) = cross_section(&feed.region, &direction) else { return Ok(()) };
    // The field or a gas may drive grains faster.
    if setup.field.is_some() || setup.gas.is_some() {
        return Ok(());
    }
    let fall2 = 2.0 * gravity.norm() * (high - low).norm();
    let speed = (feed.velocity.norm_squared() + fall2).sqrt();
    let most = FILLS * area * speed;
    if rate <= most {
        return Ok(());
    }
    Err(bad(format!(
        "feed \"{}\": it brings {rate:.3e} m³/s of grains, more than the {most:.3e} m³/s that its region \
         lets through at {speed:.3e} m/s; make rate_kg_s or rate_per_s smaller, the region larger, or \
         velocity_m_s faster",
        feed.name
    )))
}
