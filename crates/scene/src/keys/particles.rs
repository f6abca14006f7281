//! Keys of `[particles]`.

use super::{Form, Key};
use crate::limits::{CHARGE, COORDINATE, GRAINS, LENGTH, RADIUS, RADIUS_OR_POINT, SPEED};
use crate::tree::Range;

pub(super) static BOX: &[Key] = &[
    Key::new("min_m", Form::Vector(COORDINATE), "Lower corner.")
        .unit("m")
        .required()
        .example("[0.0, 0.0, 0.0]")
        .also(&["min", "from_m", "lower"]),
    Key::new("max_m", Form::Vector(COORDINATE), "Upper corner.")
        .unit("m")
        .required()
        .example("[0.01, 0.01, 0.01]")
        .also(&["max", "to_m", "upper", "size_m"]),
];

pub(super) static CYLINDER: &[Key] = &[
    Key::new("base_m", Form::Vector(COORDINATE), "Centre of the lower end.")
        .unit("m")
        .required()
        .example("[0.0, 0.0, 0.0]")
        .also(&["from_m", "from", "base", "start_m", "centre_m", "center_m", "point_m"]),
    Key::new("top_m", Form::Vector(COORDINATE), "Centre of the upper end.")
        .unit("m")
        .without("axis and length_m")
        .example("[0.0, 0.0, 0.02]")
        .also(&["to_m", "to", "top", "end_m"]),
    Key::new(
        "axis",
        Form::Either(&[Form::Word(&["x", "y", "z"]), Form::Vector(Range::closed(-1e100, 1e100))]),
        "Direction of the cylinder's axis.",
    )
    .default("\"z\"")
    .example("\"z\"")
    .also(&["direction", "normal"]),
    Key::new("length_m", Form::Number(LENGTH), "Length along the axis.")
        .unit("m")
        .without("top_m")
        .example("0.02")
        .also(&["height_m", "length", "height"]),
    Key::new("radius_m", Form::Number(LENGTH), "Radius of the cylinder.")
        .unit("m")
        .required()
        .example("0.01")
        .also(&["radius", "diameter_m", "r"]),
];

pub(super) static VOLUME: &[Key] = &[
    Key::new("box", Form::Table(BOX), "Box along the axes.")
        .without("cylinder")
        .example("{ min_m = [0.0, 0.0, 0.0], max_m = [0.01, 0.01, 0.01] }")
        .also(&["cuboid", "block"]),
    Key::new("cylinder", Form::Table(CYLINDER), "Cylinder.")
        .without("box")
        .example("{ base_m = [0.0, 0.0, 0.0], top_m = [0.0, 0.0, 0.02], radius_m = 0.01 }"),
];

const fn radius(name: &'static str, meaning: &'static str) -> Key {
    Key::new(name, Form::Number(RADIUS), meaning).unit("m").example("5e-4")
}

