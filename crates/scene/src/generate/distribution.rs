//! Distributions of radii and charges.

use super::spec::GenerateContext;
use crate::SceneError;
use crate::limits::{CHARGE, RADIUS, RADIUS_OR_POINT};
use crate::particles::read_charges;
use crate::tree::{Node, Range, SceneTable, Value};
use rand::RngExt;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, LogNormal, Normal};

/// Number of standard deviations beyond which normal and log-normal radii are drawn again.
const CLIP_DEVIATIONS: f64 = 3.0;
/// Number of draws after which a clipped distribution counts as empty.
const MOST_DRAWS: usize = 10_000;

/// Distribution of radii [m].
#[derive(Clone, Debug, PartialEq)]
pub(super) enum RadiusDistribution {
    Constant(f64),
    Uniform(Limits),
    Normal { mean: f64, std: f64, limits: Limits },
    LogNormal { median: f64, sigma: f64, limits: Limits },
    Sizes { radii: Vec<f64>, fractions: Vec<f64> },
}

/// Smallest and largest value of a distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limits {
    min: f64,
    max: f64,
}

/// Distribution of charges [C].
#[derive(Clone, Debug, PartialEq)]
pub(super) enum ChargeDistribution {
    Constant(f64),
    Uniform(Limits),
    Normal {
        mean: f64,
        std: f64,
    },
    /// Charges +q and −q in equal number.
    Bipolar(f64),
    List(Vec<f64>),
}

/// Only key of a distribution's table.
fn single<'a>(table: &SceneTable<'_>, node: &'a Node, forms: &str) -> Result<&'a str, SceneError> {
    match &node.value {
        Value::Table(entries) if entries.len() == 1 => Ok(&entries[0].0),
        _ => Err(table.missing("constant", format!("give exactly one of {forms}"))),
    }
}

/// Reads the numbers `min` and `max`, which must be in order.
fn min_max(table: &SceneTable<'_>, range: Range) -> Result<Limits, SceneError> {
    let (min, max) = (table.need_number("min", range)?, table.need_number("max", range)?);
    if max < min {
        Err(table.bad("max", format!("below min = {min}; exchange them")))
    } else {
        Ok(Limits { min, max })
    }
}

/// Reads the key `radius_m`.
pub(super) fn read_radii(
    parent: &SceneTable<'_>,
    allow_points: bool,
) -> Result<RadiusDistribution, SceneError> {
    let key = "radius_m";
    let range = if allow_points { RADIUS_OR_POINT } else { RADIUS };
    let Some(node) = parent.get(key) else {
        return Err(parent.missing(key, "give a radius in metres or a distribution"));
    };
    if !matches!(node.value, Value::Table(_)) {
        return parent.need_number(key, range).map(RadiusDistribution::Constant);
    }
    let forms = ["constant", "uniform", "normal", "log_normal", "sizes"];
    let table = SceneTable::new(node, parent.key(key), &forms)?;
    match single(&table, node, &forms.join(", "))? {
        "constant" => table.need_number("constant", range).map(RadiusDistribution::Constant),
        "uniform" => {
            let inner = table.table("uniform", &["min", "max"])?.expect("the key is there");
            Ok(RadiusDistribution::Uniform(min_max(&inner, range)?))
        }
        "normal" => {
            let inner = table.table("normal", &["mean", "std", "min", "max"])?.expect("the key is there");
            let mean = inner.need_number("mean", RADIUS)?;
            let std = inner.need_number("std", RADIUS_OR_POINT)?;
            // A wide spread must not lead to radii near or below zero.
            let usual_min = (mean - CLIP_DEVIATIONS * std).max(mean / 10.0);
            let min = inner.number("min", RADIUS)?.unwrap_or(usual_min);
            let max = inner.number("max", RADIUS)?.unwrap_or(mean + CLIP_DEVIATIONS * std);
            let limits = Limits { min, max };
            check_limits(&inner, mean, limits)?;
            Ok(RadiusDistribution::Normal { mean, std, limits })
        }
        "log_normal" => {
            let inner =
                table.table("log_normal", &["median", "sigma", "min", "max"])?.expect("the key is there");
            let median = inner.need_number("median", RADIUS)?;
            let sigma = inner.need_number("sigma", Range::closed(0.0, 5.0))?;
            let spread = (CLIP_DEVIATIONS * sigma).exp();
            let min = inner.number("min", RADIUS)?.unwrap_or(median / spread);
            let max = inner.number("max", RADIUS)?.unwrap_or(median * spread);
            let limits = Limits { min, max };
            check_limits(&inner, median, limits)?;
            Ok(RadiusDistribution::LogNormal { median, sigma, limits })
        }
        _ => read_sizes(&table, range),
    }
}

/// Checks that the middle of a distribution lies between its limits.
fn check_limits(table: &SceneTable<'_>, middle: f64, limits: Limits) -> Result<(), SceneError> {
    let Limits { min, max } = limits;
    if min <= middle && middle <= max {
        Ok(())
    } else {
        Err(table.bad("max", format!("the middle {middle} m must lie between min = {min} and max = {max}")))
    }
}

/// Reads radii that are given one by one, with their shares by number.
fn read_sizes(table: &SceneTable<'_>, range: Range) -> Result<RadiusDistribution, SceneError> {
    let inner = table.table("sizes", &["radius_m", "fraction"])?.expect("the key is there");
    let radii = inner.numbers("radius_m", range)?;
    let radii = inner.need(radii, "radius_m", "give the radii, as [1e-4, 2e-4]")?;
    let fractions = inner.numbers("fraction", Range::positive(1e12))?;
    let fractions =
        inner.need(fractions, "fraction", "give the share of each radius by number, as [0.7, 0.3]")?;
    if radii.is_empty() || radii.len() != fractions.len() {
        let problem = format!("{} fractions for {} radii; give one for each", fractions.len(), radii.len());
        return Err(inner.bad("fraction", problem));
    }
    Ok(RadiusDistribution::Sizes { radii, fractions })
}

