//! A far field solved in this process, on equal cells of a box: the twin of the solver process for tests and
//! comparisons.
//!
//! Seven-point finite volumes with walls at cell faces, as OpenFOAM's `Gauss linear` makes of such a mesh,
//! and conjugate gradients.

use amberfield_core::{Domain, FaceCourse, PotentialCourse, SourceCloud, Vector3};
use amberfield_field::FieldError;
use amberfield_field::far::{
    Condition, FarField, FarMesh, FarMeshParts, FarRequest, FarValues, Neighbour, SmoothDensity,
};

/// Relative residual at which the solver stops.
const RESIDUAL: f64 = 1e-10;
/// Iterations at most.
const MOST_ITERATIONS: u64 = 10_000;

/// Finite volumes on a box.
#[derive(Debug)]
pub struct BoxSolver {
    mesh: FarMesh,
    density: Option<(SourceCloud, SmoothDensity)>,
    /// Potentials of the patches that change, in their order.
    courses: Vec<PotentialCourse>,
}

impl BoxSolver {
    /// `counts` equal cells in a domain without open faces.
    ///
    /// # Errors
    /// Open faces.
    pub fn new(domain: &Domain, counts: [usize; 3]) -> Result<Self, FieldError> {
        Self::over(FarMeshParts::of_box(domain, counts)?)
    }

    /// Cells as [`FarMeshParts::of_box`] makes them, with sheets between them or without.
    ///
    /// # Errors
    /// Parts that make no sense.
    pub fn over(parts: FarMeshParts) -> Result<Self, FieldError> {
        Ok(Self { mesh: FarMesh::new(parts)?, density: None, courses: Vec::new() })
    }

    /// `counts` equal cells in a domain without open faces, with the domain's potentials that change.
    ///
    /// # Errors
    /// Open faces.
    pub fn changing(domain: &Domain, counts: [usize; 3]) -> Result<Self, FieldError> {
        let mut parts = FarMeshParts::of_box(domain, counts)?;
        let patch = |face: &FaceCourse| 2 * face.axis.index() as u32 + face.side as u32;
        parts.changing = domain.courses().iter().map(patch).collect();
        for face in &mut parts.boundary {
            if parts.changing.contains(&face.patch) {
                face.condition = Condition::Potential(0.0);
            }
        }
        let courses = domain.courses().iter().map(|face| face.course.clone()).collect();
        Ok(Self { courses, ..Self::over(parts)? })
    }

    /// Charge of each cell [C].
    fn charge_of_cells(&mut self, request: &FarRequest<'_>, cells: &[u32]) -> Vec<f64> {
        let mut charge = vec![0.0; self.mesh.cell_count()];
        let cloud = request.question.cloud;
        if cloud.is_nearest_cell() {
            for (&cell, q) in cells.iter().zip(request.charges) {
                charge[cell as usize] += q;
            }
            return charge;
        }
        if self.density.as_ref().is_none_or(|(known, _)| *known != cloud) {
            let whole = self.mesh.domain();
            let density = SmoothDensity::new(whole, whole.min(), whole.max(), cloud.radius_m, cloud.shape);
            self.density = Some((cloud, density));
        }
        let (_, density) = self.density.as_mut().expect("just made");
        density.clear();
        density.add(request.positions, request.charges);
        density.add(request.image_positions, request.image_charges);
        density.at(self.mesh.centres(), &mut charge);
        for (charge, more) in charge.iter_mut().zip(request.density) {
            *charge += more;
        }
        for (charge, volume) in charge.iter_mut().zip(self.mesh.volumes()) {
            *charge *= volume;
        }
        charge
    }

    /// Σ over the faces of area/distance (φ_here − φ_beyond), boundary values apart.
    fn apply(&self, potential: &[f64], out: &mut [f64]) {
        for (cell, out) in out.iter_mut().enumerate() {
            *out = 0.0;
            for face in self.mesh.faces_of(cell) {
                match face.neighbour {
                    Neighbour::Cell { cell: other, shift } => {
                        let across = self.mesh.centres()[other as usize] + shift - self.mesh.centres()[cell];
                        let conductance = self.mesh.volumes()[cell] / across.norm_squared();
                        *out += conductance * (potential[cell] - potential[other as usize]);
                    }
                    Neighbour::Boundary(index) => {
                        let face = &self.mesh.boundary()[index as usize];
                        if face.gives_potential() {
                            let distance = (face.centre - self.mesh.centres()[cell]).norm();
                            *out += face.area / distance * potential[cell];
                        }
                    }
                }
            }
        }
    }

