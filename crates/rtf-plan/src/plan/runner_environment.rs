//! The environment of the runner: current directory, program and variables.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// The current directory, the running program and the environment variables,
/// captured once, so that planning does not depend on global state.
#[derive(Clone, Debug, Default)]
pub struct RunnerEnvironment {
    /// The absolute directory against which input paths are resolved.
    pub current_dir: PathBuf,
    /// The absolute path of the running `rtf`; hosts and SDKs are found from there.
    pub executable: PathBuf,
    pub variables: HashMap<String, String>,
}

impl RunnerEnvironment {
    /// Captures the environment of this process, without variables that are not UTF-8.
    ///
    /// # Errors
    /// The current directory or the running program cannot be determined.
    pub fn from_current_process() -> std::io::Result<Self> {
        let variables = std::env::vars_os()
            .filter_map(|(name, value)| Some((name.into_string().ok()?, value.into_string().ok()?)))
            .collect();
        Ok(Self {
            current_dir: std::env::current_dir()?,
            executable: std::env::current_exe().map_err(no_proc)?,
            variables,
        })
    }

    pub(super) fn absolute(&self, path: &Path) -> PathBuf {
        let joined = self.current_dir.join(path);
        // Only removes `.` and doubled slashes: symbolic links stay valid.
        joined.components().collect()
    }

    /// Returns the installation's prefix: the parent of the running program's directory.
    pub(super) fn prefix(&self) -> Option<&Path> {
        self.executable.parent()?.parent()
    }

    /// Finds a directory that comes with `rtf`, which contains `marker`: at one of the paths in
    /// the installation's prefix, or at a path in the source tree.
    pub(super) fn shipped(
        &self,
        installed: &[&str],
        source: &str,
        marker: &str,
    ) -> Option<PathBuf> {
        let prefix = self.prefix().into_iter();
        let installed = prefix.flat_map(|prefix| installed.iter().map(|path| prefix.join(path)));
        let above = self.executable.ancestors().skip(1);
        let source = above.map(|dir| dir.join(source));
        installed.chain(source).find(|dir| dir.join(marker).exists())
    }
}

/// Explains the usual cause: without `/proc`, no part of `rtf` works.
fn no_proc(error: std::io::Error) -> std::io::Error {
    std::io::Error::new(error.kind(), format!("rtf needs `/proc`, which cannot be read: {error}"))
}