pub(super) static RADII: &[Key] = &[
    Key::new("constant", Form::Number(RADIUS_OR_POINT), "One radius for all.").unit("m").example("5e-4"),
    Key::new(
        "uniform",
        Form::Table(&[
            Key::new("min", Form::Number(RADIUS_OR_POINT), "Smallest radius.")
                .unit("m")
                .required()
                .example("4e-4"),
            Key::new("max", Form::Number(RADIUS_OR_POINT), "Largest radius.")
                .unit("m")
                .required()
                .example("6e-4"),
        ]),
        "Radii evenly distributed between two.",
    )
    .example("{ min = 4e-4, max = 6e-4 }"),
    Key::new(
        "normal",
        Form::Table(&[
            radius("mean", "Mean of the distribution.").required().also(&["mu", "median"]),
            Key::new("std", Form::Number(RADIUS_OR_POINT), "Standard deviation.")
                .unit("m")
                .required()
                .example("5e-5")
                .also(&["sigma", "stdev", "deviation"]),
            radius("min", "Smallest radius; smaller ones are drawn again.")
                .without("mean − 3 std, a tenth of the mean at least")
                .example("4e-4"),
            radius("max", "Largest radius; larger ones are drawn again.")
                .without("mean + 3 std")
                .example("6e-4"),
        ]),
        "Normal distribution by number.",
    )
    .example("{ mean = 5e-4, std = 5e-5 }")
    .also(&["gaussian", "gauss"]),
    Key::new(
        "log_normal",
        Form::Table(&[
            radius("median", "Median of the distribution.").required().also(&["mean", "mu"]),
            Key::new(
                "sigma",
                Form::Number(Range::closed(0.0, 5.0)),
                "Standard deviation of the radius's natural logarithm.",
            )
            .required()
            .example("0.2")
            .also(&["std", "gsd", "stdev"]),
            radius("min", "Smallest radius; smaller ones are drawn again.")
                .without("median e^(−3 sigma)")
                .example("4e-4"),
            radius("max", "Largest radius; larger ones are drawn again.")
                .without("median e^(3 sigma)")
                .example("6e-4"),
        ]),
        "Log-normal distribution by number.",
    )
    .example("{ median = 5e-4, sigma = 0.2 }")
    .also(&["lognormal", "logNormal", "log-normal"]),
    Key::new(
        "sizes",
        Form::Table(&[
            Key::new("radius_m", Form::Numbers(RADIUS_OR_POINT), "Radii.")
                .unit("m")
                .required()
                .example("[4e-4, 6e-4]")
                .also(&["radii", "radius", "diameter_m"]),
            Key::new("fraction", Form::Numbers(Range::positive(1e12)), "Share of each radius by number.")
                .required()
                .example("[0.7, 0.3]")
                .also(&["fractions", "weights", "shares", "number_fraction"]),
        ]),
        "Several radii with their shares by number.",
    )
    .example("{ radius_m = [4e-4, 6e-4], fraction = [0.7, 0.3] }")
    .also(&["list", "bimodal", "discrete"]),
    Key::new(
        "by_mass",
        Form::Pairs(RADIUS, Range::positive(1e12)),
        "Several radii, each with its share by mass: pairs [radius, share].",
    )
    .unit("m")
    .example("[[4e-4, 0.3], [6e-4, 0.7]]")
    .also(&["mass_fraction", "sieve", "mass", "mass_fractions"]),
];

static CHARGES: &[Key] = &[
    Key::new("constant", Form::Number(CHARGE), "One charge for all.").unit("C").example("1e-12"),
    Key::new(
        "uniform",
        Form::Table(&[
            Key::new("min", Form::Number(CHARGE), "Least charge.").unit("C").required().example("-1e-12"),
            Key::new("max", Form::Number(CHARGE), "Largest charge.").unit("C").required().example("1e-12"),
        ]),
        "Charges evenly distributed between two.",
    )
    .example("{ min = -1e-12, max = 1e-12 }"),
    Key::new(
        "normal",
        Form::Table(&[
            Key::new("mean", Form::Number(CHARGE), "Mean charge.").unit("C").required().example("0.0"),
            Key::new("std", Form::Number(Range::closed(0.0, 1e6)), "Standard deviation.")
                .unit("C")
                .required()
                .example("1e-12")
                .also(&["sigma", "stdev"]),
        ]),
        "Normal distribution by number.",
    )
    .example("{ mean = 0.0, std = 1e-12 }")
    .also(&["gaussian", "gauss"]),
    Key::new(
        "bipolar",
        Form::Either(&[
            Form::Number(CHARGE),
            Form::Table(&[Key::new("magnitude", Form::Number(CHARGE), "Size of the charges.")
                .unit("C")
                .required()
                .example("1e-12")
                .also(&["charge", "q"])]),
        ]),
        "As many grains with +q as with −q, at random.",
    )
    .unit("C")
    .example("1e-12")
    .also(&["plus_minus", "both_signs", "alternating"]),
    Key::new("from_file", Form::Text, "CSV file with the column charge_C, a row for each grain.")
        .example("\"charges.csv\"")
        .also(&["file", "csv"]),
];

/// Material of grains that are made.
pub(super) const MATERIAL: Key = Key::new("material", Form::Text, "Name of the grains' material.")
    .without("the scene's only material")
    .example("\"glass\"");
/// Group of grains that are made.
pub(super) const GROUP: Key =
    Key::new("group", Form::Text, "Group that electric_field.particle_group can name.")
        .without("the group \"all\" alone")
        .example("\"fines\"");
/// Words that are meant as a radius.
pub(super) const RADIUS_WORDS: &[&str] =
    &["diameter_m", "diameter", "radius", "size", "d", "r", "radius_mm", "diameter_mm"];
