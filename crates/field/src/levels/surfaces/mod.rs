//! Conductors whose surfaces are triangles: boundary elements.
//!
//! Each facet g has an even density σ_g [C/m²], such that at every centroid c_f
//!
//! Σ_g A_fg σ_g = V_b(f) − φ_given(c_f) − φ_charges(c_f),
//!
//! A_fg the potential at c_f of a unit density on g, V_b the potential of the facet's conductor, φ_given that
//! of electrodes and of the external field, and φ_charges that of the grains and of their images in the
//! surfaces, which carry what changes over less than a facet (`levels/walls`). The left side is a sum over
//! points for the method that has the charges, corrected where points are no even density; where the box has
//! faces the method's sum has their images too, so that what is left of the equation, V − φ, is exact, and A
//! only steers. Between facets σ is linear, by least squares through the facets around (Jackson, Classical
//! Electrodynamics, 3rd ed., §1.13 for the equation).

mod elements;
mod images;
mod matrix;
mod points;
mod unit;

use crate::error::FieldError;
use crate::levels::walls::{Buckets, FacetWalls, Facets};
use crate::numerics::gmres;
use amberfield_core::{Boundary, Conductor, ConductorState, Domain};
use elements::{Element, Elements};
use images::SurfaceImages;
use matrix::Matrix;
use nalgebra::{DMatrix, DVector, Vector3};
use points::Points;
use std::f64::consts::TAU;

/// Distance of two centroids over the size of the other facet up to which its points are corrected.
const NEAR: f64 = 3.0;
/// Depth of the deepest images over that of the deepest charges that are mirrored: in a cavity they lie
/// deeper.
const DEPTH: f64 = 2.0;
/// Residual over the right side at which a solve ends, and most products.
const SOLVED: f64 = 1e-3;
const MOST_PRODUCTS: usize = 60;
/// Residual over the right side of what is kept for the whole run.
const SOLVED_ONCE: f64 = 1e-6;
/// Most facets: their matrix has 1.6 GB.
const MOST_FACETS: usize = 20_000;

/// The conductors' surfaces and the densities on them.
#[derive(Debug)]
pub(crate) struct Surfaces {
    conductors: Vec<Conductor>,
    domain: Domain,
    elements: Elements,
    matrix: Matrix,
    /// Elements near each one.
    near: Vec<Vec<u32>>,
    buckets: Buckets,
    points: Points,
    images: SurfaceImages,
    /// Density that a unit potential [C/m] of each floating conductor makes, and what charges follow.
    floating: Floating,
    /// Potential of each conductor over Coulomb's constant [C/m].
    potentials: Vec<f64>,
    /// Potentials of before, while one conductor alone has one.
    held: Option<Vec<f64>>,
    /// Density whose points are in use, and what the equation makes of it [C/m²].
    in_use: Vec<f64>,
    corrected: Vec<f64>,
}

/// Conductors whose charge is given.
#[derive(Debug, Default)]
struct Floating {
    conductors: Vec<usize>,
    /// Density of a unit potential of each [1/m].
    unit: Vec<Vec<f64>>,
    /// Inverse of the charges of these densities on each [1/m].
    inverse: DMatrix<f64>,
}

impl Surfaces {
    /// Surfaces of conductors in a box, in a medium with this constant 1/(4πε) [V m/C].
    pub(crate) fn new(conductors: &[Conductor], domain: &Domain, coulomb: f64) -> Result<Self, FieldError> {
        let mut elements = Elements::new(conductors);
        check(conductors, domain, &elements)?;
        let corners: Vec<_> = elements.all.iter().map(|element| element.corners).collect();
        let walls = FacetWalls::new(&Facets::new(&corners, domain.clone())?);
        elements.raise(walls.heights());
        let matrix = Matrix::new(&elements, domain);
        let near = near(&elements, domain);
        let potential = |conductor: &Conductor| match conductor.state {
            ConductorState::Potential(volts) => volts / coulomb,
            ConductorState::Charge(_) => 0.0,
        };
        let floating = Floating::new(conductors, &elements, &matrix);
        Ok(Self {
            buckets: points::buckets_of(&elements),
            potentials: conductors.iter().map(potential).collect(),
            conductors: conductors.to_vec(),
            held: None,
            domain: domain.clone(),
            elements,
            matrix,
            near,
            points: Points::default(),
            images: SurfaceImages::new(walls, domain, conductors.len()),
            floating,
            in_use: Vec::new(),
            corrected: Vec::new(),
        })
    }

