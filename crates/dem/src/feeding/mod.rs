//! Grains that come while a run goes on.
//!
//! All grains of all feeds are known before the run: they have their index in the set-up's arrays, like a
//! grain that has left. Every few steps those that are due enter, each feed's one after another, where they
//! touch neither a grain nor a wall. A grain that finds no place waits, and its feed with it, so that sizes
//! keep their shares.

mod checks;
mod places;
mod room;

pub(crate) use checks::check;

use crate::books::Tally;
use crate::contacts::Contacts;
use crate::error::DemError;
use crate::motion::grains::{Grains, Newcomer};
use crate::setup::Setup;
use amberfield_core::{Axis, Domain, Feed, FeedRegion, Feeds, OnBlocked, Particles, Vector3, Volume};
use places::{Places, Random};
use room::Room;
use serde::{Deserialize, Serialize};

/// Steps from one look at what is due to the next: lists are built anew where grains have come.
const EVERY: u64 = 10;
/// Random places that are tried for a grain before those of a lattice.
const TRIES: u64 = 100;
/// Places of a lattice that are tried.
const MOST_OF_LATTICE: usize = 4096;

/// Account of a feed.
#[derive(Clone, Debug, PartialEq)]
pub struct FeedAccount {
    /// Name.
    pub name: String,
    /// Grains that have come.
    pub fed: Tally,
    /// Grains that were due and have found no place.
    pub owed: Tally,
}

/// Energies that grains brought when they came [J].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Brought {
    /// Kinetic energy [J].
    pub kinetic: f64,
    /// Energy −Σ m g·x where they came [J].
    pub gravity: f64,
    /// Electric energy, by the charges and fields that were there [J].
    pub electric: f64,
    /// Charge [C].
    pub charge: f64,
}

/// State of the feeds, for checkpoints.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct FeedingState {
    /// Grains that have come, by feed.
    pub(crate) by_feed: Vec<Tally>,
    /// Grains that were due when looked at last and found no place, by feed.
    owed: Vec<Tally>,
    pub(crate) brought: Brought,
}

/// A feed and the grains that it brings.
#[derive(Debug)]
struct Queue {
    feed: Feed,
    places: Places,
    /// Indices of its grains in the set-up's order, as they are due.
    grains: Vec<u32>,
    /// Whether the log was told that it is blocked.
    told: bool,
}

/// The feeds of a scene.
#[derive(Debug)]
pub(crate) struct Feeding {
    /// Number of grains at the start, after which those of the feeds follow.
    pub(crate) starters: usize,
    queues: Vec<Queue>,
    /// Time at which each grain of the feeds is due [s].
    due_s: Vec<f64>,
    /// Level of the cells of each grain of the feeds.
    level: Vec<u8>,
    /// Largest radius of all grains [m].
    largest: f64,
    pub(crate) state: FeedingState,
}

/// Things that a search for places reads.
pub(crate) struct Surroundings<'a> {
    pub(crate) domain: &'a Domain,
    pub(crate) particles: &'a Particles,
    pub(crate) grains: &'a Grains,
    pub(crate) contacts: &'a Contacts,
    pub(crate) gravity: Vector3<f64>,
    /// Skin of the neighbour lists, and bound on any grain's way since they were built [m].
    pub(crate) skin_m: f64,
    pub(crate) travel_m: f64,
    /// Number of the step in progress, and its length [s].
    pub(crate) step_index: u64,
    pub(crate) step_s: f64,
}

/// Appends the grains of the feeds to those of a set-up, with places that only stand for where they may be:
/// all over the box, or in their regions where a solver's mesh has a shape of its own.
pub(crate) fn merge(setup: &mut Setup) {
    if setup.feeds.is_empty() {
        return;
    }
    let is_over_mesh = setup.field.as_ref().is_some_and(|field| field.solver.is_some());
    let feeds = &mut setup.feeds;
    for (k, feed) in (0_u64..).zip(&feeds.feed) {
        let region = feeds.list.get(usize::from(*feed)).and_then(|feed| feed.region.bounds());
        let whole = [setup.domain.min(), setup.domain.max()];
        let [low, high] = if is_over_mesh { region.unwrap_or(whole) } else { whole };
        feeds.grains.position[k as usize] = low + places::scattered(k).component_mul(&(high - low));
    }
    setup.particles.append(&setup.feeds.grains);
    setup.feeds.grains = Particles::default();
}

