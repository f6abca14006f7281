//! Reference fields of point charges, known to 1e-9 or better, from `reference/*.csv` (see
//! `reference/README.md`).
//!
//! The files use units with 4πε₀ = 1; charges and lengths are near 1. To have SI values, take the charges as
//! coulombs and the lengths as metres, and multiply E and φ by 1/(4πε): see [`ReferenceSet::field_si`].

use amberfield_core::{Boundary, Domain};
use nalgebra::Vector3;

/// Reference set: charges in a box with the field and the potential that act on each.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceSet {
    /// Name of the file without its ending.
    pub name: &'static str,
    /// Box and its boundary conditions.
    pub domain: Domain,
    /// Positions of the charges.
    pub position: Vec<Vector3<f64>>,
    /// Charges.
    pub charge: Vec<f64>,
    /// Potential at each charge (4πε₀ = 1), without its own q/r but with that of its images and periodic
    /// copies.
    pub potential: Vec<f64>,
    /// Field at each charge (4πε₀ = 1).
    pub e: Vec<Vector3<f64>>,
    /// Bound on the largest error of `e`.
    pub e_bound: f64,
    /// Bound on the largest error of `potential`.
    pub potential_bound: f64,
}

impl ReferenceSet {
    /// Field E [V/m] when the charges are coulombs and the lengths metres; `coulomb_constant` = 1/(4πε)
    /// [V·m/C].
    #[must_use]
    pub fn field_si(&self, coulomb_constant: f64) -> Vec<Vector3<f64>> {
        self.e.iter().map(|e| e * coulomb_constant).collect()
    }

    /// Potential [V] when the charges are coulombs and the lengths metres; `coulomb_constant` = 1/(4πε)
    /// [V·m/C].
    #[must_use]
    pub fn potential_si(&self, coulomb_constant: f64) -> Vec<f64> {
        self.potential.iter().map(|potential| potential * coulomb_constant).collect()
    }

    /// Energy ½ Σ q φ (4πε₀ = 1).
    #[must_use]
    pub fn energy(&self) -> f64 {
        0.5 * self
            .charge
            .iter()
            .zip(&self.potential)
            .map(|(charge, potential)| charge * potential)
            .sum::<f64>()
    }

    /// Scale to which a tolerance refers: max(E_rms, q_rms n^{2/3}) (4πε₀ = 1).
    #[must_use]
    pub fn scale(&self) -> f64 {
        crate::field_scale(&self.e, &self.charge, self.domain.volume(), 1.0)
    }
}

const INSULATING: Boundary = Boundary::Insulating { normal_field_v_m: 0.0 };

/// File of a reference set, with what the file does not say.
struct SetFile {
    name: &'static str,
    text: &'static str,
    /// Edge of the cube.
    edge: f64,
    /// Boundary condition of both faces of each axis.
    axes: [Boundary; 3],
    e_bound: f64,
    potential_bound: f64,
}

macro_rules! source {
    ($name:literal, $edge:expr, $axes:expr, $e_bound:expr, $potential_bound:expr) => {
        SetFile {
            name: $name,
            text: include_str!(concat!("../reference/", $name, ".csv")),
            edge: $edge,
            axes: $axes,
            e_bound: $e_bound,
            potential_bound: $potential_bound,
        }
    };
}

const SETS: [SetFile; 8] = [
    source!("a_nacl_64", 4.0, [Boundary::Periodic; 3], 5e-14, 2e-14),
    source!("b_periodic_bip_2000", 1.0, [Boundary::Periodic; 3], 1.9e-11, 3e-12),
    source!("c_grounded_box_bip_2000", 1.0, [Boundary::Grounded; 3], 1.7e-11, 1.2e-12),
    source!("c_grounded_box_gau_net_2000", 1.0, [Boundary::Grounded; 3], 1.3e-10, 2.3e-11),
    source!(
        "d_grounded_z_periodic_xy_net_2000",
        1.0,
        [Boundary::Periodic, Boundary::Periodic, Boundary::Grounded],
        3.7e-10,
        1e-10
    ),
    source!(
        "d_grounded_z_insulating_xy_net_2000",
        1.0,
        [INSULATING, INSULATING, Boundary::Grounded],
        2.6e-10,
        7e-11
    ),
    source!("d_insulating_box_neutral_2000", 1.0, [INSULATING; 3], 1.7e-11, 3e-12),
    source!("e_open_bip_2000", 1.0, [Boundary::Open; 3], 4.8e-12, 1e-13),
];

