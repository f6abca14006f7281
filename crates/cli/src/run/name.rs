//! Name of a scene.

use amberfield_scene::SceneInput;
use std::path::Path;

/// Name of a scene as a user gave it.
pub(crate) fn name_of(scene: &SceneInput) -> String {
    scene.path().map_or_else(|| "scene".to_owned(), scene_name)
}

/// Name of a scene: that of its file without the ending, or that of its folder when the file is `scene.toml`.
pub(crate) fn scene_name(path: &Path) -> String {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let folder = || {
        let folder = std::path::absolute(path).ok()?;
        Some(folder.parent()?.file_name()?.to_string_lossy().into_owned())
    };
    match stem {
        Some(stem) if stem != "scene" => stem,
        _ => folder().unwrap_or_else(|| "scene".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_file_without_a_name_of_its_own_is_called_after_its_folder() {
        assert_eq!(scene_name(Path::new("cases/heap/scene.toml")), "heap");
        assert_eq!(scene_name(Path::new("cases/heap/tall.toml")), "tall");
    }
}
