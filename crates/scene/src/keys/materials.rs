//! Keys of `[[materials]]`.

use super::{Form, Key};
use crate::limits::{DENSITY, FRICTION, SURFACE_ENERGY, YOUNG};
use crate::tree::Range;

pub(super) static KEYS: &[Key] = &[
    Key::new("name", Form::Text, "Name that grains and walls give.")
        .required()
        .example("\"glass\"")
        .also(&["id", "material", "type"]),
    Key::new("density_kg_m3", Form::Number(DENSITY), "Density of the solid.")
        .unit("kg/m³")
        .required()
        .example("2500.0")
        .also(&["density", "rho", "density_g_cm3"]),
    Key::new(
        "young_Pa",
        Form::Number(YOUNG),
        "Young's modulus of contacts; softer than real allows longer steps.",
    )
    .unit("Pa")
    .required()
    .example("5e6")
    .also(&[
        "young",
        "youngs_modulus",
        "young_modulus",
        "youngs",
        "e",
        "stiffness",
        "young_GPa",
        "young_MPa",
    ]),
    Key::new(
        "young_real_Pa",
        Form::Number(YOUNG),
        "Young's modulus of the real solid, for charge_transfer.stiffness_correction.",
    )
    .unit("Pa")
    .without("young_Pa")
    .example("6.5e10"),
    // Isotropic solids allow −1 to 1/2; the contact laws divide by 1 − ν², 1 + ν and 2 − ν.
    Key::new("poisson", Form::Number(Range::closed(-0.99, 0.5)), "Poisson's ratio.")
        .required()
        .example("0.25")
        .also(&["poissons_ratio", "poisson_ratio", "nu", "shear_modulus"]),
    Key::new(
        "restitution",
        Form::Number(Range::positive(1.0)),
        "Coefficient of restitution of a central impact.",
    )
    .required()
    .example("0.7")
    .also(&["coefficient_of_restitution", "coefficient_restitution", "cor", "damping"]),
    Key::new("friction", Form::Number(FRICTION), "Coefficient of sliding friction.")
        .required()
        .example("0.3")
        .also(&[
            "mu",
            "friction_coefficient",
            "coefficient_friction",
            "sliding_friction",
            "coefficient_of_friction",
        ]),
    Key::new("rolling_friction", Form::Number(FRICTION), "Coefficient of rolling friction.")
        .default("0.0")
        .example("0.05")
        .also(&["mu_r", "rolling", "coefficient_rolling_friction"]),
    Key::new(
        "surface_energy_J_m2",
        Form::Number(SURFACE_ENERGY),
        "Surface energy γ, by which contacts.cohesion makes grains stick.",
    )
    .unit("J/m²")
    .default("0.0")
    .example("0.05")
    .also(&["surface_energy", "cohesion_energy", "gamma", "adhesion", "work_of_adhesion"]),
    Key::new(
        "work_function_eV",
        Form::Number(Range::closed(0.0, 100.0)),
        "Work function, which drives charging by contact.",
    )
    .unit("eV")
    .without("contacts of this material trade no charge; an error where charge transfer is asked for")
    .example("4.5")
    .also(&["work_function", "work_function_J", "workfunction", "phi"]),
];
