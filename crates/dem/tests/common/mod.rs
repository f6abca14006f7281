//! Scenes that several tests share.

use amberfield_core::{
    Boundary, Domain, Grain, GroupId, Material, MaterialId, OnExit, RollingModel, Skin, Step, TimeSettings,
    TriangleMesh, Vector3, Wall, WallCharging, WallShape,
};
use amberfield_dem::{Setup, Simulation};

pub(crate) const RADIUS: f64 = 1e-3;
pub(crate) const DENSITY: f64 = 2500.0;

pub(crate) fn material(restitution: f64, friction: f64, rolling_friction: f64) -> Material {
    Material {
        name: "glass".into(),
        density_kg_m3: DENSITY,
        young_pa: 1e7,
        young_real_pa: None,
        poisson: 0.25,
        restitution,
        friction,
        rolling_friction,
        surface_energy_j_m2: 0.0,
        work_function_ev: None,
    }
}

pub(crate) fn grain(id: u64, position: [f64; 3], velocity: [f64; 3]) -> Grain {
    Grain {
        id,
        position: position.into(),
        velocity: velocity.into(),
        angular_velocity: Vector3::zeros(),
        radius: RADIUS,
        density: DENSITY,
        charge: 0.0,
        material: MaterialId(0),
        group: GroupId(0),
    }
}

pub(crate) fn mass(radius: f64) -> f64 {
    4.0 / 3.0 * std::f64::consts::PI * radius.powi(3) * DENSITY
}

pub(crate) fn domain(half: f64, boundary: Boundary) -> Domain {
    Domain::new(Vector3::repeat(-half), Vector3::repeat(half), [[boundary; 2]; 3]).expect("a good box")
}

pub(crate) fn time(step_s: f64) -> TimeSettings {
    TimeSettings {
        step: Step::Seconds(step_s),
        end_s: 1.0,
        gravity_m_s2: Vector3::zeros(),
        skin: Skin::Auto,
        allow_unstable: false,
        on_exit: OnExit::Stop,
        allow_overlap: false,
    }
}

pub(crate) fn setup(grains: Vec<Grain>, material: Material, step_s: f64) -> Setup {
    Setup {
        domain: domain(1.0, Boundary::Open),
        materials: vec![material],
        rolling_model: RollingModel::default(),
        cohesion: Default::default(),
        pairs: Vec::new(),
        particles: grains.into_iter().collect(),
        walls: Vec::new(),
        time: time(step_s),
        gas: None,
        field: None,
        feeds: Default::default(),
        outlets: Vec::new(),
    }
}

pub(crate) fn wall(shape: WallShape) -> Wall {
    Wall {
        name: "wall".into(),
        shape,
        material: MaterialId(0),
        charging: WallCharging::None,
        bounds_field: false,
        motion: Vec::new(),
    }
}

/// z = 0, grains above.
pub(crate) fn floor() -> Wall {
    wall(WallShape::Plane { point: Vector3::zeros(), normal: Vector3::z() })
}

/// z = 0 from −`half` to `half`, in `cells`² squares of two triangles.
pub(crate) fn mesh_floor(half: f64, cells: u32) -> Wall {
    let n = cells + 1;
    let at = |k: u32| 2.0 * half * f64::from(k) / f64::from(cells) - half;
    let vertices = (0..n * n).map(|k| Vector3::new(at(k % n), at(k / n), 0.0)).collect();
    let triangles = (0..cells * cells)
        .flat_map(|k| {
            let v = k / cells * n + k % cells;
            [[v, v + 1, v + n + 1], [v, v + n + 1, v + n]]
        })
        .collect();
    wall(WallShape::Mesh(TriangleMesh { vertices, triangles }))
}

pub(crate) fn run(simulation: &mut Simulation, steps: u64) {
    for _ in 0..steps {
        simulation.step().expect("a good step");
    }
}

/// Grains on a jittered lattice that fills the box from `min` to `max`.
pub(crate) fn lattice(min: [f64; 3], max: [f64; 3], spacing: f64, speed: f64, seed: u64) -> Vec<Grain> {
    use rand::{RngExt, SeedableRng};
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let counts: Vec<usize> = (0..3).map(|a| ((max[a] - min[a]) / spacing) as usize).collect();
    let mut grains = Vec::new();
    for z in 0..counts[2] {
        for y in 0..counts[1] {
            for x in 0..counts[0] {
                let cell = [x, y, z];
                let jitter = 0.5 * (spacing - 2.0 * RADIUS) * 0.9;
                let position = std::array::from_fn(|a| {
                    min[a] + (cell[a] as f64 + 0.5) * spacing + jitter * random.random_range(-1.0..1.0)
                });
                let velocity = std::array::from_fn(|_| speed * random.random_range(-1.0..1.0));
                grains.push(grain(grains.len() as u64 + 1, position, velocity));
            }
        }
    }
    grains
}
