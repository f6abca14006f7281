//! Parts of a mesh that no face joins: each has a potential of its own, and must take its own charge.

use super::{Condition, FarMesh, FarMeshParts, Neighbour};
use crate::error::FieldError;
use crate::geometry::inputs::NET_CHARGE_ROUND_OFF;
use amberfield_core::Permittivity;
use nalgebra::Vector3;

/// Parts of a mesh that no face joins.
#[derive(Clone, Debug)]
pub(crate) struct ConnectedParts {
    /// Part of each cell.
    of_cell: Vec<u32>,
    parts: Vec<ConnectedPart>,
}

/// Cells that faces join, cyclic ones included.
#[derive(Clone, Copy, Debug)]
struct ConnectedPart {
    cells: usize,
    /// Whether a face of it prescribes the potential.
    has_conductor: bool,
    /// Corners of the box of its cells' centres [m].
    low: Vector3<f64>,
    high: Vector3<f64>,
    /// Sum over its faces of prescribed slope times area, and of its absolute value [V m].
    slopes: f64,
    absolute_slopes: f64,
}

const UNKNOWN: u32 = u32::MAX;

impl ConnectedParts {
    pub(super) fn new(parts: &FarMeshParts) -> Self {
        let mut of_cell = vec![UNKNOWN; parts.centres.len()];
        let mut found = Vec::new();
        let mut waiting = Vec::new();
        for first in 0..of_cell.len() {
            if of_cell[first] != UNKNOWN {
                continue;
            }
            let number = found.len() as u32;
            let centre = parts.centres[first];
            let mut part = ConnectedPart {
                cells: 0,
                has_conductor: false,
                low: centre,
                high: centre,
                slopes: 0.0,
                absolute_slopes: 0.0,
            };
            of_cell[first] = number;
            waiting.push(first);
            while let Some(cell) = waiting.pop() {
                part.cells += 1;
                (part.low, part.high) =
                    (part.low.inf(&parts.centres[cell]), part.high.sup(&parts.centres[cell]));
                for face in &parts.faces[parts.first_face[cell] as usize..parts.first_face[cell + 1] as usize]
                {
                    match face.neighbour {
                        Neighbour::Cell { cell: other, .. } if of_cell[other as usize] == UNKNOWN => {
                            of_cell[other as usize] = number;
                            waiting.push(other as usize);
                        }
                        Neighbour::Cell { .. } => {}
                        Neighbour::Boundary(index) => part.close(parts, index as usize),
                    }
                }
            }
            found.push(part);
        }
        Self { of_cell, parts: found }
    }
}

impl ConnectedPart {
    /// Takes a boundary face in.
    fn close(&mut self, parts: &FarMeshParts, index: usize) {
        let face = &parts.boundary[index];
        match face.condition {
            Condition::Potential(_) => self.has_conductor = true,
            Condition::Slope(slope) => {
                self.slopes += slope * face.area;
                self.absolute_slopes += (slope * face.area).abs();
            }
        }
    }
}

/// Refuses a net charge [C] that no face of its part of a mesh takes, in a medium of a permittivity; `cells`
/// are the charges' cells.
pub(crate) fn check_net_charge(
    mesh: &FarMesh,
    permittivity: Permittivity,
    neutralising_background: bool,
    charges: &[f64],
    cells: &[u32],
) -> Result<(), FieldError> {
    if neutralising_background {
        return Ok(());
    }
    let ConnectedParts { of_cell, parts } = mesh.connected();
    for (number, part) in parts.iter().enumerate().filter(|(_, part)| !part.has_conductor) {
        let here = |cell: &u32| of_cell[*cell as usize] as usize == number;
        let of_part = || charges.iter().zip(cells).filter(|(_, cell)| here(cell)).map(|(charge, _)| *charge);
        let net_charge_c = of_part().sum::<f64>() + permittivity.absolute() * part.slopes;
        let all = of_part().map(f64::abs).sum::<f64>() + permittivity.absolute() * part.absolute_slopes;
        if net_charge_c.abs() <= NET_CHARGE_ROUND_OFF * all {
            continue;
        }
        return Err(match parts.len() {
            1 => FieldError::NetCharge { net_charge_c },
            _ => FieldError::NetChargeOfPart {
                net_charge_c,
                cells: part.cells,
                all_cells: of_cell.len(),
                low_m: part.low.into(),
                high_m: part.high.into(),
            },
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::{Boundary, Domain};

    /// An insulating box that a wall cuts in two across x, with a slope on one of the wall's sides.
    fn divided(slope: f64) -> FarMesh {
        let insulating = Boundary::Insulating { normal_field_v_m: 0.0 };
        let domain =
            Domain::new(Vector3::zeros(), Vector3::new(4.0, 2.0, 2.0), [[insulating; 2]; 3]).unwrap();
        let mut parts = FarMeshParts::of_box(&domain, [4, 2, 2]).unwrap();
        for cell in 0..parts.centres.len() {
            for number in parts.first_face[cell] as usize..parts.first_face[cell + 1] as usize {
                let face = parts.faces[number];
                if face.normal.x == 0.0 || (face.offset.abs() - 3.0).abs() > 1e-9 {
                    continue;
                }
                let slope = if face.normal.x < 0.0 { slope } else { 0.0 };
                parts.end_at(cell, number, 1.0, Condition::Slope(slope));
            }
        }
        FarMesh::new(parts).unwrap()
    }

    #[test]
    fn each_part_must_take_its_own_charge() {
        let vacuum = Permittivity::VACUUM;
        let check = |mesh: &FarMesh, charges: &[f64], cells: &[u32], background| {
            check_net_charge(mesh, vacuum, background, charges, cells)
        };
        let mesh = divided(0.0);
        assert!(check(&mesh, &[1e-12, -1e-12], &[0, 1], false).is_ok());
        let refused = check(&mesh, &[1e-12, -1e-12], &[0, 3], false).unwrap_err();
        let said = refused.to_string();
        assert!(said.contains("net charge 1e-12 C") && said.contains("12 of 16 cells"), "{said}");
        assert!(check(&mesh, &[1e-12, -1e-12], &[0, 3], true).is_ok());
        // The slope of the wall takes the charge of the lower half, of four faces.
        let charge = 4.0 * 100.0 * vacuum.absolute();
        assert!(check(&divided(100.0), &[-charge], &[3], false).is_ok());
        assert!(check(&divided(100.0), &[-charge], &[2], false).is_err());
    }
}
