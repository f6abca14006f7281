//! The question for the far part of the field: [`FarQuestion`], which `field`, `wire` and the C library
//! share.

use super::{FarQuestion, SourceCloud, require};
use crate::{Element, Section, WireError};
use std::mem::{offset_of, size_of};

// SAFETY: seven numbers without padding, see below.
unsafe impl Element for FarQuestion {}

const _: () = {
    assert!(size_of::<SourceCloud>() == 16);
    assert!(offset_of!(SourceCloud, radius_m) == 0);
    assert!(offset_of!(SourceCloud, shape) == 8);
    assert!(size_of::<FarQuestion>() == 56);
    assert!(offset_of!(FarQuestion, cloud) == 0);
    assert!(offset_of!(FarQuestion, permittivity_f_m) == 16);
    assert!(offset_of!(FarQuestion, neutralising_background) == 24);
    assert!(offset_of!(FarQuestion, time_s) == 32);
    assert!(offset_of!(FarQuestion, tolerance) == 40);
    assert!(offset_of!(FarQuestion, wants_e) == 48);
};

/// Refuses a question with numbers that cannot be used.
///
/// # Errors
/// Numbers that are not finite, a permittivity that is not positive.
pub fn check_far_question(question: &FarQuestion) -> Result<(), WireError> {
    let require = |sound, name, value| require(sound, Section::FarQuestion, name, value);
    let FarQuestion { cloud, permittivity_f_m, time_s, tolerance, .. } = *question;

    require(cloud.radius_m.is_finite(), "cloud.radius_m", cloud.radius_m)?;
    require(cloud.shape.is_finite(), "cloud.shape", cloud.shape)?;
    let positive = permittivity_f_m.is_finite() && permittivity_f_m > 0.0;
    require(positive, "permittivity_f_m", permittivity_f_m)?;
    require(time_s.is_finite(), "time_s", time_s)?;
    require(tolerance.is_finite(), "tolerance", tolerance)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: FarQuestion = FarQuestion {
        cloud: SourceCloud { radius_m: 2e-3, shape: 10.0 },
        permittivity_f_m: 8.9e-12,
        neutralising_background: 0,
        time_s: 0.5,
        tolerance: 1e-6,
        wants_e: 1,
    };

    #[test]
    fn a_number_that_cannot_be_used_is_named() {
        assert_eq!(check_far_question(&GOOD), Ok(()));
        let bad = FarQuestion { permittivity_f_m: 0.0, ..GOOD };
        let said = check_far_question(&bad).unwrap_err().to_string();
        assert!(said.contains("permittivity_f_m") && said.contains("FarQuestion"), "{said}");
        assert!(check_far_question(&FarQuestion { time_s: f64::NAN, ..GOOD }).is_err());
        let cloud = SourceCloud { radius_m: f64::INFINITY, shape: 1.0 };
        assert!(check_far_question(&FarQuestion { cloud, ..GOOD }).is_err());
    }
}
