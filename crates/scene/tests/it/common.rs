//! Folder with a good scene and its files, which tests then spoil.

use amberfield_scene::{Purpose, Scene, SceneError, read_scene};
use std::path::{Path, PathBuf};

/// Good scene with every kind of section that a run may have.
pub(crate) const SCENE: &str = r#"
[domain]
min_m = [0.0, 0.0, 0.0]
max_m = [0.02, 0.02, 0.04]
[domain.boundary]
x = "periodic"
y = "periodic"
z_min = "grounded"
z_max = { potential_V = 100.0 }

[[walls]]
plane = { point_m = [0, 0, 0], normal = [0, 0, 2] }
material = "steel"
[[walls]]
stl = "plate.stl"
scale = 1e-3
material = "steel"
charging = "grounded"

[[materials]]
name = "glass"
density_kg_m3 = 2500.0
young_Pa = 1e7
poisson = 0.22
restitution = 0.9
friction = 0.3
rolling_friction = 0.01
work_function_eV = 4.5
[[materials]]
name = "steel"
density_kg_m3 = 7800
young_Pa = 1e9
poisson = 0.3
restitution = 0.8
friction = 0.4

[particles]
file = "grains.csv"

[time]
step_s = 1e-6
end_s = 0.05
gravity_m_s2 = [0, 0, -9.81]

[electric_field]
tolerance = 1e-2

[output]
every_s = 1e-3
formats = ["vtk", "csv"]
checkpoint_every_s = 1e-2
"#;

/// Good particles file of the scene.
pub(crate) const GRAINS: &str = "id,x_m,y_m,z_m,radius_m,charge_C,material,group\n\
    1,0.001,0.001,0.001,1e-4,1e-14,glass,fine\n\
    2,0.002,0.001,0.001,1e-4,-1e-14,glass,\n\
    7,0.003,0.001,0.001,2e-4,0,steel,coarse\n";

/// Good STL surface of the scene.
pub(crate) const PLATE: &str = "solid p\nfacet normal 0 0 1\n outer loop\n  \
                                vertex 0 0 1\n  vertex 20 0 1\n  vertex 0 20 1\n \
                                endloop\nendfacet\nendsolid p\n";

/// Folder that is removed at the end.
pub(crate) struct Folder(tempfile::TempDir);

impl Folder {
    /// Folder with the good files.
    pub(crate) fn good() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        folder.write("scene.toml", SCENE);
        folder.write("grains.csv", GRAINS);
        folder.write("plate.stl", PLATE);
        folder
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.file(name), content).unwrap();
    }

    /// Reads the scene for a run.
    pub(crate) fn read(&self, overrides: &[&str]) -> Result<Scene, SceneError> {
        self.read_for(Purpose::Run, overrides)
    }

    pub(crate) fn read_for(&self, purpose: Purpose, overrides: &[&str]) -> Result<Scene, SceneError> {
        let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
        read_scene(&self.file("scene.toml"), &overrides, purpose)
    }

    /// Message of a scene that must be refused, without the name of the folder.
    pub(crate) fn refusal(&self, overrides: &[&str]) -> String {
        match self.read(overrides) {
            Ok(_) => panic!("accepted"),
            Err(error) => error.to_string().replace(&format!("{}/", self.path().display()), ""),
        }
    }
}