    /// E of a cell by Gauss' theorem, linear between centres [V/m].
    fn field(&self, cell: usize, potential: &[f64], boundary: &[f64]) -> Vector3<f64> {
        let (here, volume) = (self.mesh.centres()[cell], self.mesh.volumes()[cell]);
        let on_faces = self.mesh.faces_of(cell).iter().map(|face| {
            let (value, across) = match face.neighbour {
                Neighbour::Cell { cell: other, shift } => {
                    let across = self.mesh.centres()[other as usize] + shift - here;
                    (0.5 * (potential[cell] + potential[other as usize]), across.norm())
                }
                Neighbour::Boundary(index) => {
                    let half = face.offset - face.normal.dot(&here);
                    let value = match self.mesh.boundary()[index as usize].condition {
                        Condition::Potential(_) => boundary[index as usize],
                        Condition::Slope(_) => potential[cell] + half * boundary[index as usize],
                    };
                    (value, 2.0 * half)
                }
            };
            face.normal * (value * volume / across)
        });
        -on_faces.sum::<Vector3<f64>>() / volume
    }
}

impl FarField for BoxSolver {
    fn mesh(&self) -> &FarMesh {
        &self.mesh
    }

    fn potentials(&mut self, times_s: &[f64], values: &mut Vec<f64>) -> Result<(), FieldError> {
        values.clear();
        values.extend(self.courses.iter().flat_map(|course| times_s.iter().map(|time_s| course.at(*time_s))));
        Ok(())
    }

    fn solve(&mut self, request: &FarRequest<'_>, values: &mut FarValues) -> Result<(), FieldError> {
        values.cells.clear();
        values.outside = 0;
        for position in request.positions {
            let (cell, inside) = self.mesh.locate(position, None);
            values.cells.push(cell);
            values.outside += u64::from(!inside);
        }
        let mut source = self.charge_of_cells(request, &values.cells);
        for source in &mut source {
            *source /= request.question.permittivity_f_m;
        }
        for (face, value) in self.mesh.boundary().iter().zip(request.boundary) {
            source[face.cell as usize] += match face.condition {
                Condition::Potential(_) => {
                    face.area / (face.centre - self.mesh.centres()[face.cell as usize]).norm() * value
                }
                Condition::Slope(_) => face.area * value,
            };
        }
        if !self.mesh.has_conductor() {
            let mean = source.iter().sum::<f64>() / source.len() as f64;
            source.iter_mut().for_each(|source| *source -= mean);
        }
        let count = source.len();
        values.potential.resize(count, 0.0);
        if request.guess.len() == count {
            values.potential.copy_from_slice(request.guess);
        }
        let mut product = vec![0.0; count];
        self.apply(&values.potential, &mut product);
        let mut rest: Vec<f64> = source.iter().zip(&product).map(|(b, a)| b - a).collect();
        let mut direction = rest.clone();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (aim, mut square) = (RESIDUAL * RESIDUAL * dot(&source, &source), dot(&rest, &rest));
        values.iterations = 0;
        while square > aim && values.iterations < MOST_ITERATIONS {
            values.iterations += 1;
            self.apply(&direction, &mut product);
            let step = square / dot(&direction, &product);
            for i in 0..count {
                values.potential[i] += step * direction[i];
                rest[i] -= step * product[i];
            }
            let next = dot(&rest, &rest);
            for i in 0..count {
                direction[i] = rest[i] + next / square * direction[i];
            }
            square = next;
        }
        values.residual = if aim > 0.0 { RESIDUAL * (square / aim).sqrt() } else { 0.0 };
        values.e.clear();
        if request.question.wants_e != 0 {
            values.e.extend((0..count).map(|cell| self.field(cell, &values.potential, request.boundary)));
        }
        Ok(())
    }
}
