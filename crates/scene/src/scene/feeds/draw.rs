//! Draw of all the grains that feeds bring, one after another: a run that ends later has the same ones, and
//! more.

use super::{Charges, FeedSpec, Rate};
use crate::SceneError;
use crate::generate::{ChargeStream, RadiusStream};
use amberfield_core::{Feeds, Grain, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use std::f64::consts::PI;

/// Largest number of grains that all feeds bring.
const MOST_GRAINS: usize = 20_000_000;
/// Standard deviations beyond which a velocity is drawn again.
const CUT: f64 = 3.0;

/// Stream of random numbers for radii. Each quantity has its own, so that another distribution of charges
/// leaves the sizes as they are.
const RADII: u64 = 1;
/// Stream of random numbers for charges.
const CHARGES: u64 = 2;
/// Stream of random numbers for velocities.
const VELOCITIES: u64 = 3;

/// Grain of a feed with the time at which it is due.
struct Due {
    due_s: f64,
    feed: u16,
    grain: Grain,
}

/// Draws the grains of all feeds; their ids go on from the first.
pub(super) fn draw(specs: Vec<FeedSpec>, first_id: u64) -> Result<Feeds, SceneError> {
    let mut all: Vec<Due> = Vec::new();
    for (number, spec) in specs.iter().enumerate() {
        let refused = |problem: String| SceneError::Feed {
            place: spec.place.clone(),
            name: spec.feed.name.clone(),
            problem,
        };
        let number =
            u16::try_from(number).map_err(|_| refused("more than 65536 feeds; merge some".to_owned()))?;
        let before = all.len();
        draw_one(spec, number, &mut all).map_err(refused)?;
        if all.len() == before {
            let problem = "it brings no grain before it ends; give it a larger rate or a later end";
            return Err(refused(problem.to_owned()));
        }
    }
    // A stable sort: grains that are due at once keep the order of their feeds.
    all.sort_by(|a, b| a.due_s.total_cmp(&b.due_s));
    let mut feeds = Feeds::default();
    for (k, mut due) in all.into_iter().enumerate() {
        due.grain.id = first_id.saturating_add(k as u64);
        feeds.grains.push(due.grain);
        feeds.due_s.push(due.due_s);
        feeds.feed.push(due.feed);
    }
    feeds.list = specs.into_iter().map(|spec| spec.feed).collect();
    Ok(feeds)
}

/// Draws the grains of a feed. Each is due when what came before it has passed at the feed's rate.
fn draw_one(spec: &FeedSpec, feed: u16, all: &mut Vec<Due>) -> Result<(), String> {
    let stream = |stream: u64| {
        let mut random = ChaCha8Rng::seed_from_u64(spec.feed.seed);
        random.set_stream(stream);
        random
    };
    let mut radii = RadiusStream::new(spec.radii.clone(), stream(RADII));
    let (per_mass, charges) = match &spec.charges {
        Charges::Whole(charges) => (false, charges),
        Charges::PerMass(charges) => (true, charges),
    };
    let mut charges = ChargeStream::new(charges.clone(), stream(CHARGES));
    let mut velocities = stream(VELOCITIES);
    let spread = Normal::new(0.0, spec.spread).map_err(|error| error.to_string())?;
    let place = spec.feed.region.bounds().map_or_else(Vector3::zeros, |[low, high]| (low + high) * 0.5);
    let (mut brought, mut number) = (0.0, 0_usize);
    while number < spec.count && brought < spec.total_kg {
        #[expect(clippy::cast_precision_loss, reason = "feeds bring far fewer than 2^53 grains")]
        let due_s = spec.start_s
            + match spec.rate {
                Rate::Mass(rate) => brought / rate,
                Rate::Number(rate) => number as f64 / rate,
            };
        if due_s >= spec.end_s {
            break;
        }
        if all.len() == MOST_GRAINS {
            return Err(format!(
                "more than {MOST_GRAINS} grains come up to t = {due_s:e} s, and all are kept in memory; make \
                 the rate smaller, the grains larger, or end the feed or the run earlier"
            ));
        }
        let radius = radii.next()?;
        let mass = 4.0 / 3.0 * PI * radius.powi(3) * spec.density;
        let charge = charges.next()? * if per_mass { mass } else { 1.0 };
        let mut component = || {
            let drawn = std::iter::repeat_with(|| spread.sample(&mut velocities));
            drawn.take(1000).find(|v: &f64| v.abs() <= CUT * spec.spread).unwrap_or(0.0)
        };
        let velocity = spec.feed.velocity + Vector3::new(component(), component(), component());
        let grain = Grain {
            id: 0,
            position: place,
            velocity,
            angular_velocity: Vector3::zeros(),
            radius,
            density: spec.density,
            charge,
            material: spec.material,
            group: spec.group,
        };
        all.push(Due { due_s, feed, grain });
        brought += mass;
        number += 1;
    }
    Ok(())
}