/// Reads the key `charge_C`.
pub(super) fn read_charges_spec(
    parent: &SceneTable<'_>,
    count: usize,
    context: &mut GenerateContext<'_>,
) -> Result<Option<ChargeDistribution>, SceneError> {
    let key = "charge_C";
    let Some(node) = parent.get(key) else { return Ok(None) };
    if !matches!(node.value, Value::Table(_)) {
        return parent.need_number(key, CHARGE).map(|charge| Some(ChargeDistribution::Constant(charge)));
    }
    let forms = ["constant", "uniform", "normal", "bipolar", "from_file"];
    let table = SceneTable::new(node, parent.key(key), &forms)?;
    let charges = match single(&table, node, &forms.join(", "))? {
        "constant" => ChargeDistribution::Constant(table.need_number("constant", CHARGE)?),
        "uniform" => {
            let inner = table.table("uniform", &["min", "max"])?.expect("the key is there");
            ChargeDistribution::Uniform(min_max(&inner, CHARGE)?)
        }
        "normal" => {
            let inner = table.table("normal", &["mean", "std"])?.expect("the key is there");
            ChargeDistribution::Normal {
                mean: inner.need_number("mean", CHARGE)?,
                std: inner.need_number("std", Range::closed(0.0, 1e6))?,
            }
        }
        "bipolar" => match table.get("bipolar").map(|node| &node.value) {
            Some(Value::Table(_)) => {
                let inner = table.table("bipolar", &["magnitude"])?.expect("the key is there");
                ChargeDistribution::Bipolar(inner.need_number("magnitude", CHARGE)?)
            }
            _ => ChargeDistribution::Bipolar(table.need_number("bipolar", CHARGE)?),
        },
        _ => {
            let file = table.text("from_file")?;
            let file = table.need(file, "from_file", "name a CSV with the column charge_C")?;
            let bytes = context.source.read_file(&table, "from_file", file)?;
            ChargeDistribution::List(read_charges(file, &bytes, count)?)
        }
    };
    Ok(Some(charges))
}

impl RadiusDistribution {
    /// Draws radii [m].
    pub(super) fn draw(&self, count: usize, random: &mut ChaCha8Rng) -> Result<Vec<f64>, String> {
        match self {
            Self::Constant(radius) => Ok(vec![*radius; count]),
            Self::Uniform(Limits { min, max }) => {
                Ok((0..count).map(|_| random.random_range(*min..=*max)).collect())
            }
            Self::Normal { mean, std, limits } => {
                let normal = Normal::new(*mean, *std).map_err(|error| error.to_string())?;
                draw_clipped(&normal, *limits, count, random)
            }
            Self::LogNormal { median, sigma, limits } => {
                let log_normal = LogNormal::new(median.ln(), *sigma).map_err(|error| error.to_string())?;
                draw_clipped(&log_normal, *limits, count, random)
            }
            Self::Sizes { radii, fractions } => Ok(shares(radii, fractions, count, random)),
        }
    }
}

/// Draws numbers, again and again until each lies between the limits.
fn draw_clipped(
    distribution: &impl Distribution<f64>,
    limits: Limits,
    count: usize,
    random: &mut ChaCha8Rng,
) -> Result<Vec<f64>, String> {
    let Limits { min, max } = limits;
    (0..count)
        .map(|_| {
            (0..MOST_DRAWS)
                .map(|_| distribution.sample(random))
                .find(|radius| *radius >= min && *radius <= max)
                // With a spread of zero, rounding may put every draw just outside of limits that coincide.
                .or_else(|| (max - min <= 1e-9 * max).then_some(min))
                .ok_or_else(|| {
                    format!(
                        "no radius of the distribution lies between min = {min} and max = {max}; widen them"
                    )
                })
        })
        .collect()
}

/// Radii in the exact shares by number, in random order.
fn shares(radii: &[f64], fractions: &[f64], count: usize, random: &mut ChaCha8Rng) -> Vec<f64> {
    let total: f64 = fractions.iter().sum();
    let mut drawn = Vec::with_capacity(count);
    let mut cumulated = 0.0;
    for (radius, fraction) in radii.iter().zip(fractions) {
        cumulated += fraction / total;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "counts are at most 1e8"
        )]
        // Rounding the cumulated share keeps each size within one grain of its share.
        let until = ((cumulated * count as f64).round() as usize).min(count);
        drawn.resize(until.max(drawn.len()), *radius);
    }
    drawn.resize(count, radii[radii.len() - 1]);
    drawn.shuffle(random);
    drawn
}

impl ChargeDistribution {
    /// Draws charges [C].
    pub(super) fn draw(&self, count: usize, random: &mut ChaCha8Rng) -> Result<Vec<f64>, String> {
        Ok(match self {
            Self::Constant(charge) => vec![*charge; count],
            Self::Uniform(Limits { min, max }) => {
                (0..count).map(|_| random.random_range(*min..=*max)).collect()
            }
            Self::Normal { mean, std } => {
                let normal = Normal::new(*mean, *std).map_err(|error| error.to_string())?;
                (0..count).map(|_| normal.sample(random)).collect()
            }
            Self::Bipolar(charge) => {
                let mut drawn: Vec<f64> =
                    (0..count).map(|k| if k % 2 == 0 { *charge } else { -charge }).collect();
                drawn.shuffle(random);
                drawn
            }
            Self::List(charges) => charges.clone(),
        })
    }
}
