//! Beds and clouds to measure on.

use amberfield_core::{
    Boundary, Domain, Grain, GroupId, Material, MaterialId, OnExit, Particles, RollingModel, Skin, Step,
    TimeSettings, Vector3,
};
use amberfield_dem::{Setup, Simulation};
use amberfield_oracle::{rms, rms_difference};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

pub(crate) const RADIUS: f64 = 1e-3;
pub(crate) const DENSITY: f64 = 2500.0;
pub(crate) const STEP_S: f64 = 8e-6;
/// Speed of every component at the start, at most [m/s].
const SPEED: f64 = 0.1;

/// The material of all beds.
pub(crate) fn glass() -> Material {
    Material {
        name: "glass".into(),
        density_kg_m3: DENSITY,
        young_pa: 1e7,
        young_real_pa: None,
        poisson: 0.25,
        restitution: 0.9,
        friction: 0.3,
        rolling_friction: 0.0,
        surface_energy_j_m2: 0.0,
        work_function_ev: None,
    }
}

/// Grains that move in a periodic box of the given volume fraction: jittered lattice places, relaxed until
/// few overlap, then given random velocities.
pub(crate) fn relaxed(count: usize, fraction: f64) -> Setup {
    let rounds = if fraction < 0.5 { 4 } else { 20 };
    let mut scene = jittered(count, fraction, 0.3);
    scene.materials[0].restitution = 0.05;
    for _ in 0..rounds {
        let mut run = Simulation::new(scene.clone()).expect("overlaps are allowed");
        for _ in 0..100 {
            run.step().expect("a periodic box");
        }
        scene.particles = run.particles();
        for v in &mut scene.particles.velocity {
            *v *= 0.1;
        }
    }
    let mut random = ChaCha8Rng::seed_from_u64(2);
    for v in &mut scene.particles.velocity {
        *v = Vector3::from_fn(|_, _| random.random_range(-SPEED..SPEED));
    }
    for x in &mut scene.particles.position {
        *x = scene.domain.wrap(*x);
    }
    scene.materials = vec![glass()];
    scene
}

/// Volume fraction of [`sparse`].
const SPARSE: f64 = 0.1;

/// Grains that move in a periodic box so sparsely that jittered lattice places never overlap.
pub(crate) fn sparse(count: usize) -> Setup {
    jittered(count, SPARSE, 0.2)
}

/// ±q on the grains of [`sparse`].
pub(crate) fn sparse_cloud(count: usize) -> ChargedBed {
    charged(sparse(count))
}

/// Grains at jittered lattice places; the jitter is in spacings.
fn jittered(count: usize, fraction: f64, jitter: f64) -> Setup {
    let volume = count as f64 * 4.0 / 3.0 * std::f64::consts::PI * RADIUS.powi(3) / fraction;
    let length = volume.cbrt();
    let per_axis = (count as f64).cbrt().ceil() as usize;
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let spacing = length / per_axis as f64;
    let particles: Particles = (0..count)
        .map(|k| {
            let cell = [k % per_axis, k / per_axis % per_axis, k / per_axis / per_axis];
            let place = cell.map(|c| (c as f64 + 0.5 + jitter * random.random_range(-1.0..1.0)) * spacing);
            Grain {
                id: k as u64,
                position: place.into(),
                velocity: Vector3::from_fn(|_, _| random.random_range(-SPEED..SPEED)),
                angular_velocity: Vector3::zeros(),
                radius: RADIUS,
                density: DENSITY,
                charge: 0.0,
                material: MaterialId(0),
                group: GroupId(0),
            }
        })
        .collect();
    Setup {
        domain: Domain::new(Vector3::zeros(), Vector3::repeat(length), [[Boundary::Periodic; 2]; 3])
            .expect("positive extents"),
        materials: vec![glass()],
        rolling_model: RollingModel::default(),
        cohesion: Default::default(),
        pairs: Vec::new(),
        particles,
        walls: Vec::new(),
        time: TimeSettings {
            step: Step::Seconds(STEP_S),
            end_s: 1.0,
            gravity_m_s2: Vector3::zeros(),
            skin: Skin::Auto,
            allow_unstable: true,
            on_exit: OnExit::Stop,
            allow_overlap: true,
        },
        gas: None,
        field: None,
        feeds: Default::default(),
        outlets: Vec::new(),
    }
}

/// Charged grains.
#[derive(Clone, Debug)]
pub(crate) struct ChargedBed {
    pub(crate) domain: Domain,
    pub(crate) position: Vec<Vector3<f64>>,
    pub(crate) charge: Vec<f64>,
}

/// ±q at random, as many of each, on the grains of a relaxed bed.
pub(crate) fn cloud(count: usize, fraction: f64) -> ChargedBed {
    charged(relaxed(count, fraction))
}

/// ±q on the grains of a bed, as many of each, at random.
pub(crate) fn charged(scene: Setup) -> ChargedBed {
    let count = scene.particles.len();
    let mut charge: Vec<f64> = (0..count).map(|i| if i % 2 == 0 { 1e-12 } else { -1e-12 }).collect();
    let mut random = ChaCha8Rng::seed_from_u64(3);
    for i in (1..count).rev() {
        charge.swap(i, random.random_range(0..=i));
    }
    ChargedBed { domain: scene.domain, position: scene.particles.position, charge }
}

/// First numbers of a bed as the scripts of LAMMPS' granular package read them: count, edge, diameter,
/// density, step, and constants of the contact.
pub(crate) fn granular_head(scene: &Setup) -> [f64; 9] {
    let material = glass();
    let shear = 0.5 * material.young_pa / (1.0 + material.poisson);
    // Stiffnesses of LAMMPS' manual, `pair_style gran/hertz/history`; the damping gives about our
    // restitution.
    let normal = 4.0 * shear / (3.0 * (1.0 - material.poisson));
    let tangential = 4.0 * shear / (2.0 - material.poisson);
    let damping = 2e7;
    let (count, edge) = (scene.particles.len() as f64, scene.domain.extent().x);
    [count, edge, 2.0 * RADIUS, DENSITY, STEP_S, normal, tangential, damping, material.friction]
}

impl ChargedBed {
    /// Copy of the charges in a box with other faces, a radius from the centres: nearer ones would have
    /// little but their images for a field.
    pub(crate) fn within(&self, boundary: Boundary) -> Self {
        let (min, max) = (self.domain.min().add_scalar(-RADIUS), self.domain.max().add_scalar(RADIUS));
        let domain = Domain::new(min, max, [[boundary; 2]; 3]).expect("positive extents");
        Self { domain, ..self.clone() }
    }

    /// Numbers as the peers' scripts read them, with the exact field for 4πε = 1 from E in SI units.
    pub(crate) fn numbers<'a>(&'a self, exact: &'a [Vector3<f64>]) -> impl Iterator<Item = f64> + 'a {
        let k = amberfield_core::Permittivity::VACUUM.coulomb();
        let head = [self.position.len() as f64, self.domain.extent().x, 2.0 * RADIUS];
        let grains = self.position.iter().zip(&self.charge).zip(exact);
        head.into_iter()
            .chain(grains.flat_map(move |((x, &q), e)| [x.x, x.y, x.z, q, e.x / k, e.y / k, e.z / k]))
    }
}

/// RMS of the difference of two fields over the RMS of the second.
pub(crate) fn relative_error(field: &[Vector3<f64>], exact: &[Vector3<f64>]) -> f64 {
    rms_difference(field, exact) / rms(exact)
}
