//! Meshes with each triangle split in four.

use super::{SmoothPatch, TriangleMesh};
use std::collections::HashMap;

impl TriangleMesh {
    /// Splits each triangle in four, towards the smooth surface whose chords the triangles are.
    #[must_use]
    pub fn split(&self) -> Self {
        let mut vertices = self.vertices.clone();
        let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
        let mut middle = |patch: &SmoothPatch, k: usize| {
            *middles.entry(patch.edge(k)).or_insert_with(|| {
                vertices.push(patch.on_edge(self, k, 0.5));
                vertices.len() as u32 - 1
            })
        };
        let split = |patch: SmoothPatch| {
            let [a, b, c] = patch.corners;
            let [ab, bc, ca] = [0, 1, 2].map(|k| middle(&patch, k));
            [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        };
        let triangles = self.smooth_patches(f64::INFINITY).into_iter().flat_map(split).collect();
        Self { vertices, triangles }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use std::f64::consts::{PI, TAU};

    #[test]
    fn split_triangles_of_a_cylinder_lie_on_the_cylinder() {
        let mut vertices = Vec::new();
        for k in 0..12 {
            let angle = TAU * f64::from(k) / 12.0;
            vertices.extend([0.0, 1.0].map(|z| Vector3::new(angle.cos(), angle.sin(), z)));
        }
        let mut triangles = Vec::new();
        for k in 0..12_u32 {
            let [a, b, c, d] = [2 * k, (2 * k + 2) % 24, 2 * k + 1, (2 * k + 3) % 24];
            triangles.extend([[a, b, c], [b, c, d]]);
        }
        let cylinder = TriangleMesh { vertices, triangles };
        let finer = cylinder.split();
        assert_eq!(finer.triangles.len(), 4 * cylinder.triangles.len());
        // The cubic is nearly the circle, at the ends too.
        let worst = finer.vertices.iter().map(|x| (x.x.hypot(x.y) - 1.0).abs()).fold(0.0, f64::max);
        let sagitta = 1.0 - (PI / 12.0).cos();
        assert!(worst < 0.1 * sagitta, "{worst:.2e} of {sagitta:.2e}");
    }
}
