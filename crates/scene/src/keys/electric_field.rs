//! Keys of `[electric_field]`.

use super::{Form, Key, course};
use crate::limits::{ELECTRIC, FRACTION, LENGTH, TOLERANCE};
use crate::tree::Range;

/// Largest number of cells of the internal grid per axis.
const MOST_CELLS: i64 = 1 << 16;

pub(super) static KEYS: &[Key] = &[
    Key::new(
        "method",
        Form::Word(&["p3m", "direct", "kolehmainen", "cutoff"]),
        "Method by which the field is summed.",
    )
    .default("\"p3m\"")
    .example("\"direct\"")
    .also(&["solver", "kind", "algorithm", "ewald", "pppm"]),
    Key::new("tolerance", Form::Number(TOLERANCE), "Relative RMS error of E that is kept.")
        .default("1e-2")
        .example("1e-3")
        .also(&["accuracy", "error", "precision", "tol", "relative_error"]),
    Key::new(
        "relative_permittivity",
        Form::Number(Range::closed(1.0, 1e6)),
        "Relative permittivity of the medium between grains.",
    )
    .default("1.0")
    .example("1.0")
    .also(&["permittivity", "epsilon_r", "epsilon", "dielectric_constant", "eps_r"]),
    Key::new(
        "external_field_V_m",
        Form::Either(&[Form::Vector(ELECTRIC), Form::Table(course::FIELD)]),
        "Even field that is added everywhere; a table gives one that changes with time.",
    )
    .unit("V/m")
    .default("[0.0, 0.0, 0.0]")
    .example("[0.0, 0.0, 1e5]")
    .also(&["external_field", "field_V_m", "background_field", "e0", "applied_field"]),
    Key::new(
        "coupling_interval",
        Form::Either(&[Form::Whole(1, u32::MAX as i64), Form::Word(&["auto"])]),
        "Steps between evaluations of the field, or as many as the tolerance allows.",
    )
    .default("\"auto\"")
    .example("10")
    .also(&["interval", "every", "update_interval", "steps"]),
    Key::new("overlap", Form::Boolean, "Whether grains move on while a field solver works.")
        .default("false")
        .example("true"),
    Key::new(
        "tuning",
        Form::Word(&["timed", "model"]),
        "How parameters are chosen: by trial on this machine, or by a model of cost alone.",
    )
    .default("\"model\"")
    .example("\"timed\""),
    Key::new(
        "far_tolerance",
        Form::Either(&[Form::Number(TOLERANCE), Form::Word(&["auto"])]),
        "Relative tolerance of the solver's linear equations.",
    )
    .default("\"auto\"")
    .example("1e-5"),
    Key::new("neutralising_background", Form::Boolean, "Whether even charge makes a periodic box neutral.")
        .default("false")
        .example("true")
        .also(&["background", "neutral", "neutralizing_background", "jellium"]),
    Key::new(
        "grid",
        Form::Table(&[Key::new(
            "cells",
            Form::Either(&[Form::Wholes(1, MOST_CELLS), Form::Word(&["auto"])]),
            "Cells of the internal grid along x, y and z.",
        )
        .required()
        .example("[64, 64, 128]")
        .also(&["n", "size", "mesh"])]),
        "Internal grid, instead of the one that is chosen.",
    )
    .without("chosen for the tolerance")
    .example("{ cells = [64, 64, 128] }")
    .also(&["mesh", "cells", "grid_cells"]),
    Key::new(
        "field_cutoff_radius",
        Form::Number(LENGTH),
        "Radius up to which pairs are summed; kolehmainen and cutoff need it.",
    )
    .unit("m")
    .without("chosen for the tolerance")
    .example("3e-3")
    .also(&["cutoff", "cutoff_radius", "cutoff_m", "r_c", "rc", "field_cutoff_radius_m"]),
    Key::new("id", Form::Text, "Name of the field in other codes' scenes; kept and not used.")
        .default("\"efield\"")
        .example("\"e1\""),
    Key::new("particle_group", Form::Text, "Group of the grains that make and feel the field.")
        .default("\"all\"")
        .example("\"fines\"")
        .also(&["group"]),
    Key::new("use_without_cfd_coupling", Form::Boolean, "Whether the field is computed without [solver].")
        .default("true")
        .example("true"),
    Key::new("enable_collision_charge_transfer", Form::Boolean, "Whether contacts trade charge.")
        .default("false")
        .example("true")
        .also(&[
            "charge_transfer",
            "charging",
            "enable_charging",
            "triboelectric",
            "tribocharging",
            "contact_charging",
        ]),
    Key::new(
        "charge_transfer_cutoff",
        Form::Number(LENGTH),
        "Distance over which charge is traded at a contact.",
    )
    .unit("m")
    .default("5e-7")
    .example("1e-7"),
    Key::new("limit_field_force", Form::Boolean, "Whether the force by the field is limited.")
        .default("false")
        .example("true"),
    Key::new(
        "field_force_limit_factor",
        Form::Number(FRACTION),
        "Share of the skin by which the field may move a grain in a step.",
    )
    .default("1e-3")
    .example("0.1"),
    Key::new("command", Form::Text, "Line of another code that stands for these keys.")
        .without("the keys")
        .example("\"enable_electric_field field_cutoff_radius 3e-3\""),
];
