//! Keys of a study.

use super::{Form, Key};
use crate::limits::COORDINATE;
use crate::tree::Range;

/// Numbers of no particular size, above 0.
const POSITIVE: Range = Range::positive(1e300);
/// Bounds of what may come out; 0 where nothing may.
const BOUND: Range = Range::closed(0.0, 1e300);

static SWEEP: &[Key] = &[
    Key::new("key", Form::Text, "Key of the scene, as in --set.")
        .required()
        .example("\"electric_field.tolerance\""),
    Key::new("values", Form::Anything, "Values of the key.").required().example("[1e-1, 1e-2, 1e-3]"),
    Key::new("times", Form::Number(POSITIVE), "Factor of the numbers among the values: a diameter, a cell.")
        .default("1.0")
        .example("1e-3"),
];

static BOX: &[Key] = &[
    Key::new("min_m", Form::Vector(COORDINATE), "Lower corner.")
        .unit("m")
        .required()
        .example("[0.0, 0.0, 0.0]"),
    Key::new("max_m", Form::Vector(COORDINATE), "Upper corner.")
        .unit("m")
        .required()
        .example("[0.01, 0.01, 0.01]"),
];

static SPHERE: &[Key] = &[
    Key::new("centre_m", Form::Vector(COORDINATE), "Centre.").unit("m").required().example("[0.0, 0.0, 0.0]"),
    Key::new("radius_m", Form::Number(POSITIVE), "Radius.").unit("m").required().example("0.01"),
];

static TRUTH: &[Key] = &[
    Key::new("grounded_sphere", Form::Table(SPHERE), "Charges in a grounded sphere: Kelvin's images."),
    Key::new("grounded_boxes", Form::Tables(BOX), "Grains in grounded boxes that do not see each other."),
    Key::new(
        "finer",
        Form::Texts,
        "More overrides, KEY=VALUE, with which the scene's own field is the truth.",
    )
    .example("[\"electric_field.tolerance=1e-4\"]"),
];

const fn name(meaning: &'static str) -> Key {
    Key::new("name", Form::Text, meaning).required().example("\"bed\"")
}

const fn scene() -> Key {
    Key::new("scene", Form::Text, "Scene file, beside the study.").required().example("\"scene.toml\"")
}

const fn set() -> Key {
    Key::new("set", Form::Texts, "Overrides of the scene, KEY=VALUE.")
        .default("[]")
        .example("[\"particles.generate.count=1000\"]")
}

const fn sweep(meaning: &'static str) -> Key {
    Key::new("sweep", Form::Table(SWEEP), meaning)
        .without("one")
        .example("{ key = \"electric_field.tolerance\", values = [1e-2, 1e-3] }")
}

static PROBLEMS: &[Key] = &[
    name("Name in the report."),
    scene(),
    set(),
    sweep("One key with several values: a problem for each."),
    Key::new(
        "truth",
        Form::Either(&[Form::Word(&["box"]), Form::Table(TRUTH)]),
        "Source of the exact field; \"box\" is the direct sum.",
    )
    .default("\"box\"")
    .example("{ finer = [\"electric_field.tolerance=1e-4\"] }"),
];

static METHODS: &[Key] = &[
    name("Name in the report."),
    set(),
    sweep("One key with several values: a point for each."),
    Key::new("program", Form::Text, "Another program; the sweep's values are tolerances then.")
        .example("\"lammps\""),
    Key::new("problems", Form::Texts, "Problems that the method is used on.")
        .without("all")
        .example("[\"bed\"]"),
    Key::new("most_grains", Form::Whole(1, i64::MAX), "Grains beyond which the method is left out.")
        .example("10000"),
    Key::new("most_error", Form::Number(BOUND), "Relative RMS error above which the study fails.")
        .example("0.1"),
];

static MOTIONS: &[Key] = &[
    name("Name in the report."),
    scene(),
    set(),
    Key::new("reference", Form::Texts, "More overrides, which make the reference.")
        .required()
        .example("[\"time.step_s=1e-6\"]"),
    Key::new(
        "replicas",
        Form::Table(SWEEP),
        "Key, such as the seed, whose values give replicas of the reference.",
    ),
    Key::new(
        "variants",
        Form::Tables(METHODS),
        "Overrides on top of the reference's, each a run or several.",
    )
    .required(),
];

