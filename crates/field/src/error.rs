//! Errors of the field crate.

/// Reason why a field cannot be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FieldError {
    /// The combination of method and settings is not possible.
    #[error("{0}")]
    Settings(String),
    /// Net charge in a box whose faces are all insulating or periodic.
    #[error(
        "net charge {net_charge_c:e} C in a box whose faces are all insulating or periodic has no field; \
         make the charge zero, ground a face, or set electric_field.neutralising_background = true"
    )]
    NetCharge {
        /// Net charge [C], less what the faces' normal fields take.
        net_charge_c: f64,
    },
    /// Net charge in a part of a mesh that is closed off from the rest, and whose faces are all insulating or
    /// cyclic.
    #[error(
        "net charge {net_charge_c:e} C in a part of the mesh whose faces are all insulating or cyclic has no \
         field: {cells} of {all_cells} cells, with centres from {} to {} m, which no face joins to the \
         rest; make the charge there zero, ground a patch there, or set \
         electric_field.neutralising_background = true",
        shown(low_m),
        shown(high_m)
    )]
    NetChargeOfPart {
        /// Net charge of the part [C], less what its faces' slopes take.
        net_charge_c: f64,
        /// Number of its cells.
        cells: usize,
        /// Number of all cells.
        all_cells: usize,
        /// Lower corner of the box of its cells' centres [m].
        low_m: [f64; 3],
        /// Upper corner of that box [m].
        high_m: [f64; 3],
    },
    /// A position or charge is not finite.
    #[error("grain at index {index} has a position or charge that is not finite")]
    NotFinite {
        /// Index of the grain.
        index: usize,
    },
    /// One of the ranks that share the field failed. Numbers of grains are those of that rank.
    #[error("rank {rank}: {reason}")]
    OfRank {
        /// Number of that rank.
        rank: usize,
        /// Reason that it gave.
        reason: String,
    },
    /// The field solver of another process is lost or makes no sense.
    #[error("{0}")]
    Solver(String),
    /// The field solver of another process does not take its case.
    #[error("{0}")]
    Refused(String),
    /// The linear solver of another process gave up before its tolerance.
    #[error("{0}")]
    NotConverged(String),
    /// The tolerance cannot be met.
    #[error("tolerance {asked:e} cannot be met: best measured error {reached:e}; {advice}")]
    Tolerance {
        /// Tolerance that was asked for.
        asked: f64,
        /// Best error measured.
        reached: f64,
        /// Advice to the user.
        advice: String,
    },
}

impl FieldError {
    /// Whether it is a field solver of another process that failed.
    #[must_use]
    pub fn is_of_solver(&self) -> bool {
        matches!(self, Self::Solver(_))
    }
}

/// A place in few digits.
fn shown([x, y, z]: &[f64; 3]) -> String {
    format!("({x:.4e} {y:.4e} {z:.4e})")
}
