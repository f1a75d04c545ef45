//! The environment that a suite's processes will have, as far as it decides
//! where things are found.

use std::path::{Path, PathBuf};

use super::Surroundings;

/// The variables that decide which file a name means or whether it loads. A
/// test that sets one of them is looked up and checked on its own.
pub(super) const DECISIVE: [&str; 12] = [
    "PATH",
    "RTF_PLUGIN_PATH",
    "RTF_PYTHON",
    "PYTHONPATH",
    "PYTHONHOME",
    "RTF_RUBY",
    "RUBYLIB",
    "RUBYOPT",
    "LUA_PATH",
    "LUA_CPATH",
    "LD_LIBRARY_PATH",
    "LD_PRELOAD",
];

/// A list of variables as a suite gives them.
pub(super) type Env = [(String, String)];

/// The surroundings, with a suite's and perhaps a test's variables on top.
#[derive(Clone, Copy)]
pub(super) struct Scope<'a> {
    /// What is below the variables.
    pub surroundings: &'a Surroundings,
    /// The working folder of the suite's processes.
    pub folder: &'a Path,
    /// A further folder where plug-ins and programs are searched after that one.
    pub beside: Option<&'a Path>,
    /// The suite's variables.
    pub suite: &'a Env,
    /// The test's or the fixture's own variables.
    pub own: &'a Env,
}

impl Scope<'_> {
    /// The same with other variables of its own.
    pub fn with<'b>(&'b self, own: &'b Env) -> Scope<'b> {
        Scope { own, ..*self }
    }

    /// The value that a process will see.
    pub fn variable(&self, name: &str) -> Option<&str> {
        self.written(name).or_else(|| self.surroundings.variables.get(name).map(String::as_str))
    }

    /// The folders of a variable like `PATH`. Relative ones belong to whoever
    /// wrote them: the suite's folder, or the current one.
    pub fn folders(&self, name: &str) -> Vec<PathBuf> {
        let base = self.base(name);
        let value = self.variable(name).unwrap_or_default();
        std::env::split_paths(value)
            .filter(|folder| !folder.as_os_str().is_empty())
            .map(|folder| base.join(folder).components().collect())
            .collect()
    }

    /// The folder where relative paths in a variable start.
    pub fn base(&self, name: &str) -> &Path {
        match self.written(name) {
            Some(_) => self.folder,
            None => &self.surroundings.current_folder,
        }
    }

    fn written(&self, name: &str) -> Option<&str> {
        let layers = [self.own, self.suite].into_iter();
        layers
            .flat_map(|layer| layer.iter().rev())
            .find(|(known, _)| known == name)
            .map(|(_, value)| value.as_str())
    }
}

/// Those of a test's variables that decide how its plug-in is found and loaded.
pub(super) fn decisive(own: &Env) -> Vec<(String, String)> {
    own.iter().filter(|(name, _)| DECISIVE.contains(&name.as_str())).cloned().collect()
}
