//! Rock salt, the periodic lattice whose potential is known to many digits.

use nalgebra::Vector3;

/// Madelung constant M of NaCl: q φ a/(k q²) = −M at each ion, a the distance of neighbours (OEIS A085469).
pub const MADELUNG_NACL: f64 = 1.747_564_594_633_182_2;

/// Ions of a lattice.
#[derive(Clone, Debug, PartialEq)]
pub struct Lattice {
    /// Positions [m].
    pub positions: Vec<Vector3<f64>>,
    /// Charges [C].
    pub charges: Vec<f64>,
}

/// Lattice of rock salt in a periodic cube with the edge `cells`·`spacing`.
///
/// `cells` is the number of ions along an edge (even, so that the lattice repeats), `spacing` the distance a
/// of neighbours [m], ±`charge` the charges [C]; the whole lattice is moved by `offset` [m].
///
/// # Panics
/// When `cells` is odd or 0.
#[must_use]
pub fn rock_salt(cells: usize, spacing: f64, charge: f64, offset: Vector3<f64>) -> Lattice {
    assert!(cells > 0 && cells.is_multiple_of(2), "rock salt repeats after an even number of ions");
    let mut positions = Vec::with_capacity(cells.pow(3));
    let mut charges = Vec::with_capacity(cells.pow(3));
    for x in 0..cells {
        for y in 0..cells {
            for z in 0..cells {
                positions.push(Vector3::new(x as f64, y as f64, z as f64) * spacing + offset);
                charges.push(if (x + y + z).is_multiple_of(2) { charge } else { -charge });
            }
        }
    }
    Lattice { positions, charges }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference;

    /// Bound on the error of φ that the reference set states.
    const REFERENCE_ERROR: f64 = 2e-14;

    #[test]
    fn reference_set_has_the_madelung_potential() {
        let set = reference::by_name("a_nacl_64").unwrap();
        for (charge, potential) in set.charge.iter().zip(&set.potential) {
            assert!((charge * potential + MADELUNG_NACL).abs() < REFERENCE_ERROR);
        }
    }

    #[test]
    fn shells_of_evjens_cube_approach_the_constant() {
        // Evjen's cubes: charges on faces, edges and corners count a half, a quarter and an eighth.
        let half: i32 = 8;
        let mut sum = 0.0;
        for x in -half..=half {
            for y in -half..=half {
                for z in -half..=half {
                    if (x, y, z) != (0, 0, 0) {
                        let on_faces = [x, y, z].iter().filter(|c| c.abs() == half).count() as i32;
                        let sign = if (x + y + z) % 2 == 0 { 1.0 } else { -1.0 };
                        sum += sign * 0.5_f64.powi(on_faces) / f64::from(x * x + y * y + z * z).sqrt();
                    }
                }
            }
        }
        // Evjen's sum at 8 shells is good to a few 1e-5.
        assert!((sum + MADELUNG_NACL).abs() < 1e-4, "{sum}");
    }

    #[test]
    fn lattice_is_neutral() {
        let Lattice { positions, charges } = rock_salt(4, 0.5, 2.0, Vector3::repeat(0.25));
        assert_eq!(positions.len(), 64);
        assert_eq!(charges.iter().sum::<f64>(), 0.0);
    }
}