/// Names of all sets, in the order of [`all`].
#[must_use]
pub fn names() -> Vec<&'static str> {
    SETS.iter().map(|source| source.name).collect()
}

/// All reference sets.
#[must_use]
pub fn all() -> Vec<ReferenceSet> {
    SETS.iter().map(load).collect()
}

/// Reference set with the given name, if there is one.
#[must_use]
pub fn by_name(name: &str) -> Option<ReferenceSet> {
    SETS.iter().find(|source| source.name == name).map(load)
}

/// Charges, with what acts on each (4πε₀ = 1).
#[derive(Clone, Debug, PartialEq)]
pub struct Charges {
    /// Positions.
    pub position: Vec<Vector3<f64>>,
    /// Charges.
    pub charge: Vec<f64>,
    /// Potential at each charge without its own q/r.
    pub potential: Vec<f64>,
    /// Field at each charge without its own.
    pub e: Vec<Vector3<f64>>,
}

/// Charges of a table.
pub(crate) fn charges_of(table: &str) -> Charges {
    let rows = rows::<8>(table);
    Charges {
        position: rows.iter().map(|row| Vector3::new(row[0], row[1], row[2])).collect(),
        charge: rows.iter().map(|row| row[3]).collect(),
        potential: rows.iter().map(|row| row[4]).collect(),
        e: rows.iter().map(|row| Vector3::new(row[5], row[6], row[7])).collect(),
    }
}

fn load(source: &SetFile) -> ReferenceSet {
    let Charges { position, charge, potential, e } = charges_of(source.text);
    ReferenceSet {
        name: source.name,
        domain: Domain::new(
            Vector3::zeros(),
            Vector3::repeat(source.edge),
            source.axes.map(|boundary| [boundary; 2]),
        )
        .expect("a cube of positive edge with equal opposite faces is a domain"),
        position,
        charge,
        potential,
        e,
        e_bound: source.e_bound,
        potential_bound: source.potential_bound,
    }
}

fn rows<const COLUMNS: usize>(text: &str) -> Vec<[f64; COLUMNS]> {
    text.lines()
        .skip(1)
        .filter(|line| !line.trim().is_empty())
        .map(|line| {
            let mut row = [f64::NAN; COLUMNS];
            let mut cells = line.split(',');
            for value in &mut row {
                let cell = cells.next().expect("a reference row has all its columns");
                *value = cell.trim().parse().expect("a reference cell is a number");
            }
            row
        })
        .collect()
}

/// Row of [`f_plane`]: charge 1 over a grounded plane (4πε₀ = 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneRow {
    /// Height over the plane.
    pub height: f64,
    /// Potential of the charge's own image at the charge.
    pub potential: f64,
    /// Force on the charge; a negative force is towards the plane.
    pub force: f64,
}

/// Forces on a charge 1 at several heights over a grounded plane.
#[must_use]
pub fn f_plane() -> Vec<PlaneRow> {
    rows::<3>(include_str!("../reference/f_plane.csv"))
        .into_iter()
        .map(|[height, potential, force]| PlaneRow { height, potential, force })
        .collect()
}

/// Row of [`f_sphere`]: charge 1 outside a sphere of radius 1 (4πε₀ = 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereRow {
    /// Distance from the centre.
    pub distance: f64,
    /// Potential of the image in the grounded sphere at the charge.
    pub potential_grounded: f64,
    /// Force by the grounded sphere; a negative force is towards it.
    pub force_grounded: f64,
    /// Force by the isolated sphere without net charge.
    pub force_isolated: f64,
}

/// Forces on a charge 1 at several distances from a sphere of radius 1.
#[must_use]
pub fn f_sphere() -> Vec<SphereRow> {
    rows::<4>(include_str!("../reference/f_sphere.csv"))
        .into_iter()
        .map(|[distance, potential_grounded, force_grounded, force_isolated]| SphereRow {
            distance,
            potential_grounded,
            force_grounded,
            force_isolated,
        })
        .collect()
}

