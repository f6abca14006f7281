//! Names that OpenFOAM's programs can have for a folder.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// Place of links where the system's own has a name that OpenFOAM cannot have.
const ELSEWHERE: &str = "/tmp";

/// Path of a folder that OpenFOAM's programs can have: its own, or a link to it where that has blanks or
/// quotation marks. The link goes with this.
#[derive(Debug)]
pub(super) struct Alias {
    path: PathBuf,
    is_link: bool,
}

impl Alias {
    /// A path for a folder, which is absolute.
    pub(super) fn of(folder: &Path) -> std::io::Result<Self> {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        if is_possible(folder) {
            return Ok(Self { path: folder.to_path_buf(), is_link: false });
        }
        let usual = std::env::temp_dir();
        let place = if is_possible(&usual) { usual } else { ELSEWHERE.into() };
        loop {
            let number = NEXT.fetch_add(1, Ordering::Relaxed);
            let path = place.join(format!("amberfield-case-{}-{number}", std::process::id()));
            match std::os::unix::fs::symlink(folder, &path) {
                Ok(()) => return Ok(Self { path, is_link: true }),
                // One that is there belongs to a process that is gone.
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Folder in which a program can run that looks beyond links for its name.
    pub(super) fn folder_to_run_in(&self) -> &Path {
        if self.is_link { self.path.parent().unwrap_or(&self.path) } else { &self.path }
    }
}

impl Drop for Alias {
    fn drop(&mut self) {
        if self.is_link {
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// Whether OpenFOAM's programs take a path: names with blanks or quotation marks they do not.
fn is_possible(path: &Path) -> bool {
    path.to_str().is_some_and(|path| !path.contains(|c: char| c.is_whitespace() || c == '"' || c == '\''))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folder_with_blanks_gets_a_link_that_goes_again() {
        let folder = std::env::temp_dir().join(format!("Miller's bed {}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let alias = Alias::of(&folder).unwrap();
        assert!(is_possible(alias.path()) && alias.path().canonicalize().unwrap() == folder);
        let path = alias.path().to_path_buf();
        drop(alias);
        assert!(path.symlink_metadata().is_err() && folder.is_dir());
        std::fs::remove_dir(&folder).unwrap();
        assert_eq!(Alias::of(Path::new("/plain/Größe;(&#$")).unwrap().path(), Path::new("/plain/Größe;(&#$"));
    }
}
