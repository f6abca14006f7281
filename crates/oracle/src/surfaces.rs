//! Reference fields of point charges before conductors of any shape, from `reference/surfaces` (its README
//! says how they were found). Units with 4πε₀ = 1.

use crate::reference::{Charges, charges_of};
use amberfield_core::{TriangleMesh, Vector3};
use std::collections::HashMap;

/// Charges before a conductor in open space.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceProblem {
    /// The conductor's surface. Corners lie on the true one, facets are chords of it.
    pub surface: TriangleMesh,
    /// Charges, with potential and field that act on each.
    pub charges: Charges,
}

/// Charges inside a grounded sphere of radius 1.
#[must_use]
pub fn sphere_inside() -> SurfaceProblem {
    problem(
        include_bytes!("../reference/surfaces/sphere.stl"),
        include_str!("../reference/surfaces/sphere_inside.csv"),
    )
}

/// Charges outside a floating sphere of radius 1 in a uniform field.
#[must_use]
pub fn sphere_floating() -> SurfaceProblem {
    problem(
        include_bytes!("../reference/surfaces/sphere.stl"),
        include_str!("../reference/surfaces/sphere_floating.csv"),
    )
}

/// Charges on both sides of a thin disc of radius 1 at a potential.
#[must_use]
pub fn disc_potential() -> SurfaceProblem {
    problem(
        include_bytes!("../reference/surfaces/disc.stl"),
        include_str!("../reference/surfaces/disc_potential.csv"),
    )
}

/// Number that goes with a problem, by its name in `totals.csv`.
///
/// # Panics
/// If there is none.
#[must_use]
pub fn total(problem: &str, quantity: &str) -> f64 {
    let start = format!("{problem},{quantity},");
    let lines = include_str!("../reference/surfaces/totals.csv").lines();
    let value = lines.filter_map(|line| line.strip_prefix(start.as_str())).next();
    value.and_then(|value| value.trim().parse().ok()).expect("a total of this name")
}

fn problem(stl: &[u8], table: &str) -> SurfaceProblem {
    SurfaceProblem { surface: mesh(stl), charges: charges_of(table) }
}

/// Triangles of a binary STL file; equal corners are one vertex.
fn mesh(stl: &[u8]) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    let mut numbers: HashMap<[u8; 12], u32> = HashMap::new();
    let (triangles, _) = stl[84..].as_chunks::<50>();
    for triangle in triangles {
        let corners = [12, 24, 36].map(|begin| {
            let bytes: [u8; 12] = triangle[begin..begin + 12].try_into().expect("twelve bytes");
            let number =
                |k: usize| f64::from(f32::from_le_bytes(bytes[k..k + 4].try_into().expect("four bytes")));
            *numbers.entry(bytes).or_insert_with(|| {
                mesh.vertices.push(Vector3::new(number(0), number(4), number(8)));
                mesh.vertices.len() as u32 - 1
            })
        });
        mesh.triangles.push(corners);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surfaces_are_whole() {
        let sphere = sphere_inside().surface;
        assert_eq!((sphere.vertices.len(), sphere.triangles.len()), (642, 1280));
        assert!(sphere.rim().is_empty() && sphere.vertices.iter().all(|x| (x.norm() - 1.0).abs() < 1e-6));
        let disc = disc_potential().surface;
        assert_eq!(disc.triangles.len(), 1176);
        assert!(disc.rim().iter().flatten().all(|x| (x.norm() - 1.0).abs() < 1e-6));
    }

    #[test]
    fn energy_is_half_of_charges_times_potentials() {
        let Charges { charge, potential, .. } = sphere_inside().charges;
        let energy: f64 = charge.iter().zip(&potential).map(|(q, v)| 0.5 * q * v).sum();
        assert!((energy / total("sphere_inside", "half sum q phi") - 1.0).abs() < 1e-12);
    }
}
