//! Boundary elements: the facets of the conductors' surfaces, each with an even density.

use amberfield_core::{Conductor, SMOOTH_ANGLE, TriangleMesh};
use nalgebra::{Matrix3, Vector3};

/// Weight of the normal direction in the fit of a slope, which has none along it.
const ACROSS: f64 = 1.0;
/// Elements around another one from which a slope can be told.
const LEAST_AROUND: usize = 3;

/// A facet.
#[derive(Clone, Debug)]
pub(super) struct Element {
    /// Corners [m].
    pub(super) corners: [Vector3<f64>; 3],
    /// Centroid, at which the potential is prescribed [m].
    pub(super) centre: Vector3<f64>,
    /// Unit normal; nothing is known of its sense.
    pub(super) normal: Vector3<f64>,
    /// Area [m²].
    pub(super) area: f64,
    /// Edge of the equilateral triangle of the same area [m].
    pub(super) size: f64,
    /// Distance of the farthest corner from the centroid [m].
    pub(super) radius: f64,
    /// Conductor that it belongs to.
    pub(super) conductor: u32,
}

impl Element {
    fn new(corners: [Vector3<f64>; 3], conductor: u32) -> Option<Self> {
        let [a, b, c] = corners;
        let across = (b - a).cross(&(c - a));
        let area = 0.5 * across.norm();
        let centre = (a + b + c) / 3.0;
        let radius = corners.iter().map(|corner| (corner - centre).norm()).fold(0.0, f64::max);
        let normal = across.try_normalize(f64::MIN_POSITIVE)?;
        let size = TriangleMesh::size_of(area);
        Some(Self { corners, centre, normal, area, size, radius, conductor })
    }

    /// Distance of a point from the facet, or a little less [m].
    pub(super) fn distance_at_least(&self, point: &Vector3<f64>) -> f64 {
        let apart = point - self.centre;
        apart.dot(&self.normal).abs().max(apart.norm() - self.radius)
    }
}

/// All facets.
#[derive(Clone, Debug)]
pub(super) struct Elements {
    pub(super) all: Vec<Element>,
    /// Elements that share a corner with each and go on smoothly.
    around: Vec<Vec<u32>>,
    /// Inverse of each facet's least squares for a slope; zero where there are too few others.
    fits: Vec<Matrix3<f64>>,
}

impl Elements {
    /// Elements of conductors, in their order; those without area are left out.
    pub(super) fn new(conductors: &[Conductor]) -> Self {
        let (mut all, mut around) = (Vec::new(), Vec::new());
        for (conductor, number) in conductors.iter().zip(0..) {
            let first = all.len() as u32;
            let surface = &conductor.surface;
            let mut at_vertex = vec![Vec::new(); surface.vertices.len()];
            let mut vertices = Vec::new();
            for triangle in &surface.triangles {
                let corners = triangle.map(|vertex| surface.vertices[vertex as usize]);
                let Some(element) = Element::new(corners, number) else { continue };
                triangle.iter().for_each(|&vertex| at_vertex[vertex as usize].push(all.len() as u32));
                all.push(element);
                vertices.push(*triangle);
            }
            let of_element = |(element, triangle): (u32, &[u32; 3])| {
                let here: &Element = &all[element as usize];
                let share = triangle.iter().flat_map(|&vertex| &at_vertex[vertex as usize]).copied();
                let is_smooth = |other: &u32| {
                    *other != element
                        && here.normal.dot(&all[*other as usize].normal).abs() > SMOOTH_ANGLE.cos()
                };
                let mut found: Vec<u32> = share.filter(is_smooth).collect();
                found.sort_unstable();
                found.dedup();
                found
            };
            around.extend((first..).zip(&vertices).map(of_element));
        }
        let mut elements = Self { all, around, fits: Vec::new() };
        elements.fits = (0..elements.all.len()).map(|element| elements.fit(element)).collect();
        elements
    }

    /// Moves each facet along its normal, so that it lies as much before the surface as behind it.
    pub(super) fn raise(&mut self, heights: &[f64]) {
        for (element, &height) in self.all.iter_mut().zip(heights) {
            let step = element.normal * height;
            element.centre += step;
            element.corners = element.corners.map(|corner| corner + step);
        }
    }

    /// Mean over the area of a function of a density.
    pub(super) fn mean(&self, density: &[f64], function: impl Fn(f64) -> f64) -> f64 {
        let area: f64 = self.all.iter().map(|element| element.area).sum();
        let parts = self.all.iter().zip(density).map(|(element, x)| element.area * function(*x));
        parts.sum::<f64>() / area
    }

    pub(super) fn len(&self) -> usize {
        self.all.len()
    }

    /// Inverse of the normal equations of a slope within a facet's plane.
    fn fit(&self, element: usize) -> Matrix3<f64> {
        if self.around[element].len() < LEAST_AROUND {
            return Matrix3::zeros();
        }
        let normal = self.all[element].normal;
        let across = ACROSS * normal * normal.transpose();
        let sum = self.steps(element).fold(across, |sum, (step, _)| sum + step * step.transpose());
        sum.try_inverse().unwrap_or_default()
    }

    /// Unit steps in a facet's plane to those around it, with one over the length of each and its number.
    fn steps(&self, element: usize) -> impl Iterator<Item = (Vector3<f64>, (f64, u32))> + '_ {
        let here = &self.all[element];
        self.around[element].iter().filter_map(move |&other| {
            let apart = self.all[other as usize].centre - here.centre;
            let within = apart - here.normal * here.normal.dot(&apart);
            let length = within.norm();
            (length > 0.0).then(|| (within / length, (1.0 / length, other)))
        })
    }

    /// Slope of a density along a facet, by least squares through those around it, near ones first.
    pub(super) fn slope(&self, element: usize, density: &[f64]) -> Vector3<f64> {
        let right = self.steps(element).fold(Vector3::zeros(), |sum, (step, (per_length, other))| {
            sum + step * ((density[other as usize] - density[element]) * per_length)
        });
        self.fits[element] * right
    }
}
