//! Laws of charge transfer at contacts, for host programs that trade charge themselves.

use amberfield_core::{Permittivity, Vector3};
use amberfield_laws::charge_transfer::{
    ChargeOfInsulator, ChargedSphere, Drive, between_grains, with_grounded_wall, with_insulating_wall,
    work_term,
};
use amberfield_laws::kept_charge::KeptCharge;
use amberfield_laws::{contact_area, dielectric_breakdown, hertz_mindlin};

/// Contact whose area grows, of two grains or of a grain with a wall.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct AmberfieldContact {
    /// Charges of the grains [C]; of a wall none is read.
    pub charge: [f64; 2],
    /// Radii of the grains [m]; of a wall none is read.
    pub radius: [f64; 2],
    /// Work functions [eV].
    pub work_function_ev: [f64; 2],
    /// Cut-off distance of the transfer [m].
    pub cutoff: f64,
    /// Relative permittivity of the medium.
    pub relative_permittivity: f64,
    /// Field at the contact of everything but the two bodies, and at a wall but the grain's image, along the
    /// normal from the first to the second [V/m].
    pub normal_field: f64,
    /// Growth of the contact's area [m^2].
    pub growth: f64,
    /// Field at which the medium breaks down [V/m]; 0: it never does.
    pub breakdown: f64,
}

impl AmberfieldContact {
    fn permittivity(&self) -> f64 {
        Permittivity::from_relative(self.relative_permittivity).absolute()
    }

    fn work(&self) -> f64 {
        work_term(self.permittivity(), self.work_function_ev, self.cutoff)
    }

    fn sphere(&self, index: usize) -> ChargedSphere {
        ChargedSphere { charge: self.charge[index], radius: self.radius[index] }
    }

    /// Charge that moves [C], as far as the medium does not break down.
    fn moved(&self, drive: Drive) -> f64 {
        let moved = drive.transfer(self.growth);
        if self.breakdown <= 0.0 {
            return moved;
        }
        let permittivity = self.permittivity();
        let normal_field = (drive.drive - self.work()) / permittivity;
        dielectric_breakdown::bounded(moved, normal_field, drive.decay / permittivity, self.breakdown)
    }
}

/// Returns the charge [C] that moves from the first grain to the second.
///
/// # Safety
/// `contact` may be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_charge_between_grains(contact: *const AmberfieldContact) -> f64 {
    // SAFETY: the caller's promise.
    let contact = unsafe { &*contact };
    let grains = [contact.sphere(0), contact.sphere(1)];
    contact.moved(between_grains(contact.permittivity(), contact.work(), grains, contact.normal_field))
}

/// Returns the charge [C] that moves from a grain, the first body, to a grounded wall.
///
/// # Safety
/// `contact` may be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_charge_to_grounded_wall(contact: *const AmberfieldContact) -> f64 {
    // SAFETY: the caller's promise.
    let contact = unsafe { &*contact };
    let (permittivity, work) = (contact.permittivity(), contact.work());
    contact.moved(with_grounded_wall(permittivity, work, contact.sphere(0), contact.normal_field))
}

/// Returns the charge [C] that moves from a grain, the first body, to an insulating wall, which keeps it.
///
/// `kept_field` is the field at the contact of the charge that the wall keeps around it, positive from the
/// wall to the grain [V/m]; `per_charge` the growth of epsilon times that field per charge that this contact
/// leaves [1/m^2], which is 1/(4 pi r^2) where the radius is r. Both are sums over
/// `amberfield_kept_charge_field`.
///
/// # Safety
/// `contact` may be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_charge_to_insulating_wall(
    contact: *const AmberfieldContact,
    kept_field: f64,
    per_charge: f64,
) -> f64 {
    // SAFETY: the caller's promise.
    let contact = unsafe { &*contact };
    let kept = ChargeOfInsulator { normal_field: kept_field, per_charge };
    let (permittivity, work) = (contact.permittivity(), contact.work());
    contact.moved(with_insulating_wall(permittivity, work, contact.sphere(0), kept, contact.normal_field))
}

/// Writes the field of a charge that an insulator keeps around a place, over Coulomb's constant times the
/// charge [1/m^2], at an offset from the place.
///
/// `scale` is the larger of the radii of the grains that left the charge and of the one that feels it [m],
/// `normal` the surface's unit normal on the side of the charge, and the sign of `side` that of the height
/// before the surface, where the height itself is round-off.
///
/// # Safety
/// `normal` and `offset` have three numbers, and `e` takes three.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_kept_charge_field(
    scale: f64,
    normal: *const f64,
    offset: *const f64,
    side: f64,
    e: *mut f64,
) {
    // SAFETY: the caller's promise.
    let [normal, offset] =
        [normal, offset].map(|vector| Vector3::from(unsafe { *vector.cast::<[f64; 3]>() }));
    let field = KeptCharge { scale, normal }.field(offset, side);
    // SAFETY: the caller's promise.
    unsafe { e.cast::<[f64; 3]>().write(field.into()) };
}

/// Returns the area of a Hertz contact [m^2], for an effective radius and an overlap [m].
#[unsafe(no_mangle)]
pub extern "C" fn amberfield_contact_area(effective_radius: f64, overlap: f64) -> f64 {
    contact_area::hertz(effective_radius, overlap)
}

