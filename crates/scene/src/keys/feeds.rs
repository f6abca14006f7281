//! Keys of `[[feeds]]`.

use super::particles::{BOX, CHARGE_WORDS, CYLINDER, GROUP, MATERIAL, RADII, RADIUS_WORDS};
use super::{Form, Key};
use crate::limits::{CHARGE, GRAINS, RADIUS, SPEED, TIME};
use crate::tree::Range;

/// Rates of grains [1/s] and of their mass [kg/s].
const RATE: Range = Range::positive(1e12);
/// Charges over masses [C/kg].
const CHARGE_PER_MASS: Range = Range::closed(-1e12, 1e12);

static REGION: &[Key] = &[
    Key::new("box", Form::Table(BOX), "Box along the axes; grains appear in it as a whole.")
        .without("cylinder, or stl")
        .example("{ min_m = [0.0, 0.0, 0.08], max_m = [0.1, 0.1, 0.1] }")
        .also(&["cuboid", "block"]),
    Key::new("cylinder", Form::Table(CYLINDER), "Cylinder; grains appear in it as a whole.")
        .without("box, or stl")
        .example("{ base_m = [0.0, 0.0, 0.08], top_m = [0.0, 0.0, 0.1], radius_m = 0.02 }"),
    Key::new("stl", Form::Text, "STL file with a face through which grains come, with their velocity.")
        .without("box, or cylinder")
        .example("\"face.stl\"")
        .also(&["face", "mesh", "file", "surface"]),
    Key::new(
        "scale",
        Form::Number(Range::positive(1e6)),
        "Metres in a unit of the STL file; 1e-3 for millimetres.",
    )
    .default("1.0")
    .example("1e-3")
    .also(&["unit", "units", "factor"]),
];

/// Distributions of a charge, or of a charge over the mass, in one unit.
macro_rules! charges {
    ($range:expr, $spread:expr, $unit:literal, $example:literal) => {
        &[
            Key::new("constant", Form::Number($range), "One value for all.").unit($unit).example($example),
            Key::new(
                "uniform",
                Form::Table(&[
                    Key::new("min", Form::Number($range), "Least value.")
                        .unit($unit)
                        .required()
                        .example(concat!("-", $example)),
                    Key::new("max", Form::Number($range), "Largest value.")
                        .unit($unit)
                        .required()
                        .example($example),
                ]),
                "Values evenly distributed between two.",
            )
            .example(concat!("{ min = -", $example, ", max = ", $example, " }")),
            Key::new(
                "normal",
                Form::Table(&[
                    Key::new("mean", Form::Number($range), "Mean.").unit($unit).required().example("0.0"),
                    Key::new("std", Form::Number($spread), "Standard deviation.")
                        .unit($unit)
                        .required()
                        .example($example)
                        .also(&["sigma", "stdev"]),
                ]),
                "Normal distribution by number.",
            )
            .example(concat!("{ mean = 0.0, std = ", $example, " }"))
            .also(&["gaussian", "gauss"]),
            Key::new(
                "bipolar",
                Form::Either(&[
                    Form::Number($range),
                    Form::Table(&[Key::new("magnitude", Form::Number($range), "Size of the values.")
                        .unit($unit)
                        .required()
                        .example($example)]),
                ]),
                "As many grains with plus as with minus this, at random.",
            )
            .unit($unit)
            .example($example)
            .also(&["plus_minus", "both_signs", "alternating"]),
        ]
    };
}

static CHARGES: &[Key] = charges!(CHARGE, Range::closed(0.0, 1e6), "C", "1e-12");
static CHARGES_PER_MASS: &[Key] = charges!(CHARGE_PER_MASS, Range::closed(0.0, 1e12), "C/kg", "1e-6");

