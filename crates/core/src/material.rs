//! Materials of grains and walls.

use serde::{Deserialize, Serialize};

/// Index into the scene's list of materials.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct MaterialId(pub u16);

/// Mechanical and electrical properties of a solid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Name used by the scene.
    pub name: String,
    /// Density ρ [kg/m³].
    pub density_kg_m3: f64,
    /// Young's modulus Y used in the simulation [Pa].
    pub young_pa: f64,
    /// Young's modulus of the real solid [Pa], for the contact-area correction.
    pub young_real_pa: Option<f64>,
    /// Poisson ratio ν.
    pub poisson: f64,
    /// Coefficient of restitution e in (0, 1].
    pub restitution: f64,
    /// Coulomb friction coefficient μ.
    pub friction: f64,
    /// Rolling friction coefficient μ_r.
    pub rolling_friction: f64,
    /// Surface energy γ [J/m²]; 0: nothing sticks to it.
    pub surface_energy_j_m2: f64,
    /// Work function W [eV].
    pub work_function_ev: Option<f64>,
}
