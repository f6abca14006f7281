//! Column of a table, array of a VTK file or key of a JSON file.

/// Column, or three columns of a vector.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Names; a part in capitals, as in `wall_s_STAGE`, stands for one of several words.
    pub names: &'static [&'static str],
    /// Unit; empty where there is none.
    pub unit: &'static str,
    /// Condition under which the column is there.
    pub when: When,
    /// Sentence about the column.
    pub meaning: &'static str,
}

/// Condition under which a column is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// No condition: every file.
    Always,
    /// Gravity.
    Gravity,
    /// Wall with a motion.
    Motion,
    /// Field of charged grains.
    Field,
    /// Charging by contact.
    Transfer,
    /// Charging by contact and a wall that takes charge.
    ChargedWalls,
    /// Limit on the electric force.
    Limit,
    /// Field solver of another process.
    Solver,
    /// Stage of the scene's plan: a column for each.
    Stage,
    /// Feed of grains.
    Feeds,
    /// Grains that come or go.
    Books,
    /// Outlet: a column for each.
    Outlets,
    /// Walls that are conductors of the field: a column for each.
    Conductors,
    /// Option `--components`.
    Components,
}

impl When {
    /// Condition in words; empty where there is none.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Always => "",
            Self::Gravity => "gravity",
            Self::Motion => "a wall with `motion`",
            Self::Field => "`[electric_field]` and a charge",
            Self::Transfer => "`enable_collision_charge_transfer`",
            Self::ChargedWalls => "the same, and a wall with `charging`",
            Self::Limit => "`limit_field_force`",
            Self::Solver => "`[solver]` for the field",
            Self::Stage => "a stage of the scene's plan",
            Self::Feeds => "`[[feeds]]`",
            Self::Books => "`[[feeds]]`, `[[outlets]]` or `on_exit = \"delete\"`",
            Self::Outlets => "`[[outlets]]`",
            Self::Conductors => "a charge, and a wall with `field`",
            Self::Components => "`--components`",
        }
    }
}

/// Name of a material, an outlet or a wall as a part of a column's name, without what would part columns.
#[must_use]
pub fn in_heading(name: &str) -> String {
    name.replace([',', '"', '\n', '\r'], "_")
}

impl Column {
    /// Column that is always there.
    pub(super) const fn new(
        names: &'static [&'static str],
        unit: &'static str,
        meaning: &'static str,
    ) -> Self {
        Self { names, unit, when: When::Always, meaning }
    }

    /// Makes the column one that is there under a condition.
    pub(super) const fn when(mut self, when: When) -> Self {
        self.when = when;
        self
    }
}