/// Words that are meant as a charge.
pub(super) const CHARGE_WORDS: &[&str] = &["charge", "q", "charge_e", "charge_pC", "charge_nC"];

static GENERATE: &[Key] = &[
    MATERIAL,
    Key::new("count", Form::Whole(1, GRAINS), "Number of grains.").required().example("1000").also(&[
        "n",
        "number",
        "particles",
        "num",
    ]),
    Key::new(
        "radius_m",
        Form::Either(&[Form::Number(RADIUS_OR_POINT), Form::Table(RADII)]),
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
    .example("{ bipolar = 1e-12 }")
    .also(CHARGE_WORDS),
    Key::new(
        "region",
        Form::Either(&[Form::Word(&["box"]), Form::Table(VOLUME)]),
        "Where grains are placed at random; \"box\" is the domain.",
    )
    .default("\"box\"")
    .example("{ box = { min_m = [0.0, 0.0, 0.0], max_m = [0.01, 0.01, 0.01] } }")
    .also(&["place", "volume", "where"]),
    Key::new("seed", Form::Whole(0, i64::MAX), "Seed of the random numbers.").default("0").example("1"),
    Key::new("velocity_m_s", Form::Vector(SPEED), "Velocity of all grains.")
        .unit("m/s")
        .default("[0.0, 0.0, 0.0]")
        .example("[0.0, 0.0, -0.1]")
        .also(&["velocity", "speed_m_s", "v", "u"]),
    GROUP,
];

pub(super) static KEYS: &[Key] = &[
    Key::new(
        "file",
        Form::Text,
        "File with the grains: a table (CSV), a dump of LAMMPS or LIGGGHTS, or a VTK file; or its .gz.",
    )
    .without("generate")
    .example("\"grains.csv\"")
    .also(&["csv", "path", "snapshot", "dump", "vtk", "vtu"]),
    Key::new(
        "units",
        Form::Word(&["si", "cgs", "micro", "nano", "real", "metal", "electron"]),
        "Unit style of a dump or VTK file that does not name it, as the command units of LAMMPS has it; \
         lj is none, since it has no units.",
    )
    .without("the style that the file names")
    .example("\"si\"")
    .also(&["unit", "unit_style", "scale"]),
    Key::new("step", Form::Whole(0, i64::MAX), "Step of the frame, in a file with several.")
        .without("the last frame")
        .example("100000")
        .also(&["frame", "timestep", "time_step", "snapshot_step"]),
    Key::new("materials_by_type", Form::Texts, "Materials of types 1, 2, … of a dump or VTK file.")
        .without("the scene's only material")
        .example("[\"glass\", \"steel\"]")
        .also(&["types", "type_names", "materials", "material_by_type"]),
    Key::new("generate", Form::Table(GENERATE), "Grains that are placed at random.")
        .without("file")
        .example("{ material = \"glass\", count = 1000, radius_m = 5e-4, seed = 1 }")
        .also(&["generator", "create", "insert", "random", "pack"]),
    Key::new(
        "from",
        Form::Text,
        "Checkpoint of another run, or that run's folder for its newest one, with whose grains this scene \
         begins at time 0. The scene may differ in all but the names of the grains' materials. Contacts \
         keep their springs where stiffness, friction and adhesion of both materials, and the wall, are the \
         same. Overlaps that the run had are allowed. Charge on walls, fields and gas begin anew.",
    )
    .without("file or generate")
    .example("\"runs/filled/checkpoints/step_000000010000.amber\"")
    .also(&["checkpoint", "restart", "read_restart", "initial", "start_from"]),
    Key::new(
        "fixed_groups",
        Form::Texts,
        "Groups whose grains never move nor turn, as if they were infinitely heavy. They touch grains that \
         move, carry charge and trade it, and a gas feels their drag. Two of them, or one and a wall, do \
         nothing to each other. Grains of `from` come to rest; other grains must have no velocity.",
    )
    .example("[\"bed\"]")
    .also(&["fixed", "frozen", "freeze", "static", "immobile"]),
    Key::new(
        "on_exit",
        Form::Word(&["stop", "delete"]),
        "What happens when a grain leaves the domain: the run ends, or the grain is removed.",
    )
    .default("\"stop\"")
    .example("\"delete\"")
    .also(&["exit", "outflow", "leave"]),
    Key::new("allow_overlap", Form::Boolean, "Whether grains may overlap at the start.")
        .default("false")
        .example("true"),
];
