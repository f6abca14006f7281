//! The mesh's end, as walls are made of it.

use super::{BoundaryFace, FarMesh, Neighbour};
use crate::levels::walls::{BoundaryFaces, Carrier};
use amberfield_core::Domain;
use nalgebra::Vector3;

impl BoundaryFaces for FarMesh {
    fn carrier(&self) -> Carrier {
        Carrier::Cells
    }

    fn faces(&self) -> &[BoundaryFace] {
        self.boundary()
    }

    fn corners_of(&self, face: usize) -> &[Vector3<f64>] {
        self.corners_of(face)
    }

    fn domain(&self) -> &Domain {
        self.domain()
    }

    fn cell_around(&self, face: usize) -> f64 {
        let cell = self.boundary()[face].cell as usize;
        let beside = self.faces_of(cell).iter().filter_map(|face| match face.neighbour {
            Neighbour::Cell { cell, .. } => Some(cell as usize),
            Neighbour::Boundary(_) => None,
        });
        beside.chain([cell]).map(|cell| self.volumes()[cell].cbrt()).fold(0.0, f64::max)
    }

    fn cell_at(&self, face: usize) -> f64 {
        self.volumes()[self.boundary()[face].cell as usize].cbrt()
    }

    fn smallest_cell(&self) -> f64 {
        self.volumes().iter().fold(f64::INFINITY, |least, volume| least.min(volume.cbrt()))
    }

    /// No distance: the back of a sheet without thickness is another wall.
    fn least_solid(&self, _face: usize) -> f64 {
        f64::NEG_INFINITY
    }

    /// Half the cell: the face's own cell is in front of it; the back of a sheet without thickness is not.
    fn least_gap(&self, face: usize) -> f64 {
        let BoundaryFace { normal, centre, cell, .. } = self.boundary()[face];
        normal.dot(&(centre - self.centres()[cell as usize]))
    }

    fn place_of_condition(&self, face: usize) -> Vector3<f64> {
        self.place_of_condition(face)
    }
}