/// Returns the factor of the area of two bodies whose moduli are softer in the computation than in truth:
/// Young's moduli [Pa] of both bodies as computed, the real ones, and Poisson's ratios.
///
/// # Safety
/// Each array has two numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_area_correction(
    soft: *const f64,
    real: *const f64,
    poisson: *const f64,
) -> f64 {
    // SAFETY: the caller's promise.
    let [soft, real, poisson] = [soft, real, poisson].map(|pair| unsafe { *pair.cast::<[f64; 2]>() });
    let star = |young: [f64; 2]| hertz_mindlin::effective_young(young[0], poisson[0], young[1], poisson[1]);
    contact_area::correction(star(soft), star(real), 1.0)
}

/// Returns the radius-weighted rate at which a contact of grains relaxes, 1/(4 pi) (1/r_i^2 + 1/r_j^2) times
/// the growth of its area: what share of a difference of charge moves, where it is small. At a grounded wall
/// the second radius is that of the first.
///
/// # Safety
/// `contact` may be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_relaxation(contact: *const AmberfieldContact) -> f64 {
    // SAFETY: the caller's promise.
    let contact = unsafe { &*contact };
    let grains = [contact.sphere(0), contact.sphere(1)];
    between_grains(contact.permittivity(), 0.0, grains, 0.0).decay * contact.growth
}

/// Returns Coulomb's constant in the medium, 1/(4 pi epsilon) [m/F], for a relative permittivity.
#[unsafe(no_mangle)]
pub extern "C" fn amberfield_coulomb(relative_permittivity: f64) -> f64 {
    Permittivity::from_relative(relative_permittivity).coulomb()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONTACT: AmberfieldContact = AmberfieldContact {
        charge: [1e-13, -2e-13],
        radius: [1e-4, 2e-4],
        work_function_ev: [4.0, 4.5],
        cutoff: 5e-7,
        relative_permittivity: 1.0,
        normal_field: 1e4,
        growth: 1e-11,
        breakdown: 0.0,
    };

    fn grains(contact: AmberfieldContact) -> f64 {
        // SAFETY: a contact of this frame.
        unsafe { amberfield_charge_between_grains(&raw const contact) }
    }

    #[test]
    fn exchange_of_names_turns_the_sign() {
        let turned = AmberfieldContact {
            charge: [-2e-13, 1e-13],
            radius: [2e-4, 1e-4],
            work_function_ev: [4.5, 4.0],
            normal_field: -1e4,
            ..CONTACT
        };
        assert!((grains(CONTACT) + grains(turned)).abs() < 1e-13 * grains(CONTACT).abs());
    }

    #[test]
    fn small_growth_relaxes_by_its_share_and_breakdown_bounds_it() {
        let alone = AmberfieldContact { work_function_ev: [4.0; 2], normal_field: 0.0, ..CONTACT };
        // SAFETY: a contact of this frame.
        let share = unsafe { amberfield_relaxation(&raw const alone) };
        let equal = AmberfieldContact { radius: [1e-4; 2], ..alone };
        // SAFETY: a contact of this frame.
        let share_of_equals = unsafe { amberfield_relaxation(&raw const equal) };
        let moved = grains(equal) / (0.5 * share_of_equals * 3e-13);
        assert!((moved - 1.0).abs() < 1e-3 && share < share_of_equals, "{moved}");
        let driven = AmberfieldContact { growth: 1e-3, ..CONTACT };
        let bounded = grains(AmberfieldContact { breakdown: 1e5, ..driven });
        assert!(bounded.abs() < grains(driven).abs(), "{bounded}");
    }

    #[test]
    fn bare_insulator_takes_what_a_grounded_wall_takes_and_kept_charge_repels() {
        let (normal, offset, mut e) = ([0.0, 0.0, 1.0], [0.0; 3], [0.0; 3]);
        // SAFETY: arrays of this frame.
        unsafe {
            amberfield_kept_charge_field(1e-4, normal.as_ptr(), offset.as_ptr(), 1.0, e.as_mut_ptr());
        }
        assert!((e[2] * 1e-8 - 1.0).abs() < 1e-12 && e[0] == 0.0, "{e:?}");
        let per_charge = e[2] / (4.0 * std::f64::consts::PI);
        let contact = CONTACT;
        // SAFETY: a contact of this frame.
        let [grounded, bare, charged] = unsafe {
            [
                amberfield_charge_to_grounded_wall(&raw const contact),
                amberfield_charge_to_insulating_wall(&raw const contact, 0.0, per_charge),
                amberfield_charge_to_insulating_wall(&raw const contact, 1e6, per_charge),
            ]
        };
        let neutral = AmberfieldContact { charge: [0.0; 2], ..CONTACT };
        // SAFETY: a contact of this frame.
        let [to_ground, to_bare] = unsafe {
            [
                amberfield_charge_to_grounded_wall(&raw const neutral),
                amberfield_charge_to_insulating_wall(&raw const neutral, 0.0, per_charge),
            ]
        };
        assert!((to_bare / to_ground - 1.0).abs() < 1e-12);
        // The image of a charged grain drives it on into a conductor.
        assert!(bare < grounded && charged < bare, "{charged:e} {bare:e} {grounded:e}");
    }

    #[test]
    fn areas_are_those_of_the_laws() {
        assert_eq!(amberfield_contact_area(5e-4, 1e-6), contact_area::hertz(5e-4, 1e-6));
        let (soft, real, poisson) = ([1e7; 2], [1e11; 2], [0.3; 2]);
        // SAFETY: arrays of this frame.
        let factor = unsafe { amberfield_area_correction(soft.as_ptr(), real.as_ptr(), poisson.as_ptr()) };
        assert!((factor - 1e-4_f64.powf(0.4)).abs() < 1e-12);
    }
}
