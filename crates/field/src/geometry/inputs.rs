//! Checks of positions and charges that every method shares.

use crate::error::FieldError;
use amberfield_core::{Axis, Boundary, Domain, FieldSettings, Permittivity, Side};
use nalgebra::Vector3;

/// Net charge over Σ|q| (and the charge that the faces' normal fields stand for) that counts as round-off:
/// charges read from text or traded over many contacts do not cancel to the last bit.
pub(crate) const NET_CHARGE_ROUND_OFF: f64 = 1e-9;

/// Refuses positions and charges that are not finite.
pub(crate) fn check_finite(positions: &[Vector3<f64>], charges: &[f64]) -> Result<(), FieldError> {
    if positions.len() != charges.len() {
        return Err(FieldError::Settings(format!(
            "{} positions but {} charges; give one charge for each position",
            positions.len(),
            charges.len()
        )));
    }
    let bad = positions
        .iter()
        .zip(charges)
        .position(|(position, charge)| !(position.iter().all(|c| c.is_finite()) && charge.is_finite()));
    bad.map_or(Ok(()), |index| Err(FieldError::NotFinite { index }))
}

/// Refuses grains on or beyond a conducting or insulating face, where a mirror image would lie on the grain
/// or inside the box. `index` is counted from 0.
pub(crate) fn check_inside(domain: &Domain, positions: &[Vector3<f64>]) -> Result<(), FieldError> {
    let is_wall = |axis, side| !matches!(domain.face(axis, side), Boundary::Periodic | Boundary::Open);
    for axis in Axis::ALL {
        let (low, high) = (domain.min()[axis.index()], domain.max()[axis.index()]);
        let beyond =
            |at: f64| (is_wall(axis, Side::Min) && at <= low) || (is_wall(axis, Side::Max) && at >= high);
        if let Some(index) = positions.iter().position(|position| beyond(position[axis.index()])) {
            let at = positions[index][axis.index()];
            return Err(FieldError::Settings(format!(
                "grain at index {index} has its centre at {axis} = {at:e} m, on or beyond a face of the \
                 domain ({low:e} to {high:e} m); its image charge would lie on or inside the grain: enlarge \
                 the domain"
            )));
        }
    }
    Ok(())
}

/// Refuses grains beyond any face that is not periodic. `index` is counted from 0.
pub(crate) fn check_in_box(domain: &Domain, positions: &[Vector3<f64>]) -> Result<(), FieldError> {
    check_inside(domain, positions)?;
    let outside = |position: &Vector3<f64>| {
        Axis::ALL.into_iter().any(|axis| {
            let at = position[axis.index()];
            !domain.is_periodic(axis)
                && !(domain.min()[axis.index()]..=domain.max()[axis.index()]).contains(&at)
        })
    };
    match positions.iter().position(outside) {
        None => Ok(()),
        Some(index) => Err(FieldError::Settings(format!(
            "grain at index {index} has its centre at {:?} m, outside the domain; enlarge the domain, \
             or check that places and box are both in metres",
            positions[index].as_slice()
        ))),
    }
}

/// Charge [C] that the prescribed normal fields of the faces stand for by Gauss's law: ε Σ (E·n) A, counted
/// on the faces of axes without an open face.
pub(crate) fn charge_of_normal_fields(domain: &Domain, permittivity: Permittivity) -> f64 {
    let flux: f64 = normal_fluxes(domain).sum();
    permittivity.absolute() * flux
}

fn normal_fluxes(domain: &Domain) -> impl Iterator<Item = f64> {
    Axis::ALL.into_iter().flat_map(move |axis| {
        let area = domain.volume() / domain.extent()[axis.index()];
        [Side::Min, Side::Max].into_iter().map(move |side| match domain.face(axis, side) {
            Boundary::Insulating { normal_field_v_m } => normal_field_v_m * area,
            _ => 0.0,
        })
    })
}

/// Sums of charges [C].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ChargeSums {
    /// Sum of the charges.
    pub(crate) net: f64,
    /// Sum of their sizes.
    pub(crate) absolute: f64,
}

impl ChargeSums {
    /// Sums of the given charges.
    pub(crate) fn of(charges: &[f64]) -> Self {
        Self { net: charges.iter().sum(), absolute: charges.iter().map(|charge| charge.abs()).sum() }
    }
}