    /// Lower and upper corner of the box around the facets [m].
    pub(crate) fn bounds(&self) -> [Vector3<f64>; 2] {
        let corners = self.elements.all.iter().flat_map(|element| element.corners);
        let far = Vector3::repeat(f64::INFINITY);
        corners.fold([far, -far], |[low, high], corner| [low.inf(&corner), high.sup(&corner)])
    }

    /// Depth up to which images can lie behind the facets [m].
    pub(crate) fn depth(&self) -> f64 {
        DEPTH * self.images.deepest()
    }

    /// Places at which the potential is prescribed [m].
    pub(crate) fn centres(&self) -> impl ExactSizeIterator<Item = Vector3<f64>> + '_ {
        self.elements.all.iter().map(|element| element.centre)
    }

    /// Begins an evaluation for grains at these places [m], from no density: nothing is kept from one
    /// evaluation to the next, so that a run that is resumed has the field of one that never stopped.
    pub(crate) fn begin(&mut self, grains: &[Vector3<f64>], charges: &[f64]) {
        self.images.find(&self.elements, &self.buckets, grains, charges);
        self.points.place(&self.elements, &self.buckets, grains);
        self.in_use.clear();
        self.in_use.resize(self.elements.len(), 0.0);
        if self.held.is_none() {
            self.floating.conductors.iter().for_each(|&conductor| self.potentials[conductor] = 0.0);
        }
        self.points.charge(&self.elements, &self.in_use);
    }

    /// Takes the corrected density into use, for another look.
    pub(crate) fn look_again(&mut self) {
        std::mem::swap(&mut self.in_use, &mut self.corrected);
        self.points.charge(&self.elements, &self.in_use);
    }

    /// Images of the grains, with their charges [C].
    pub(crate) fn images(&self) -> (&[Vector3<f64>], &[f64]) {
        (&self.images.places, &self.images.charges)
    }

    /// Scale of E below which nothing is resolved, over Coulomb's constant [C/m²]: that of the conductors'
    /// own charge.
    pub(crate) fn least_scale(&self) -> f64 {
        self.elements.mean(&self.in_use, f64::abs).max(f64::MIN_POSITIVE)
    }

    /// Points with the charges [C] of the density in use.
    pub(crate) fn points(&self) -> (&[Vector3<f64>], &[f64]) {
        (&self.points.places, &self.points.charges)
    }

    /// Finds what the density in use is off by from the potentials at the centroids over Coulomb's constant
    /// [C/m], which all charges make, points and images included, and electrodes. Returns the RMS over the
    /// area of the field 2πδσ that is missing, over Coulomb's constant [C/m²].
    pub(crate) fn correct(&mut self, potential: &[f64]) -> f64 {
        let (matrix, domain) = (&self.matrix, &self.domain);
        let shortfall = points::shortfall(
            &self.elements,
            &self.near,
            &self.points,
            &self.in_use,
            |at, of| matrix.entry(at, of),
            |apart| domain.shortest(apart),
        );
        let of_element = |(number, element): (usize, &Element)| {
            self.potentials[element.conductor as usize] - potential[number] - shortfall[number]
        };
        let residual: Vec<f64> = self.elements.all.iter().enumerate().map(of_element).collect();
        let product = |x: &[f64], out: &mut Vec<f64>| self.matrix.product(x, out);
        let mut change = gmres::solve(product, &residual, SOLVED, MOST_PRODUCTS);
        self.float(&mut change);
        let missing = TAU * self.elements.mean(&change, |change| change * change).sqrt();
        self.corrected.clear();
        self.corrected.extend(self.in_use.iter().zip(&change).map(|(now, change)| now + change));
        missing
    }

    /// Adds to a change of the density what gives floating conductors their charge.
    fn float(&mut self, change: &mut [f64]) {
        let Floating { conductors, unit, inverse } = &self.floating;
        if conductors.is_empty() || self.held.is_some() {
            return;
        }
        let mut lacking = DVector::from_fn(conductors.len(), |row, _| {
            let conductor = conductors[row];
            match self.conductors[conductor].state {
                ConductorState::Charge(charge) => charge - self.images.of_conductor[conductor],
                ConductorState::Potential(_) => 0.0,
            }
        });
        for (number, element) in self.elements.all.iter().enumerate() {
            if let Some(row) = conductors.iter().position(|conductor| *conductor as u32 == element.conductor)
            {
                lacking[row] -= element.area * (self.in_use[number] + change[number]);
            }
        }
        let potentials = inverse * lacking;
        for ((&conductor, unit), by) in conductors.iter().zip(unit).zip(potentials.iter()) {
            self.potentials[conductor] += by;
            change.iter_mut().zip(unit).for_each(|(change, unit)| *change += by * unit);
        }
    }

    /// Potential of each conductor over Coulomb's constant [C/m].
    pub(crate) fn potentials(&self) -> &[f64] {
        &self.potentials
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        self.matrix.memory_bytes() + self.points.memory_bytes() + 200 * self.elements.len()
    }
}