pub(super) static KEYS: &[Key] = &[
    Key::new("name", Form::Text, "Name in messages and results, which no other feed has.")
        .required()
        .example("\"hopper\"")
        .also(&["id", "title"]),
    MATERIAL,
    Key::new("region", Form::Table(REGION), "Where grains appear, or the face through which they come.")
        .required()
        .example("{ box = { min_m = [0.0, 0.0, 0.08], max_m = [0.1, 0.1, 0.1] } }")
        .also(&["place", "volume", "where", "face", "inlet"]),
    Key::new("rate_kg_s", Form::Number(RATE), "Mass of grains in a second.")
        .unit("kg/s")
        .without("rate_per_s")
        .example("0.1")
        .also(&["rate", "mass_rate", "massrate", "mass_flow", "flow_kg_s"]),
    Key::new("rate_per_s", Form::Number(RATE), "Number of grains in a second.")
        .unit("1/s")
        .without("rate_kg_s")
        .example("1000.0")
        .also(&["number_rate", "particle_rate", "particlerate", "grains_per_s"]),
    Key::new("total_kg", Form::Number(RATE), "Mass of grains at which the feed ends.")
        .unit("kg")
        .without("no such end")
        .example("2.0")
        .also(&["mass", "mass_kg", "total_mass"]),
    Key::new("count", Form::Whole(1, GRAINS), "Number of grains at which the feed ends.")
        .without("no such end")
        .example("10000")
        .also(&["n", "number", "total", "nparticles"]),
    Key::new("start_s", Form::Number(Range::closed(0.0, 1e9)), "Time at which the feed begins.")
        .unit("s")
        .default("0.0")
        .example("0.1")
        .also(&["start", "begin_s", "from_s"]),
    Key::new("end_s", Form::Number(TIME), "Time at which the feed ends.")
        .unit("s")
        .without("the end of the run")
        .example("1.0")
        .also(&["end", "stop_s", "until_s"]),
    Key::new(
        "radius_m",
        Form::Either(&[Form::Number(RADIUS), Form::Table(RADII)]),
        "Radius of the grains, or a distribution of radii.",
    )
    .unit("m")
    .required()
    .example("5e-4")
    .also(RADIUS_WORDS),
    Key::new(
        "charge_C",
        Form::Either(&[Form::Number(CHARGE), Form::Table(CHARGES)]),
        "Charge of the grains, or a distribution of charges.",
    )
    .unit("C")
    .default("0.0")
    .example("{ normal = { mean = 0.0, std = 1e-14 } }")
    .also(CHARGE_WORDS),
    Key::new(
        "charge_C_kg",
        Form::Either(&[Form::Number(CHARGE_PER_MASS), Form::Table(CHARGES_PER_MASS)]),
        "Charge of the grains over their mass, or a distribution of it.",
    )
    .unit("C/kg")
    .without("charge_C")
    .example("-1e-6")
    .also(&["charge_to_mass", "q_over_m", "specific_charge", "charge_per_mass"]),
    Key::new("velocity_m_s", Form::Vector(SPEED), "Mean velocity of the grains as they come.")
        .unit("m/s")
        .default("[0.0, 0.0, 0.0]")
        .example("[0.0, 0.0, -1.0]")
        .also(&["velocity", "speed_m_s", "v", "u"]),
    Key::new(
        "velocity_spread_m_s",
        Form::Number(Range::closed(0.0, 1e6)),
        "Standard deviation of each component of the velocity, cut at three of it.",
    )
    .unit("m/s")
    .default("0.0")
    .example("0.05")
    .also(&["spread", "velocity_std", "velocity_spread"]),
    Key::new(
        "seed",
        Form::Whole(0, i64::MAX),
        "Seed of the random numbers; each feed has its own by its name.",
    )
    .default("0")
    .example("7"),
    GROUP,
    Key::new(
        "on_blocked",
        Form::Word(&["wait", "stop"]),
        "What happens where a grain that is due finds no place: it waits and is owed, or the run ends.",
    )
    .default("\"wait\"")
    .example("\"stop\"")
    .also(&["blocked", "on_full", "if_blocked"]),
];
