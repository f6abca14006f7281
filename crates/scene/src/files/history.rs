//! History of a run: energies, charges, counts, books and clocks.

use super::run::{STEP, TIME};
use super::{Column, FileTable, When};

/// Energies, charges, counts and clocks over time.
pub static HISTORY: FileTable = FileTable::csv(
    "history.csv",
    "Energies, charges, counts and clocks, a row each `output.history_every_s`.",
    &[
        STEP,
        TIME,
        Column::new(&["kinetic_J"], "J", "Kinetic energy of all grains, rotation included."),
        Column::new(
            &["contact_J"],
            "J",
            "Elastic energy of all contacts, normal, tangential and rolling, less what adhesion gained.",
        ),
        Column::new(&["gravity_J"], "J", "Energy of gravity, −Σ m g·x, zero at the origin.")
            .when(When::Gravity),
        Column::new(
            &["wall_work_J"],
            "J",
            "Work that walls which move have done on the grains since the start.",
        )
        .when(When::Motion),
        Column::new(
            &["electric_J"],
            "J",
            "Energy of the charges in their own field and the external one, ½ Σ q (V + V_external). The \
             potentials of faces are part of V and count by half: the sum of energies changes where grains \
             move between electrodes.",
        )
        .when(When::Field),
        Column::new(&["net_charge_C"], "C", "Sum of the charges of all grains.").when(When::Field),
        Column::new(
            &["contact_charge_C"],
            "C",
            "Sum of the sizes of all charges that contacts have moved since the start.",
        )
        .when(When::Transfer),
        Column::new(&["wall_charge_C"], "C", "Charge that all walls have taken since the start.")
            .when(When::ChargedWalls),
        Column::new(&["limited"], "", "Number of grains whose electric force is limited in this step.")
            .when(When::Limit),
        Column::new(&["contacts"], "", "Number of contacts, those with walls included."),
        Column::new(
            &["collisions"],
            "",
            "Number of contacts that have begun since the start, those with walls included.",
        )
        .when(When::Transfer),
        Column::new(&["grains"], "", "Number of grains that are there.").when(When::Books),
        Column::new(&["grains_kg"], "kg", "Their mass.").when(When::Books),
        Column::new(&["left_grains"], "", "Number of grains that have left.").when(When::Books),
        Column::new(&["left_kg"], "kg", "Their mass.").when(When::Books),
        Column::new(&["left_C"], "C", "Charge that they took along.").when(When::Books),
        Column::new(
            &["grains_NAME", "left_grains_NAME"],
            "",
            "Numbers of grains of a material that are there and that left.",
        )
        .when(When::Books),
        Column::new(
            &["grains_kg_NAME", "left_kg_NAME"],
            "kg",
            "Masses of grains of a material that are there and that left.",
        )
        .when(When::Books),
        Column::new(
            &["grains_C_NAME", "left_C_NAME", "gained_C_NAME"],
            "C",
            "Charges of grains of a material that are there and that left, and what they gained at contacts.",
        )
        .when(When::Books),
        Column::new(&["fed_grains"], "", "Number of grains that feeds have brought.").when(When::Feeds),
        Column::new(&["fed_kg"], "kg", "Their mass.").when(When::Feeds),
        Column::new(&["fed_C"], "C", "Charge with which they came.").when(When::Feeds),
        Column::new(&["owed_grains"], "", "Number of grains that were due and have found no place yet.")
            .when(When::Feeds),
        Column::new(&["owed_kg"], "kg", "Their mass, the feeds' shortfall.").when(When::Feeds),
        Column::new(&["fed_grains_NAME"], "", "Number of grains of a material that feeds have brought.")
            .when(When::Feeds),
        Column::new(&["fed_kg_NAME"], "kg", "Their mass.").when(When::Feeds),
        Column::new(&["fed_C_NAME"], "C", "Their charge as they came.").when(When::Feeds),
        Column::new(&["outlet_grains_OUTLET"], "", "Number of grains that left through an outlet.")
            .when(When::Outlets),
        Column::new(&["outlet_kg_OUTLET"], "kg", "Their mass.").when(When::Outlets),
        Column::new(&["outlet_C_OUTLET"], "C", "Charge that they took along.").when(When::Outlets),
        Column::new(&["conductor_V_WALL"], "V", "Potential of a wall with `field`.").when(When::Conductors),
        Column::new(
            &["conductor_C_WALL"],
            "C",
            "Its charge, induced by grains and potentials; `wall_charge_C` has what contacts took.",
        )
        .when(When::Conductors),
        Column::new(
            &["conductor_A_WALL"],
            "A",
            "Image current onto it by the motion of the grains (Shockley and Ramo); 0 where it floats.",
        )
        .when(When::Conductors),
        Column::new(&["solver_iterations"], "", "Iterations of the field solver's last solve.")
            .when(When::Solver),
        Column::new(&["wall_s"], "s", "Wall-clock time since the start of the run, earlier parts included."),
        Column::new(
            &["wall_s_STAGE"],
            "s",
            "Wall-clock time of a stage: integrate, neighbours, contacts, walls, gas, charging or field.",
        )
        .when(When::Stage),
    ],
);
