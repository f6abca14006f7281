//! Overlaps that no motion survives.

use crate::common::{RADIUS, grain, material, mesh_floor, setup};
use amberfield_core::{Material, Step};
use amberfield_dem::{DemError, Simulation};

#[test]
fn grain_never_passes_a_sheet() {
    let soft = Material { young_pa: 1e6, ..material(1.0, 0.0, 0.0) };
    let mut passed = 0;
    for speed in [1.0, 3.0, 6.0, 8.0, 12.0, 20.0, 50.0] {
        for (start, allow) in [(5.0, false), (5.3, true)] {
            let grains = vec![grain(1, [0.3e-3, 0.2e-3, start * RADIUS], [0.0, 0.0, -speed])];
            let mut scene = setup(grains, soft.clone(), 1e-6);
            scene.walls = vec![mesh_floor(0.05, 3)];
            scene.time.step = Step::Auto;
            scene.time.allow_overlap = allow;
            let mut simulation = Simulation::new(scene).expect("a good scene");
            let mut ended = None;
            while ended.is_none() && simulation.particles().velocity[0].z < 0.0 {
                ended = simulation.step().err();
                assert!(simulation.particles().position[0].z > 0.0, "{speed} m/s: it is through");
            }
            if let Some(error) = ended {
                assert!(matches!(error, DemError::TooDeep { id: 1, .. }), "{speed} m/s: {error}");
                passed += 1;
            }
        }
    }
    assert!((2..14).contains(&passed), "{passed} of 14 runs ended");
}
