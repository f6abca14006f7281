//! Writing checkpoints, and reading them for the scene that wrote them.

use super::atomic::write_atomically;
use crate::SceneError;
use crate::checkpoint::{Parts, SavedGrains, decode, encode};
use crate::scene::{Physics, told};
use serde::{Serialize, de::DeserializeOwned};
use std::path::Path;

/// Writes a checkpoint of a state, for a scene with the given physics, and its grains for other scenes.
///
/// # Errors
/// Errors of the operating system.
pub fn write_checkpoint(
    path: &Path,
    physics: &Physics,
    grains: &SavedGrains,
    state: &impl Serialize,
) -> Result<(), SceneError> {
    let unwritable = |error| SceneError::unwritable(path, error);
    let physics = encode(physics).map_err(unwritable)?;
    let grains = encode(grains).map_err(unwritable)?;
    let state = encode(state).map_err(unwritable)?;
    let parts = Parts { physics: &physics, grains: &grains, state: &state };
    let head = parts.head();
    write_atomically(path, |writer| {
        writer.write_all(&head)?;
        writer.write_all(parts.state)
    })
}

/// Reads a checkpoint of a scene with the given physics.
///
/// # Errors
/// Files that are no checkpoint, are of another version or another scene, are cut short or damaged.
pub fn read_checkpoint<T: DeserializeOwned>(path: &Path, physics: &Physics) -> Result<T, SceneError> {
    read(path, |found| match &physics.changes_since(found)[..] {
        [] => Ok(()),
        changes => Err(format!("belongs to another scene: {}", told(changes))),
    })
}

/// Reads the state of a checkpoint of any scene.
///
/// # Errors
/// Files that are no checkpoint, are of another version, are cut short or damaged.
pub fn read_checkpoint_of_any<T: DeserializeOwned>(path: &Path) -> Result<T, SceneError> {
    read(path, |_| Ok(()))
}

/// Reads a checkpoint whose physics pass a check.
fn read<T: DeserializeOwned>(
    path: &Path,
    check: impl Fn(&Physics) -> Result<(), String>,
) -> Result<T, SceneError> {
    let bad = |problem: String| SceneError::Checkpoint { path: path.to_path_buf(), problem };
    if path.is_dir() {
        return Err(bad("is a directory; name a checkpoint file (checkpoints/*.amber)".to_owned()));
    }
    let bytes = std::fs::read(path).map_err(|error| bad(format!("cannot be read: {error}")))?;
    let parts = Parts::of(&bytes).map_err(bad)?;
    let found: Physics = decode(parts.physics)
        .map_err(|error| bad(format!("its scene cannot be read ({error}); take another checkpoint")))?;
    check(&found).map_err(bad)?;
    decode(parts.state)
        .map_err(|error| bad(format!("its state cannot be read ({error}); take another checkpoint")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, PartialEq, Serialize, serde::Deserialize)]
    enum Tagged {
        Plain,
        Full { number: f64, counts: [usize; 3] },
    }

    type State = (u64, Vec<f64>, String, [Tagged; 2]);

    fn written() -> (tempfile::TempDir, std::path::PathBuf, State) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.amber");
        let state: State = (
            7,
            vec![0.1, -0.0, f64::MIN_POSITIVE, f64::INFINITY],
            "x".into(),
            [Tagged::Full { number: f64::NEG_INFINITY, counts: [1, 2, 3] }, Tagged::Plain],
        );
        write_checkpoint(&path, &Physics::default(), &SavedGrains::default(), &state).unwrap();
        (folder, path, state)
    }

    #[test]
    fn state_comes_back_bitwise() {
        let (_folder, path, state) = written();
        assert_eq!(read_checkpoint::<State>(&path, &Physics::default()).unwrap(), state);
    }
}