/// Way along which the single charge of [`f_cube_single`] moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CubePath {
    /// Line above the centre of the face z = 0.
    Face,
    /// Bisector of the edge y = z = 0, at mid-length.
    Edge,
    /// Diagonal from the corner at the origin.
    Corner,
}

/// Row of [`f_cube_single`]: charge 1 alone in the grounded unit cube (4πε₀ = 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubeRow {
    /// Path on which the charge lies.
    pub path: CubePath,
    /// Distance from the faces of the path.
    pub height: f64,
    /// Position of the charge.
    pub position: Vector3<f64>,
    /// Potential of all its images at the charge.
    pub potential: f64,
    /// Field of all its images at the charge.
    pub e: Vector3<f64>,
}

/// Fields at a single charge in the grounded unit cube; the error of E is at most 1.9e-12.
#[must_use]
pub fn f_cube_single() -> Vec<CubeRow> {
    rows::<9>(include_str!("../reference/f_cube_single.csv"))
        .into_iter()
        .map(|[path, height, x, y, z, potential, ex, ey, ez]| CubeRow {
            path: match path as u8 {
                0 => CubePath::Face,
                1 => CubePath::Edge,
                _ => CubePath::Corner,
            },
            height,
            position: Vector3::new(x, y, z),
            potential,
            e: Vector3::new(ex, ey, ez),
        })
        .collect()
}

/// Box of [`f_cube_single`]: the unit cube, all faces grounded.
#[must_use]
pub fn f_cube_domain() -> Domain {
    Domain::new(Vector3::zeros(), Vector3::repeat(1.0), [[Boundary::Grounded; 2]; 3])
        .expect("the unit cube is a domain")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::open_sum;

    #[test]
    fn energies_are_those_of_the_reference_readme() {
        let expected = [
            ("b_periodic_bip_2000", -959.784306818),
            ("c_grounded_box_bip_2000", -8259.26402368),
            ("c_grounded_box_gau_net_2000", 572_082.054026),
            ("d_grounded_z_periodic_xy_net_2000", 2.230_178_999_92e6),
            ("d_grounded_z_insulating_xy_net_2000", 2.297_463_695_71e6),
            ("d_insulating_box_neutral_2000", 351.631691872),
            ("e_open_bip_2000", -4605.85911498),
        ];
        for (name, energy) in expected {
            let set = by_name(name).unwrap();
            // The README prints twelve digits.
            assert!((set.energy() / energy - 1.0).abs() < 2e-12, "{name}: {}", set.energy());
        }
    }

    #[test]
    fn every_set_is_complete_and_inside_its_box() {
        for set in all() {
            assert!(set.position.iter().all(|point| set.domain.contains(point)), "{}", set.name);
            assert_eq!(set.position.len(), if set.name == "a_nacl_64" { 64 } else { 2000 });
            assert!(set.scale() > 0.0);
        }
    }

    #[test]
    fn open_set_is_the_direct_sum() {
        let set = by_name("e_open_bip_2000").unwrap();
        for at in [0, 977, 1999] {
            let exact = open_sum(1.0, &set.position, &set.charge, at);
            // Rounding of 2000 terms, the largest near 1/0.04².
            assert!((exact.e - set.e[at]).norm() < 1e-9);
            assert!((exact.potential - set.potential[at]).abs() < 1e-10);
        }
    }

    #[test]
    fn cube_has_every_path_and_no_field_at_its_centre() {
        let rows = f_cube_single();
        for path in [CubePath::Face, CubePath::Edge, CubePath::Corner] {
            let last = rows.iter().rfind(|row| row.path == path).unwrap();
            assert_eq!(last.height, 0.5);
            assert!(last.e.norm() < 2e-12);
        }
    }

    #[test]
    fn si_values_carry_coulombs_constant() {
        let set = by_name("a_nacl_64").unwrap();
        assert_eq!(set.potential_si(2.0)[0], 2.0 * set.potential[0]);
        assert_eq!(set.field_si(2.0)[5], 2.0 * set.e[5]);
    }
}