/// Refuses a net charge that no face can take.
pub(crate) fn check_net_charge(
    domain: &Domain,
    permittivity: Permittivity,
    neutralising_background: bool,
    sums: ChargeSums,
) -> Result<(), FieldError> {
    if neutralising_background || !domain.needs_neutrality() {
        return Ok(());
    }
    let net_charge_c = sums.net - charge_of_normal_fields(domain, permittivity);
    let absolute = sums.absolute + permittivity.absolute() * normal_fluxes(domain).map(f64::abs).sum::<f64>();
    if net_charge_c.abs() > NET_CHARGE_ROUND_OFF * absolute {
        return Err(FieldError::NetCharge { net_charge_c });
    }
    Ok(())
}

/// Refuses what a grid in the box cannot carry: values that are not finite, grains outside the box, a net
/// charge that no face takes. `permittivity` is ε0·εr [F/m].
pub(crate) fn check_charges_in_box(
    domain: &Domain,
    permittivity: Permittivity,
    neutralising_background: bool,
    positions: &[Vector3<f64>],
    charges: &[f64],
) -> Result<(), FieldError> {
    check_finite(positions, charges)?;
    check_in_box(domain, positions)?;
    check_net_charge(domain, permittivity, neutralising_background, ChargeSums::of(charges))
}

/// Refuses particles that a grid in the box of a scene with these settings cannot carry, as p3m does at every
/// evaluation.
pub(crate) fn check_scene(
    domain: &Domain,
    settings: &FieldSettings,
    positions: &[Vector3<f64>],
    charges: &[f64],
) -> Result<(), FieldError> {
    let permittivity = settings.permittivity;
    check_charges_in_box(domain, permittivity, settings.neutralising_background, positions, charges)
}

/// Refuses a result that is not finite: two charges, or a charge and an image, in one place.
pub(crate) fn check_result(e: &[Vector3<f64>]) -> Result<(), FieldError> {
    match e.iter().position(|e| !e.iter().all(|c| c.is_finite())) {
        None => Ok(()),
        Some(index) => Err(FieldError::Settings(format!(
            "the field at the grain at index {index} is not finite: another charge or an image has the same \
             position; move the grains apart"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn insulating(normal_field_v_m: f64) -> Boundary {
        Boundary::Insulating { normal_field_v_m }
    }

    fn box_with(faces: [[Boundary; 2]; 3]) -> Domain {
        Domain::new(Vector3::zeros(), Vector3::new(1.0, 2.0, 3.0), faces).unwrap()
    }

    #[test]
    fn normal_fields_count_in_the_net_charge() {
        let (permittivity, field) = (Permittivity::from_relative(2.5), 5.0);
        let domain =
            box_with([[insulating(field), insulating(0.0)], [insulating(0.0); 2], [Boundary::Periodic; 2]]);
        let taken = permittivity.absolute() * field * 6.0;
        assert!(
            check_net_charge(&domain, permittivity, false, ChargeSums::of(&[0.5 * taken, 0.5 * taken]))
                .is_ok()
        );
        assert!(check_net_charge(&domain, permittivity, false, ChargeSums::of(&[taken, -taken])).is_err());
        assert!(check_net_charge(&domain, permittivity, true, ChargeSums::of(&[taken, -taken])).is_ok());
    }

    #[test]
    fn only_closed_boxes_without_conductor_refuse_a_net_charge() {
        let net = [1e-14, 2e-14];
        let refused = box_with([[Boundary::Periodic; 2]; 3]);
        assert!(matches!(
            check_net_charge(&refused, Permittivity::VACUUM, false, ChargeSums::of(&net)),
            Err(FieldError::NetCharge { .. })
        ));
        assert!(
            check_net_charge(
                &refused,
                Permittivity::VACUUM,
                false,
                ChargeSums::of(&[1e-14, -1e-14 * (1.0 + 1e-13)])
            )
            .is_ok()
        );
        let grounded =
            box_with([[Boundary::Periodic; 2], [insulating(0.0), Boundary::Grounded], [Boundary::Open; 2]]);
        assert!(check_net_charge(&grounded, Permittivity::VACUUM, false, ChargeSums::of(&net)).is_ok());
    }

    #[test]
    fn grains_on_a_wall_or_not_finite_are_refused() {
        let domain =
            box_with([[Boundary::Grounded, Boundary::Open], [Boundary::Periodic; 2], [insulating(0.0); 2]]);
        let inside = Vector3::new(5.0, -1.0, 1.0);
        assert!(check_inside(&domain, &[inside]).is_ok());
        assert!(check_inside(&domain, &[inside, Vector3::new(0.0, 1.0, 1.0)]).is_err());
        assert!(check_inside(&domain, &[Vector3::new(0.5, 1.0, 3.5)]).is_err());
        assert_eq!(
            check_finite(&[inside, inside], &[1.0, f64::NAN]),
            Err(FieldError::NotFinite { index: 1 })
        );
    }
}
