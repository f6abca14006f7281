//! Surfaces with each facet split in four, towards the smooth surface whose chords the facets are.
//!
//! The middle of an edge from p to p' is that of the cubic curve through both with their normals n and n',
//! ½(p + p') − [n n·(p' − p) + n' n'·(p − p')]/8 (Vlachos et al., Curved PN triangles, I3D 2001).

use super::elements::SMOOTH;
use amberfield_core::{Conductor, TriangleMesh, Vector3};
use std::collections::HashMap;

/// Conductors with finer surfaces.
pub(crate) fn split(conductors: &[Conductor]) -> Vec<Conductor> {
    let finer =
        |conductor: &Conductor| Conductor { surface: split_mesh(&conductor.surface), ..conductor.clone() };
    conductors.iter().map(finer).collect()
}

fn split_mesh(mesh: &TriangleMesh) -> TriangleMesh {
    let across = |[a, b, c]: [u32; 3]| {
        let [a, b, c] = [a, b, c].map(|vertex| mesh.vertices[vertex as usize]);
        (b - a).cross(&(c - a))
    };
    let mut at_edge: HashMap<[u32; 2], Vec<usize>> = HashMap::new();
    let mut at_vertex = vec![Vec::new(); mesh.vertices.len()];
    for (number, &triangle) in mesh.triangles.iter().enumerate() {
        for k in 0..3 {
            at_edge.entry(edge(triangle, k)).or_default().push(number);
            at_vertex[triangle[k] as usize].push(number);
        }
    }
    let angle = |triangle: [u32; 3], vertex: u32| {
        let place = |vertex: u32| mesh.vertices[vertex as usize];
        let others =
            triangle.into_iter().filter(|&other| other != vertex).map(|other| place(other) - place(vertex));
        let [a, b] = [0, 1].map(|k| others.clone().nth(k).unwrap_or_default());
        a.angle(&b)
    };
    // Normal at a vertex of the facets that go on smoothly from one of them, on its side, by their angles.
    let normal = |vertex: u32, of: usize| {
        let own = across(mesh.triangles[of]).normalize();
        let turned = |&other: &usize| {
            let triangle = mesh.triangles[other];
            let other = across(triangle).normalize();
            (other * own.dot(&other).signum(), angle(triangle, vertex))
        };
        let beside = at_vertex[vertex as usize].iter().map(turned);
        let smooth = beside.filter(|(other, _)| own.dot(other) > SMOOTH.cos());
        smooth.map(|(other, angle)| angle * other).sum::<Vector3<f64>>().normalize()
    };
    let mut vertices = mesh.vertices.clone();
    let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
    let mut triangles = Vec::with_capacity(4 * mesh.triangles.len());
    for (number, &triangle) in mesh.triangles.iter().enumerate() {
        let mut middle = |k: usize| {
            let ends = edge(triangle, k);
            *middles.entry(ends).or_insert_with(|| {
                let [p, q] = ends.map(|vertex| mesh.vertices[vertex as usize]);
                let of_edge = &at_edge[&ends];
                let is_smooth = of_edge.len() == 2 && {
                    let [a, b] =
                        [of_edge[0], of_edge[1]].map(|other| across(mesh.triangles[other]).normalize());
                    a.dot(&b).abs() > SMOOTH.cos()
                };
                let bulge = if is_smooth {
                    let [n, m] = ends.map(|vertex| normal(vertex, number));
                    (n * n.dot(&(q - p)) + m * m.dot(&(p - q))) / 8.0
                } else {
                    Vector3::zeros()
                };
                vertices.push(0.5 * (p + q) - bulge);
                vertices.len() as u32 - 1
            })
        };
        let [a, b, c] = triangle;
        let [ab, bc, ca] = [middle(0), middle(1), middle(2)];
        triangles.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    TriangleMesh { vertices, triangles }
}

/// Ends of a triangle's edge, the lower number first.
fn edge(triangle: [u32; 3], k: usize) -> [u32; 2] {
    let (from, to) = (triangle[k], triangle[(k + 1) % 3]);
    [from.min(to), from.max(to)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn split_facets_of_a_cylinder_lie_on_the_cylinder() {
        let mut vertices = Vec::new();
        for k in 0..12 {
            let angle = std::f64::consts::TAU * f64::from(k) / 12.0;
            vertices.extend([0.0, 1.0].map(|z| Vector3::new(angle.cos(), angle.sin(), z)));
        }
        let mut triangles = Vec::new();
        for k in 0..12_u32 {
            let [a, b, c, d] = [2 * k, (2 * k + 2) % 24, 2 * k + 1, (2 * k + 3) % 24];
            triangles.extend([[a, b, c], [b, c, d]]);
        }
        let cylinder = TriangleMesh { vertices, triangles };
        let finer = split_mesh(&cylinder);
        assert_eq!(finer.triangles.len(), 4 * cylinder.triangles.len());
        // Edges at the ends belong to one triangle each and stay chords. The cubic is nearly the circle.
        let inside = finer.vertices.iter().filter(|x| x.z > 0.1 && x.z < 0.9);
        let worst = inside.map(|x| (x.x.hypot(x.y) - 1.0).abs()).fold(0.0, f64::max);
        let sagitta = 1.0 - (std::f64::consts::PI / 12.0).cos();
        assert!(worst < 0.1 * sagitta, "{worst:.2e} of {sagitta:.2e}");
    }
}