impl Feeding {
    /// Takes the feeds of a merged set-up; `level` is that of the cells of all its grains. `None` without
    /// feeds.
    pub(crate) fn new(feeds: Feeds, particles: &Particles, level: &[u8]) -> Option<Self> {
        if feeds.is_empty() {
            return None;
        }
        let Feeds { list, due_s, feed, .. } = feeds;
        let starters = particles.len() - due_s.len();
        let queues: Vec<Queue> = (0..)
            .zip(list)
            .map(|(number, of)| Queue {
                places: Places::of(&of),
                grains: (0..)
                    .zip(&feed)
                    .filter(|(_, f)| **f == number)
                    .map(|(k, _)| starters as u32 + k)
                    .collect(),
                feed: of,
                told: false,
            })
            .collect();
        let state = FeedingState {
            by_feed: vec![Tally::default(); queues.len()],
            owed: vec![Tally::default(); queues.len()],
            brought: Brought::default(),
        };
        let largest = particles.radius.iter().copied().fold(0.0, f64::max);
        Some(Self { starters, queues, due_s, level: level[starters..].to_vec(), largest, state })
    }

    /// Goes on from a state; `Err` says what does not fit.
    pub(crate) fn restore(&mut self, state: &FeedingState) -> Result<(), String> {
        let counts = [state.by_feed.len(), state.owed.len()] == [self.queues.len(); 2];
        let enough =
            state.by_feed.iter().zip(&self.queues).all(|(fed, of)| fed.grains as usize <= of.grains.len());
        if !(counts && enough) {
            return Err("its feeds are not those of the scene".to_owned());
        }
        self.state.clone_from(state);
        Ok(())
    }

