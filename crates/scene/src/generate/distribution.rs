//! Distributions of radii and charges.

use super::spec::GenerateContext;
use crate::SceneError;
use crate::limits::{CHARGE, RADIUS, RADIUS_OR_POINT};
use crate::particles::read_charges;
use crate::table::SceneTable;
use crate::tree::Range;
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
fn single<'a>(table: &SceneTable<'a>) -> Result<&'a str, SceneError> {
    let given: Vec<&str> = table.keys().collect();
    match given[..] {
        [one] => Ok(one),
        _ => Err(table.missing("constant", format!("give exactly one of {}", table.known().join(", ")))),
    }
}

/// Number in a range, which may be narrower than the key's, under a key that is required.
fn need_in(table: &SceneTable<'_>, key: &str, range: Range) -> Result<f64, SceneError> {
    table.number_in(key, range)?.map_or_else(|| table.need_number(key), Ok)
}

/// Reads the numbers `min` and `max`, which must be in order.
fn min_max(table: &SceneTable<'_>, range: Range) -> Result<Limits, SceneError> {
    let (min, max) = (need_in(table, "min", range)?, need_in(table, "max", range)?);
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
    let Some(table) = parent.table(key)? else {
        return need_in(parent, key, range).map(RadiusDistribution::Constant);
    };
    match single(&table)? {
        "constant" => need_in(&table, "constant", range).map(RadiusDistribution::Constant),
        "uniform" => {
            let inner = table.table("uniform")?.expect("the key is there");
            Ok(RadiusDistribution::Uniform(min_max(&inner, range)?))
        }
        "normal" => {
            let inner = table.table("normal")?.expect("the key is there");
            let mean = inner.need_number("mean")?;
            let std = inner.need_number("std")?;
            // A wide spread must not lead to radii near or below zero.
            let usual_min = (mean - CLIP_DEVIATIONS * std).max(mean / 10.0);
            let min = inner.number("min")?.unwrap_or(usual_min);
            let max = inner.number("max")?.unwrap_or(mean + CLIP_DEVIATIONS * std);
            let limits = Limits { min, max };
            check_limits(&inner, mean, limits)?;
            Ok(RadiusDistribution::Normal { mean, std, limits })
        }
        "log_normal" => {
            let inner = table.table("log_normal")?.expect("the key is there");
            let median = inner.need_number("median")?;
            let sigma = inner.need_number("sigma")?;
            let spread = (CLIP_DEVIATIONS * sigma).exp();
            let min = inner.number("min")?.unwrap_or(median / spread);
            let max = inner.number("max")?.unwrap_or(median * spread);
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
    let inner = table.table("sizes")?.expect("the key is there");
    let (radii, fractions) = (inner.need_numbers("radius_m")?, inner.need_numbers("fraction")?);
    if radii.iter().any(|radius| !range.contains(*radius)) {
        return Err(inner.bad("radius_m", format!("out of range; give numbers {range}")));
    }
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
    let Some(table) = parent.table(key)? else {
        return Ok(parent.number(key)?.map(ChargeDistribution::Constant));
    };
    let charges = match single(&table)? {
        "constant" => ChargeDistribution::Constant(table.need_number("constant")?),
        "uniform" => {
            let inner = table.table("uniform")?.expect("the key is there");
            ChargeDistribution::Uniform(min_max(&inner, CHARGE)?)
        }
        "normal" => {
            let inner = table.table("normal")?.expect("the key is there");
            ChargeDistribution::Normal { mean: inner.need_number("mean")?, std: inner.need_number("std")? }
        }
        "bipolar" => ChargeDistribution::Bipolar(match table.table("bipolar")? {
            Some(inner) => inner.need_number("magnitude")?,
            None => table.need_number("bipolar")?,
        }),
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
