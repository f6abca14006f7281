//! The question for the far part of a field.

/// Cloud of charge that stands for a grain in the far part of the field.
///
/// A Kaiser-Bessel cloud of a radius and a shape, or, with the radius 0, the grain's charge spread over the
/// cell that the grain is in.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SourceCloud {
    /// Radius at which the cloud ends [m]; 0: the charge is spread over its cell.
    pub radius_m: f64,
    /// Shape of the Kaiser-Bessel cloud, a number; 0 where the radius is 0.
    pub shape: f64,
}

impl SourceCloud {
    /// Makes the cloud of charge that is spread over the cell it is in.
    #[must_use]
    pub const fn nearest_cell() -> Self {
        Self { radius_m: 0.0, shape: 0.0 }
    }

    /// Whether the charge is spread over the cell it is in.
    #[must_use]
    pub fn is_nearest_cell(self) -> bool {
        self.radius_m == 0.0
    }
}

/// Scalars of the question for the far part of a field.
///
/// The question is for the solution of div(grad(potential)) = -density/permittivity, where the density is
/// that of the clouds. Charges, their positions and the values on the boundary are arrays beside it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FarQuestion {
    /// Cloud that every charge is.
    pub cloud: SourceCloud,
    /// Absolute permittivity of the medium [F/m].
    pub permittivity_f_m: f64,
    /// 1: the mean density is taken off where no face prescribes the potential; 0: it is not.
    pub neutralising_background: u64,
    /// Time at which the charges are where they are [s].
    pub time_s: f64,
    /// Relative tolerance of the linear solver; 0: the solver's own.
    pub tolerance: f64,
    /// 1: E at the cells' centres is wanted; 0: the potential alone.
    pub wants_e: u64,
}
