//! Region in which grains are placed.

use super::spec::GenerateContext;
use super::surfaces::Surfaces;
use crate::SceneError;
use crate::table::SceneTable;
use crate::tree::Value;
use amberfield_core::{Axis, Domain, Volume, Wall, WallShape};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;

/// Share of their radius by which grains stay away from walls and faces, so that rounding makes no contact.
const CLEARANCE: f64 = 1e-6;
/// Share of the domain's size by which a region that fills a period may end before it, because of rounding.
const SLACK: f64 = 1e-9;

/// Number of places at which it is asked on which side of a closed surface a region lies.
const PLACES: usize = 200;

/// Plane wall that bounds a region.
#[derive(Clone, Debug)]
struct BoundingPlane {
    /// Point on the plane [m].
    point: Vector3<f64>,
    /// Unit normal into the region.
    normal: Vector3<f64>,
}

/// Region, the axes along which it is periodic, and the planes that bound it.
#[derive(Clone, Debug)]
pub(super) struct Region {
    shape: Volume,
    /// Lower corner of the bounding box [m].
    pub(super) min: Vector3<f64>,
    /// Upper corner of the bounding box [m].
    pub(super) max: Vector3<f64>,
    /// Flag of an axis along which the region is one period of the domain.
    pub(super) periodic: [bool; 3],
    planes: Vec<BoundingPlane>,
    surfaces: Surfaces,
}

/// Reads the key `region`.
///
/// The value is `"box"` (the domain), `{ box = { min_m, max_m } }` or
/// `{ cylinder = { base_m, axis, radius_m, length_m } }` (or `top_m` in place of axis and length).
pub(super) fn read_region(
    parent: &SceneTable<'_>,
    context: &GenerateContext<'_>,
) -> Result<Region, SceneError> {
    let domain = context.domain;
    let whole = || Volume::Box { min: domain.min(), max: domain.max() };
    let forms = "\"box\" (the domain), { box = { min_m, max_m } } or \
                 { cylinder = { base_m, axis, radius_m, length_m } }";
    let table = parent.table("region")?;
    let shape = match table {
        None => whole(),
        Some(table) => read_volume(parent, &table, forms)?,
    };
    Region::new(shape, domain, context.walls).map_err(|problem| parent.bad("region", problem))
}

/// Reads a box or a cylinder from a table `region` that takes `forms`.
pub(crate) fn read_volume(
    parent: &SceneTable<'_>,
    table: &SceneTable<'_>,
    forms: &str,
) -> Result<Volume, SceneError> {
    match (table.table("box")?, table.table("cylinder")?) {
        (Some(block), None) => read_box(&block),
        (None, Some(cylinder)) => read_cylinder(&cylinder),
        _ => Err(parent.bad("region", format!("give exactly one of {forms}"))),
    }
}

fn read_box(table: &SceneTable<'_>) -> Result<Volume, SceneError> {
    let (min, max) = (table.need_vector("min_m")?, table.need_vector("max_m")?);
    if (0..3).all(|axis| max[axis] > min[axis]) {
        Ok(Volume::Box { min, max })
    } else {
        Err(table.bad("max_m", "not above min_m along every axis; exchange the corners"))
    }
}

fn read_cylinder(table: &SceneTable<'_>) -> Result<Volume, SceneError> {
    let base = table.need_vector("base_m")?;
    let radius = table.need_number("radius_m")?;
    let along = match table.vector("top_m")? {
        Some(_) if table.has("axis") || table.has("length_m") => {
            return Err(
                table.bad("top_m", "axis or length_m is given too; give either top_m or axis and length_m")
            );
        }
        Some(top) => top - base,
        None => {
            let axis = match table.get("axis").map(|node| &node.value) {
                None | Some(Value::Text(_)) => {
                    let words = [("x", Vector3::x()), ("y", Vector3::y()), ("z", Vector3::z())];
                    table.word("axis", &words)?.unwrap_or_else(Vector3::z)
                }
                Some(_) => table.need_vector("axis")?,
            };
            let length = table.need_number("length_m")?;
            if axis.norm() < 1e-100 {
                return Err(table.bad("axis", "the axis has no direction; give \"z\" or a vector"));
            }
            axis.normalize() * length
        }
    };
    let length = along.norm();
    if length > 0.0 {
        Ok(Volume::Cylinder { base, axis: along / length, radius, length })
    } else {
        Err(table.bad("top_m", "the cylinder has no length; move it away from base_m"))
    }
}

impl Region {
    fn new(shape: Volume, domain: &Domain, walls: &[Wall]) -> Result<Self, String> {
        let [min, max] = shape.bounds();
        if let Some(overrun) = domain.overrun(&[min, max]) {
            return Err(format!("{overrun}; shrink it"));
        }
        let mut periodic = [false; 3];
        for axis in Axis::ALL {
            let k = axis.index();
            let slack = SLACK * domain.extent()[k];
            let whole = min[k] <= domain.min()[k] + slack && max[k] >= domain.max()[k] - slack;
            // A region wraps only where it is a whole period and its ends fit together.
            periodic[k] = domain.is_periodic(axis) && whole && is_prism_along(&shape, k);
        }
        let planes = walls
            .iter()
            .filter_map(|wall| match wall.shape {
                WallShape::Plane { point, normal } => Some(BoundingPlane { point, normal }),
                WallShape::Mesh(_) => None,
            })
            .collect();
        let meshes = || {
            walls
                .iter()
                .filter_map(|wall| if let WallShape::Mesh(mesh) = &wall.shape { Some(mesh) } else { None })
        };
        let mut region =
            Self { shape, min, max, periodic, planes, surfaces: Surfaces::new([].into_iter(), &[]) };
        // Places all over the region, always the same ones.
        let mut random = ChaCha8Rng::seed_from_u64(0);
        let places: Vec<_> = (0..PLACES).filter_map(|_| region.draw(0.0, &mut random)).collect();
        region.surfaces = Surfaces::new(meshes(), &places);
        Ok(region)
    }