impl Floating {
    fn new(conductors: &[Conductor], elements: &Elements, matrix: &Matrix) -> Self {
        let floats = |conductor: &Conductor| matches!(conductor.state, ConductorState::Charge(_));
        let numbers: Vec<usize> = (0..conductors.len()).filter(|&k| floats(&conductors[k])).collect();
        let of_conductor = |&conductor: &usize| {
            let unit = |element: &Element| f64::from(u8::from(element.conductor as usize == conductor));
            let right: Vec<f64> = elements.all.iter().map(unit).collect();
            gmres::solve(|x, out| matrix.product(x, out), &right, SOLVED_ONCE, MOST_PRODUCTS)
        };
        let unit: Vec<Vec<f64>> = numbers.iter().map(of_conductor).collect();
        let of_unit: Vec<Vec<f64>> =
            unit.iter().map(|one| charges(elements, one, conductors.len())).collect();
        let capacities =
            DMatrix::from_fn(numbers.len(), numbers.len(), |row, column| of_unit[column][numbers[row]]);
        let inverse = capacities.try_inverse().unwrap_or_default();
        Self { conductors: numbers, unit, inverse }
    }
}

/// Charge of a density on each of so many conductors.
fn charges(elements: &Elements, density: &[f64], conductors: usize) -> Vec<f64> {
    let mut charges = vec![0.0; conductors];
    for (element, density) in elements.all.iter().zip(density) {
        charges[element.conductor as usize] += element.area * density;
    }
    charges
}

/// Elements near each one, itself included.
fn near(elements: &Elements, domain: &Domain) -> Vec<Vec<u32>> {
    let of_element = |at: &Element| {
        let is_near = |(_, of): &(u32, &Element)| {
            domain.shortest(at.centre - of.centre).norm() < NEAR * at.size.max(of.size)
        };
        (0..).zip(&elements.all).filter(is_near).map(|(number, _)| number).collect()
    };
    elements.all.iter().map(of_element).collect()
}

/// Refuses surfaces that have no field.
fn check(conductors: &[Conductor], domain: &Domain, elements: &Elements) -> Result<(), FieldError> {
    let refuse = |text: String| Err(FieldError::Settings(text));
    if elements.len() > MOST_FACETS {
        let memory = 4e-9 * (elements.len() as f64).powi(2);
        return refuse(format!(
            "{} facets of conductors need a matrix of {memory:.1} GB; give coarser surfaces, of \
             {MOST_FACETS} facets at most",
            elements.len()
        ));
    }
    if domain.needs_neutrality() {
        return refuse(
            "conductors in a box whose faces are all insulating or periodic have no potential to be compared \
             with; open or ground a face"
                .into(),
        );
    }
    for conductor in conductors {
        let surface = &conductor.surface;
        if surface.triangles.is_empty() {
            return refuse(format!("conductor {} has no triangles", conductor.name));
        }
        if surface.vertices.iter().flatten().any(|x| !x.is_finite()) {
            return refuse(format!("conductor {} has a corner that is not finite", conductor.name));
        }
        let is_closed = |boundary| !matches!(boundary, Boundary::Open | Boundary::Periodic);
        let beyond = surface.bounds().and_then(|bounds| domain.farthest_beyond(&bounds, is_closed));
        if let Some((face, _)) = beyond {
            return refuse(format!(
                "conductor {} reaches beyond {face}, which is no open face of the domain; move the face or \
                 cut the surface there",
                conductor.name
            ));
        }
    }
    Ok(())
}
