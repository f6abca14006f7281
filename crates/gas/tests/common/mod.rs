//! A flow by a rule and the gas that it is of, for tests and examples.

use amberfield_core::{Domain, DragLaw, Gas, GasFlow, GasModel, Vector3};
use amberfield_field::far::{FarMesh, FarMeshParts};
use amberfield_gas::{CellShapes, FlowRequest, FlowSolver, FlowValues, GasError};
use std::fmt;

/// Flow without pressure whose velocities by cell [m/s] are given by a rule, from a request and the cells'
/// volumes [m³].
pub(crate) struct ByRule<Rule> {
    mesh: FarMesh,
    shapes: CellShapes,
    rule: Rule,
    velocity: Vec<Vector3<f64>>,
}

impl<Rule> ByRule<Rule>
where
    Rule: FnMut(&FlowRequest<'_>, &[f64]) -> Vec<Vector3<f64>> + Send + Sync + 'static,
{
    /// Flow in a box of so many cells.
    pub(crate) fn boxed(domain: &Domain, cells: [usize; 3], rule: Rule) -> Box<dyn FlowSolver> {
        let (mesh, shapes) = mesh(domain, cells);
        Box::new(Self { mesh, shapes, rule, velocity: Vec::new() })
    }
}

impl<Rule> fmt::Debug for ByRule<Rule> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("ByRule")
    }
}

impl<Rule> FlowSolver for ByRule<Rule>
where
    Rule: FnMut(&FlowRequest<'_>, &[f64]) -> Vec<Vector3<f64>> + Send + Sync,
{
    fn mesh(&self) -> &FarMesh {
        &self.mesh
    }

    fn shapes(&self) -> &CellShapes {
        &self.shapes
    }

    fn ask(&mut self, request: &FlowRequest<'_>) -> Result<(), GasError> {
        self.velocity = (self.rule)(request, self.mesh.volumes());
        Ok(())
    }

    fn take(&mut self, values: &mut FlowValues) -> Result<(), GasError> {
        values.velocity.clone_from(&self.velocity);
        values.pressure_gradient = vec![Vector3::zeros(); self.mesh.cell_count()];
        Ok(())
    }

    fn state(&mut self) -> Result<Vec<Vec<f64>>, GasError> {
        Ok(Vec::new())
    }

    fn restore(&mut self, _: &[Vec<f64>]) -> Result<(), GasError> {
        Ok(())
    }
}

/// Mesh of a box.
pub(crate) fn mesh(domain: &Domain, cells: [usize; 3]) -> (FarMesh, CellShapes) {
    let mesh = FarMesh::new(FarMeshParts::of_box(domain, cells).expect("a box")).expect("a mesh");
    let shapes = CellShapes::of_planes(&mesh).expect("cuboids");
    (mesh, shapes)
}

/// Air whose flow is computed.
pub(crate) fn air(drag: DragLaw) -> (Gas, GasFlow) {
    let flow = GasFlow {
        model: GasModel::A,
        interval_s: 1.0,
        smoothing_length_m: None,
        viscous_force: false,
        saffman_lift: false,
        overlap: false,
    };
    let gas = Gas {
        drag,
        density_kg_m3: 1.2,
        viscosity_pa_s: 1.8e-5,
        velocity_m_s: Vector3::zeros(),
        magnus_lift: false,
        flow: Some(flow),
    };
    (gas, flow)
}

/// Grains all over a box of edges [m], `layers` of `[x, y]` grains each: positions and radii [m].
pub(crate) fn scattered([x, y, layers]: [usize; 3], edges: [f64; 3], radius: f64) -> Vec<[f64; 4]> {
    let one = |i: usize| {
        let along = |axis: usize, place: usize, count: usize| {
            let moved = ([0.37, 0.53, 0.71][axis] * i as f64).fract();
            radius + (edges[axis] - 2.0 * radius) * (place as f64 + moved) / count as f64
        };
        [along(0, i % x, x), along(1, i / x % y, y), along(2, i / (x * y), layers), radius]
    };
    (0..x * y * layers).map(one).collect()
}
