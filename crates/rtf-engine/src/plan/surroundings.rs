//! Where the planner runs: what it may look at beside the suite.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// The current folder, the running program and the environment, taken once, so
/// that planning depends on nothing hidden.
#[derive(Clone, Debug, Default)]
pub struct Surroundings {
    /// The folder against which the given paths are resolved; absolute.
    pub current_folder: PathBuf,
    /// The running `rtf`, absolute: its hosts and SDKs lie beside it.
    pub executable: PathBuf,
    /// The environment variables.
    pub variables: HashMap<String, String>,
}

impl Surroundings {
    /// Those of this process. Variables that are not UTF-8 are left out.
    ///
    /// # Errors
    /// The current folder or the running program cannot be found out.
    pub fn of_process() -> std::io::Result<Self> {
        let variables = std::env::vars_os()
            .filter_map(|(name, value)| Some((name.into_string().ok()?, value.into_string().ok()?)))
            .collect();
        Ok(Self {
            current_folder: std::env::current_dir()?,
            executable: std::env::current_exe()?,
            variables,
        })
    }

    /// A path as the user gave it, made absolute.
    pub(super) fn absolute(&self, path: &Path) -> PathBuf {
        let joined = self.current_folder.join(path);
        // Only takes `.` and doubled slashes out: links keep their meaning.
        joined.components().collect()
    }

    /// The folder above the one of the running program: the installation's prefix.
    pub(super) fn prefix(&self) -> Option<&Path> {
        self.executable.parent()?.parent()
    }
}