static EXTREMES: &[Key] = &[
    name("What is pushed to its end."),
    Key::new("expect", Form::Text, "Expectation in words.").required().example("\"the run ends well\""),
    scene(),
    set(),
    sweep("One key with several values: a run for each."),
    Key::new("ends", Form::Word(&["well", "refused", "unsound"]), "How the command should end.")
        .default("\"well\"")
        .example("\"refused\""),
    Key::new("says", Form::Text, "Words that the last message should contain.").example("\"step\""),
    Key::new(
        "most_gain",
        Form::Number(BOUND),
        "Most that the energy rises, over the largest that is turned over.",
    )
    .example("1e-3"),
    Key::new("most_loss", Form::Number(BOUND), "Most that the energy falls, likewise.").example("1e-3"),
    Key::new("most_kinetic_j", Form::Number(BOUND), "Most kinetic energy per grain at the end.")
        .unit("J")
        .example("1e-12"),
    Key::new(
        "most_error",
        Form::Number(BOUND),
        "Most relative RMS error of E; the field is evaluated then, and nothing moves.",
    )
    .example("1e-2"),
    Key::new("most_charge", Form::Number(BOUND), "Most change of all charge, over the sizes of all charges.")
        .default("1e-12")
        .example("1e-12"),
    Key::new("limited", Form::Boolean, "Whether forces should be limited.").example("true"),
    Key::new("most_s", Form::Number(POSITIVE), "Longest time that it may take.")
        .unit("s")
        .default("120.0")
        .example("60.0"),
];

static GOALS: &[Key] = &[
    Key::new("text", Form::Text, "The goal in words.").required().example("\"ten times as fast\""),
    Key::new("method", Form::Text, "Method that it is about.").required().example("\"p3m\""),
    Key::new("value", Form::Text, "One value of the method's sweep.").without("all").example("\"1e-3\""),
    Key::new("problems", Form::Texts, "Problems that it is about.").without("all").example("[\"bed\"]"),
    Key::new(
        "times_less",
        Form::Number(POSITIVE),
        "Factor by which the best error with a promise is smaller in the method's time.",
    )
    .example("10.0"),
    Key::new(
        "times_as_fast",
        Form::Number(POSITIVE),
        "Factor by which the fastest with a promise is faster at the method's error.",
    )
    .example("10.0"),
    Key::new(
        "price",
        Form::Texts,
        "Two problems; the time on the first is at most `at_most` times that on the second.",
    )
    .example("[\"periodic\", \"grounded\"]"),
    Key::new("at_most", Form::Number(POSITIVE), "Factor of `price`.").example("1.5"),
    Key::new("tried", Form::Text, "Attempts so far, and what would be next.").example("\"a finer grid\""),
];

pub(super) static KEYS: &[Key] = &[
    Key::new("name", Form::Text, "Name of the page, the pictures and the rows.")
        .required()
        .example("\"study\""),
    Key::new("title", Form::Text, "Headline of the page.").required().example("\"Error against run time\""),
    Key::new("passes", Form::Whole(1, i64::MAX), "Number of times that every point is timed.")
        .default("3")
        .example("5"),
    Key::new(
        "least_s",
        Form::Number(Range::closed(0.0, 3600.0)),
        "Time for which the evaluations of one turn go on.",
    )
    .unit("s")
    .default("0.1")
    .example("0.2"),
    Key::new("direct_up_to", Form::Whole(0, i64::MAX), "Grains up to which the truth is the direct sum.")
        .default("10000")
        .example("10000"),
    Key::new("problems", Form::Tables(PROBLEMS), "Problems that are computed."),
    Key::new("methods", Form::Tables(METHODS), "Methods that compute them."),
    Key::new("motions", Form::Tables(MOTIONS), "Whole runs that are compared with much finer ones."),
    Key::new("extremes", Form::Tables(EXTREMES), "Scenes that are pushed to an end."),
    Key::new("goals", Form::Tables(GOALS), "Results that should come out."),
];
