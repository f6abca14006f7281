//! What an evaluation returns.

use nalgebra::Vector3;

/// What an evaluation is asked for beyond E; what is not asked for is not computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// The potential.
    pub potential: bool,
    /// The parts of E by level.
    pub components: bool,
}

/// Parts of E by level [V/m], one vector per particle; a level that was not built is zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Components {
    /// Pairs (and their images) within the cut-off radius.
    pub near: Vec<Vector3<f64>>,
    /// Middle grid (only with an external field solver).
    pub middle: Vec<Vector3<f64>>,
    /// Everything smooth: the internal grid or mesh, boundary potentials, external field.
    pub far: Vec<Vector3<f64>>,
    /// Corrections: what near and far would count twice.
    pub correction: Vec<Vector3<f64>>,
}

/// Field at the particles, in the order in which they were given.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FieldValues {
    /// E [V/m] without the particle's own singular field, with its own images.
    pub e: Vec<Vector3<f64>>,
    /// Potential [V] without the particle's own singular term; empty unless asked for.
    pub potential: Vec<f64>,
    /// Parts of E; empty vectors unless asked for.
    pub components: Components,
}

impl FieldValues {
    /// Forgets all values, keeping their memory.
    pub(crate) fn clear(&mut self) {
        self.e.clear();
        self.potential.clear();
        for part in self.components.parts() {
            part.clear();
        }
    }

    /// Zeros for what is wanted and no level has filled.
    pub(crate) fn complete(&mut self, particles: usize, wanted: Wanted) {
        self.e.resize(particles, Vector3::zeros());
        if wanted.potential {
            self.potential.resize(particles, 0.0);
        }
        if wanted.components {
            for part in self.components.parts() {
                part.resize(particles, Vector3::zeros());
            }
        }
    }
}

impl Components {
    fn parts(&mut self) -> [&mut Vec<Vector3<f64>>; 4] {
        [&mut self.near, &mut self.middle, &mut self.far, &mut self.correction]
    }
}
