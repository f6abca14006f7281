//! Distributions of radii and charges.

use super::spec::GenerateContext;
use crate::SceneError;
use crate::limits::{RADIUS, RADIUS_OR_POINT};
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
pub(crate) enum RadiusDistribution {
    Constant(f64),
    Uniform(Limits),
    Normal { mean: f64, std: f64, limits: Limits },
    LogNormal { median: f64, sigma: f64, limits: Limits },
    Sizes { radii: Vec<f64>, fractions: Vec<f64> },
}

/// Smallest and largest value of a distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limits {
    min: f64,
    max: f64,
}

/// Distribution of charges [C].
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ChargeDistribution {
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
pub(crate) fn read_radii(
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
        "by_mass" => {
            let pairs = table.pairs("by_mass")?;
            let pairs = table.need(pairs, "by_mass", "give pairs [radius, share]")?;
            // Of one density: the number of grains in a mass goes with 1/r³.
            let (radii, fractions) =
                pairs.into_iter().map(|[radius, share]| (radius, share / radius.powi(3))).unzip();
            Ok(RadiusDistribution::Sizes { radii, fractions })
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

/// Reads a key with charges [C], or charges over masses [C/kg], of a feed; zero where it is absent.
pub(crate) fn read_charges_of_feed(
    parent: &SceneTable<'_>,
    key: &str,
) -> Result<ChargeDistribution, SceneError> {
    let Some(table) = parent.table(key)? else {
        return Ok(ChargeDistribution::Constant(parent.number(key)?.unwrap_or(0.0)));
    };
    read_plain_charges(&table, single(&table)?)
}

/// Reads the distribution of charges that a word names, without those of files.
fn read_plain_charges(table: &SceneTable<'_>, word: &str) -> Result<ChargeDistribution, SceneError> {
    Ok(match word {
        "constant" => ChargeDistribution::Constant(table.need_number("constant")?),
        "uniform" => {
            let inner = table.table("uniform")?.expect("the key is there");
            let (min, max) = (inner.need_number("min")?, inner.need_number("max")?);
            if max < min {
                return Err(inner.bad("max", format!("below min = {min}; exchange them")));
            }
            ChargeDistribution::Uniform(Limits { min, max })
        }
        "normal" => {
            let inner = table.table("normal")?.expect("the key is there");
            ChargeDistribution::Normal { mean: inner.need_number("mean")?, std: inner.need_number("std")? }
        }
        _ => ChargeDistribution::Bipolar(match table.table("bipolar")? {
            Some(inner) => inner.need_number("magnitude")?,
            None => table.need_number("bipolar")?,
        }),
    })
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
        "from_file" => {
            let file = table.text("from_file")?;
            let file = table.need(file, "from_file", "name a CSV with the column charge_C")?;
            let bytes = context.source.read_file(&table, "from_file", file)?;
            ChargeDistribution::List(read_charges(file, &bytes, count)?)
        }
        word => read_plain_charges(&table, word)?,
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

/// Radii that are drawn one after another: more of them begin with the same ones.
#[derive(Clone, Debug)]
pub(crate) struct RadiusStream {
    distribution: RadiusDistribution,
    random: ChaCha8Rng,
    /// Grains of each of several sizes so far.
    drawn: Vec<f64>,
}

impl RadiusStream {
    pub(crate) fn new(distribution: RadiusDistribution, random: ChaCha8Rng) -> Self {
        let sizes = if let RadiusDistribution::Sizes { radii, .. } = &distribution { radii.len() } else { 0 };
        Self { distribution, random, drawn: vec![0.0; sizes] }
    }

    /// Draws the next radius [m].
    ///
    /// Among several sizes, each is as likely as it lags behind its share: shares are kept to a grain or so
    /// from the beginning.
    pub(crate) fn next(&mut self) -> Result<f64, String> {
        let RadiusDistribution::Sizes { radii, fractions } = &self.distribution else {
            return Ok(self.distribution.draw(1, &mut self.random)?[0]);
        };
        let total: f64 = fractions.iter().sum();
        let number = self.drawn.iter().sum::<f64>() + 1.0;
        let lag = |k: usize| (fractions[k] / total * number - self.drawn[k]).max(0.0);
        let mut at = self.random.random::<f64>() * (0..radii.len()).map(lag).sum::<f64>();
        let mut chosen = radii.len() - 1;
        for k in 0..radii.len() {
            at -= lag(k);
            if at < 0.0 {
                chosen = k;
                break;
            }
        }
        self.drawn[chosen] += 1.0;
        Ok(radii[chosen])
    }
}

/// Charges that are drawn one after another: more of them begin with the same ones.
#[derive(Clone, Debug)]
pub(crate) struct ChargeStream {
    distribution: ChargeDistribution,
    random: ChaCha8Rng,
    /// Charge of the second of a pair.
    second: Option<f64>,
}

impl ChargeStream {
    pub(crate) fn new(distribution: ChargeDistribution, random: ChaCha8Rng) -> Self {
        Self { distribution, random, second: None }
    }

    /// Draws the next charge [C]. Both signs come in pairs, one of each, in random order.
    pub(crate) fn next(&mut self) -> Result<f64, String> {
        let ChargeDistribution::Bipolar(charge) = &self.distribution else {
            return Ok(self.distribution.draw(1, &mut self.random)?[0]);
        };
        if let Some(second) = self.second.take() {
            return Ok(second);
        }
        let first = if self.random.random::<bool>() { *charge } else { -charge };
        self.second = Some(-first);
        Ok(first)
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
