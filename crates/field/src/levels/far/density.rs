//! The smooth density of charges' clouds at any places of a box, by the grid's own code: spread with the
//! window, multiply by the clouds' spectrum, gather.

use super::reach::CloudReach;
use crate::levels::grid::level::{GridLevel, GridParameters};
use crate::levels::grid::shapes;
use amberfield_core::Domain;
use amberfield_laws::kaiser_bessel_cloud::Cloud;
use nalgebra::Vector3;

/// Order of the window and node spacings per cloud radius: an error near 1e-4 of a cloud's largest density.
const ORDER: usize = 4;
const NODES_PER_RADIUS: f64 = 7.0;

/// Density of clouds in a box.
#[derive(Debug)]
pub struct SmoothDensity {
    reach: CloudReach,
    /// Grid of the box with the reach of the clouds.
    grid: GridLevel,
    positions: Vec<Vector3<f64>>,
    charges: Vec<f64>,
}

impl SmoothDensity {
    /// Builds the density for the part from `low` to `high` [m] of a domain (its periodic axes count), and
    /// clouds of a radius [m] and shape.
    #[must_use]
    pub fn new(whole: &Domain, low: Vector3<f64>, high: Vector3<f64>, radius_m: f64, shape: f64) -> Self {
        let reach = CloudReach::new(whole, low, high, radius_m);
        let parameters = GridParameters {
            spacing_m: radius_m / NODES_PER_RADIUS,
            order: ORDER,
            window_shape: shapes::best(ORDER, NODES_PER_RADIUS).window,
            cloud: Cloud { radius: radius_m, shape },
        };
        let grid = GridLevel::density(reach.padded(), parameters);
        Self { reach, grid, positions: Vec::new(), charges: Vec::new() }
    }

    /// Forgets all charges.
    pub fn clear(&mut self) {
        self.positions.clear();
        self.charges.clear();
    }

    /// Adds charges [C] at positions [m]; those whose clouds do not reach the box count for nothing.
    pub fn add(&mut self, positions: &[Vector3<f64>], charges: &[f64]) {
        for (position, &charge) in positions.iter().zip(charges).filter(|(_, charge)| **charge != 0.0) {
            for moved in self.reach.copies(*position) {
                self.positions.push(moved);
                self.charges.push(charge);
            }
        }
    }

    /// Density [C/m³] at places in the box [m].
    pub fn at(&mut self, places: &[Vector3<f64>], density: &mut [f64]) {
        self.grid.solve(&self.positions, &self.charges);
        self.grid.gather_values(places, density);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::Boundary;

    /// Density of a unit charge's cloud: its field's divergence over 4π.
    fn cloud_density(cloud: Cloud, r: f64) -> f64 {
        let step = 1e-4 * cloud.radius;
        let flux = |r: f64| cloud.field_over_r(r) * r.powi(3);
        (flux(r + step) - flux(r - step)) / (2.0 * step * 4.0 * std::f64::consts::PI * r * r)
    }

    #[test]
    fn density_is_the_clouds_own_beside_a_wall_and_across_a_period() {
        let faces = [[Boundary::Periodic; 2], [Boundary::Open; 2], [Boundary::Open; 2]];
        let domain = Domain::new(Vector3::zeros(), Vector3::new(2.0, 1.0, 1.0), faces).unwrap();
        let cloud = Cloud { radius: 0.5, shape: 10.0 };
        let charges = [1.0, -2.0];
        let positions = [Vector3::new(0.1, 0.2, 0.5), Vector3::new(1.0, -0.1, 0.4)];
        for high in [2.0, 1.2] {
            let end = Vector3::new(high, 1.0, 1.0);
            let mut density = SmoothDensity::new(&domain, Vector3::zeros(), end, cloud.radius, cloud.shape);
            density.add(&positions, &charges);
            let places =
                [Vector3::new(0.2, 0.1, 0.6), Vector3::new(1.1, 0.1, 0.3), Vector3::new(0.02, 0.4, 0.5)];
            let mut found = [0.0; 3];
            density.at(&places, &mut found);
            for (place, found) in places.iter().zip(found) {
                let exact: f64 = positions
                    .iter()
                    .zip(charges)
                    .map(|(x, q)| {
                        let mut d = place - x;
                        d.x -= 2.0 * (d.x / 2.0).round();
                        if d.norm() < 0.5 { q * cloud_density(cloud, d.norm()) } else { 0.0 }
                    })
                    .sum();
                let scale = 2.0 * cloud_density(cloud, 0.01);
                assert!((found - exact).abs() < 5e-4 * scale, "{high} {place}: {found} for {exact}");
            }
        }
    }
}