    /// Accounts of the feeds.
    pub(crate) fn accounts(&self) -> impl Iterator<Item = FeedAccount> + '_ {
        let states = self.state.by_feed.iter().zip(&self.state.owed);
        self.queues.iter().zip(states).map(|(of, (fed, owed))| FeedAccount {
            name: of.feed.name.clone(),
            fed: *fed,
            owed: *owed,
        })
    }

    /// Number of feeds, and of all their grains.
    pub(crate) fn size(&self) -> [usize; 2] {
        [self.queues.len(), self.due_s.len()]
    }

    /// Grains that have not come yet, by their index in the set-up's order.
    pub(crate) fn still_to_come(&self) -> impl Iterator<Item = usize> + '_ {
        let fed = self.state.by_feed.iter().map(|fed| fed.grains as usize);
        self.queues.iter().zip(fed).flat_map(|(of, fed)| &of.grains[fed..]).map(|grain| *grain as usize)
    }

    /// Whether a step is one that looks at what is due.
    pub(crate) fn looks_in(&self, step_index: u64) -> bool {
        step_index.wrapping_sub(1).is_multiple_of(EVERY)
    }

    /// Finds places for the grains that are due in a step, and books what is owed. The books of what comes
    /// are made when it does.
    pub(crate) fn newcomers(&mut self, around: &Surroundings<'_>) -> Result<Vec<Newcomer>, DemError> {
        let &Surroundings { step_index, step_s, .. } = around;
        // What is due when the step begins: what a run brings does then not depend on when it ends.
        let until = step_index.saturating_sub(1) as f64 * step_s;
        let mut found = Vec::new();
        for number in 0..self.queues.len() {
            let fed = self.state.by_feed[number].grains as usize;
            let queue = &self.queues[number];
            let is_due = |grain: &&u32| self.due_s[**grain as usize - self.starters] <= until;
            let due = queue.grains[fed..].iter().take_while(is_due).count();
            let entered = if due > 0 { self.enter(number, fed, due, around, &mut found) } else { 0 };
            let mut owed = Tally::default();
            for &grain in &self.queues[number].grains[fed + entered..fed + due] {
                let grain = grain as usize;
                owed.add(around.particles.mass(grain), around.particles.charge[grain]);
            }
            self.state.owed[number] = owed;
            if owed.grains > 0 {
                self.tell(number, fed + entered, &owed, around)?;
            }
        }
        Ok(found)
    }

    /// Finds places for the grains of a feed that are due, after `fed` that have come; how many found one.
    fn enter(
        &self,
        number: usize,
        fed: usize,
        due: usize,
        around: &Surroundings<'_>,
        found: &mut Vec<Newcomer>,
    ) -> usize {
        let &Surroundings {
            domain,
            particles,
            grains,
            contacts,
            gravity,
            skin_m,
            travel_m,
            step_index,
            step_s,
        } = around;
        let Queue { feed, places, grains: queue, .. } = &self.queues[number];
        let Some(bounds) = feed.region.bounds() else { return 0 };
        let clear = contacts.clear(travel_m);
        let mut room = Room::new(domain, bounds, self.largest, clear);
        contacts.loose().for_each(|i| room.add(grains.centre[i]));
        for other in &*found {
            room.add(centre(&other.position, particles.radius[other.original as usize]));
        }
        for (entered, &original) in queue[fed..fed + due].iter().enumerate() {
            let radius = particles.radius[original as usize];
            let end = particles.velocity[original as usize];
            let mut random = Random::new([feed.seed, (fed + entered) as u64, step_index]);
            let is_free = |place: &Vector3<f64>| {
                places.hold(place, radius)
                    && is_inside(domain, place, radius)
                    && room.is_free(place, radius, 0.0)
                    && !contacts.touch(domain, grains, &centre(place, radius), skin_m)
            };
            let is_alone = |place: &Vector3<f64>| {
                room.is_free(place, radius, clear) && contacts.is_alone(domain, &centre(place, radius), clear)
            };
            let mut drawn = (0..TRIES).filter_map(|_| places.draw(radius, &mut random)).filter(is_free);
            let first = drawn.next();
            // Where it is alone lists need not be built anew.
            let best = first.filter(|x| !is_alone(x)).and_then(|_| drawn.find(|x| is_alone(x))).or(first);
            let lattice = || places.lattice(radius).take(MOST_OF_LATTICE).find(is_free);
            let Some(place) = best.or_else(lattice) else { return entered };
            let position = domain.wrap(place);
            let is_alone = is_alone(&position);
            room.add(centre(&position, radius));
            let level = self.level[original as usize - self.starters];
            let middle = end - gravity * (0.5 * step_s);
            found.push(Newcomer { original, level, position, middle, end, is_alone });
        }
        due
    }

    /// Tells once of a feed that finds no place for a grain, or ends the run as the scene says.
    fn tell(
        &mut self,
        number: usize,
        waiting: usize,
        owed: &Tally,
        around: &Surroundings<'_>,
    ) -> Result<(), DemError> {
        let Queue { feed, grains, told, .. } = &mut self.queues[number];
        let id = around.particles.id[grains[waiting] as usize];
        let time_s = around.step_index as f64 * around.step_s;
        if feed.on_blocked == OnBlocked::Stop {
            return Err(DemError::Blocked { feed: feed.name.clone(), id, owed: owed.grains, time_s });
        }
        if !std::mem::replace(told, true) {
            tracing::warn!(
                "feed \"{}\" finds no place for grain {id} at t = {time_s:e} s; it waits, and what is owed \
                 stands in history.csv",
                feed.name
            );
        }
        Ok(())
    }

    /// Books a grain that comes.
    pub(crate) fn book(&mut self, particles: &Particles, newcomer: &Newcomer, gravity: Vector3<f64>) {
        let original = newcomer.original as usize;
        let (mass, charge) = (particles.mass(original), particles.charge[original]);
        let number = self.queues.iter().position(|of| of.grains.binary_search(&newcomer.original).is_ok());
        self.state.by_feed[number.expect("every grain is of a feed")].add(mass, charge);
        let brought = &mut self.state.brought;
        brought.kinetic += 0.5 * mass * newcomer.end.norm_squared();
        brought.gravity -= mass * gravity.dot(&newcomer.position);
        brought.charge += charge;
    }
}

/// Centre and radius [m] of a grain at a place [m].
fn centre(place: &Vector3<f64>, radius: f64) -> [f64; 4] {
    [place.x, place.y, place.z, radius]
}

/// Whether a grain of a radius [m] at a place [m] is inside the box as a whole.
fn is_inside(domain: &Domain, place: &Vector3<f64>, radius: f64) -> bool {
    let (min, max) = (domain.min(), domain.max());
    Axis::ALL.into_iter().all(|axis| {
        let k = axis.index();
        domain.is_periodic(axis) || (place[k] - radius >= min[k] && place[k] + radius <= max[k])
    })
}

/// Largest cross-section of a region across a direction [m²]; `None` for a face.
fn cross_section(region: &FeedRegion, direction: &Vector3<f64>) -> Option<f64> {
    match region {
        FeedRegion::Volume(Volume::Box { min, max }) => {
            let [x, y, z] = (max - min).into();
            Some(direction.abs().dot(&Vector3::new(y * z, x * z, x * y)))
        }
        FeedRegion::Volume(Volume::Cylinder { axis, radius, length, .. }) => {
            let along = direction.dot(axis).abs();
            let across = (1.0 - along * along).max(0.0).sqrt();
            Some(along * std::f64::consts::PI * radius * radius + across * 2.0 * radius * length)
        }
        FeedRegion::Face(_) => None,
    }
}