    /// Volume [m³], walls not subtracted.
    pub(super) fn volume(&self) -> f64 {
        self.shape.size()
    }

    /// Draws a random point for the centre of a grain of a radius [m]; `None` where a wall is too near or the
    /// grain is too large.
    pub(super) fn draw(&self, radius: f64, random: &mut ChaCha8Rng) -> Option<Vector3<f64>> {
        let mut uniform =
            |low: f64, high: f64| if high > low { low + (high - low) * random.random::<f64>() } else { low };
        let inset = radius * (1.0 + CLEARANCE);
        let mut point = Vector3::zeros();
        match &self.shape {
            Volume::Box { min, max } => {
                for axis in 0..3 {
                    let inset = if self.periodic[axis] { 0.0 } else { inset };
                    point[axis] = uniform(min[axis] + inset, max[axis] - inset);
                }
            }
            Volume::Cylinder { base, axis, radius: outer, length } => {
                let ends = if self.wraps_along(axis) { 0.0 } else { inset };
                let along = uniform(ends, length - ends);
                let [first, second] = perpendicular(axis);
                // The root makes the density uniform over the disc.
                let distance = (outer - inset).max(0.0) * uniform(0.0, 1.0).sqrt();
                let angle = uniform(0.0, 2.0 * PI);
                point = base + axis * along + (first * angle.cos() + second * angle.sin()) * distance;
            }
        }
        self.allows(&point, radius).then_some(point)
    }

    /// Tells whether a grain of a radius [m] may have its centre at a point [m].
    pub(super) fn allows(&self, point: &Vector3<f64>, radius: f64) -> bool {
        let nearest = self.nearest_allowed(*point, radius, 0.5 * CLEARANCE);
        (nearest - point).amax() <= 0.4 * CLEARANCE * radius
            && self.surfaces.allow(point, radius * (1.0 + 0.1 * CLEARANCE))
    }

    /// Moves a point [m] to where a grain of a radius [m] touches neither faces nor walls.
    pub(super) fn confine(&self, point: Vector3<f64>, radius: f64) -> Vector3<f64> {
        self.nearest_allowed(point, radius, CLEARANCE)
    }

    /// Moves a point [m] away from faces and walls, by the radius [m] and a share of it.
    fn nearest_allowed(&self, mut point: Vector3<f64>, radius: f64, clearance: f64) -> Vector3<f64> {
        let inset = radius * (1.0 + clearance);
        for BoundingPlane { point: on_plane, normal } in &self.planes {
            let distance = (point - on_plane).dot(normal);
            if distance < inset {
                point += normal * (inset - distance);
            }
        }
        point = self.surfaces.push_off(point, inset);
        match &self.shape {
            Volume::Box { min, max } => {
                for axis in 0..3 {
                    if !self.periodic[axis] {
                        point[axis] = point[axis].min(max[axis] - inset).max(min[axis] + inset);
                    }
                }
            }
            Volume::Cylinder { base, axis, radius: outer, length } => {
                let along = (point - base).dot(axis);
                let across = point - base - axis * along;
                let along = if self.wraps_along(axis) { along } else { along.min(length - inset).max(inset) };
                let limit = (outer - inset).max(0.0);
                let distance = across.norm();
                let across = if distance > limit { across * (limit / distance) } else { across };
                point = base + axis * along + across;
            }
        }
        self.wrap(point)
    }

    /// Tells whether the region is periodic along a cylinder's axis.
    fn wraps_along(&self, axis: &Vector3<f64>) -> bool {
        self.periodic[axis.iamax()]
    }

    /// Moves a point [m] into the period of the region.
    pub(super) fn wrap(&self, mut point: Vector3<f64>) -> Vector3<f64> {
        for axis in 0..3 {
            if self.periodic[axis] {
                let length = self.max[axis] - self.min[axis];
                point[axis] -= length * ((point[axis] - self.min[axis]) / length).floor();
                point[axis] = point[axis].clamp(self.min[axis], self.max[axis]);
            }
        }
        point
    }

    /// Shortest difference [m] between periodic copies of two points.
    pub(super) fn shortest(&self, mut difference: Vector3<f64>) -> Vector3<f64> {
        for axis in 0..3 {
            if self.periodic[axis] {
                let length = self.max[axis] - self.min[axis];
                difference[axis] -= length * (difference[axis] / length).round();
            }
        }
        difference
    }

    /// Largest radius [m] of a grain that fits into the region.
    pub(super) fn largest_radius(&self) -> f64 {
        self.shape.inner_radius()
    }
}

/// Tells whether a shape, shifted by its length along an axis, continues itself.
fn is_prism_along(shape: &Volume, k: usize) -> bool {
    match shape {
        Volume::Box { .. } => true,
        Volume::Cylinder { axis, .. } => axis[k].abs() == 1.0,
    }
}

/// Unit vectors that are perpendicular to a unit vector and to each other.
fn perpendicular(axis: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let mut helper = Vector3::zeros();
    helper[axis.iamin()] = 1.0;
    let first = axis.cross(&helper).normalize();
    [first, axis.cross(&first)]
}
