//! The directories and variables with which a suite's plug-ins, programs and
//! hosts are searched.

use std::path::{Path, PathBuf};

use super::RunnerEnvironment;

/// The variables that determine which file a name refers to, or whether the file
/// loads. The plug-in of a test that sets one of them is searched and checked
/// separately.
const SEARCH_VARIABLES: [&str; 12] = [
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

/// Environment variables: name and value.
pub(super) type Env = [(String, String)];

/// The runner's environment with the variables of a suite and of a test on top.
#[derive(Clone, Copy)]
pub(super) struct SearchScope<'a> {
    pub runner: &'a RunnerEnvironment,
    /// The working directory of the suite's processes.
    pub dir: &'a Path,
    /// A directory that is searched after `dir`.
    pub fallback_dir: Option<&'a Path>,
    pub suite_env: &'a Env,
    /// The variables of a test, a fixture or a hook.
    pub own_env: &'a Env,
}

impl<'a> SearchScope<'a> {
    /// Creates the scope of a suite in the current directory without variables.
    pub fn of_runner(runner: &'a RunnerEnvironment) -> Self {
        let dir = &runner.current_dir;
        Self { runner, dir, fallback_dir: None, suite_env: &[], own_env: &[] }
    }

    /// Returns the same scope with other variables of a test, fixture or hook.
    pub fn with<'b>(&'b self, own_env: &'b Env) -> SearchScope<'b> {
        SearchScope { own_env, ..*self }
    }

    /// Returns the value that a process gets.
    pub fn variable(&self, name: &str) -> Option<&str> {
        self.declared(name).or_else(|| self.runner.variables.get(name).map(String::as_str))
    }

    /// Returns the directories in a variable such as `PATH`, as absolute paths.
    pub fn dirs(&self, name: &str) -> Vec<PathBuf> {
        let base = self.base(name);
        let value = self.variable(name).unwrap_or_default();
        std::env::split_paths(value)
            .filter(|dir| !dir.as_os_str().is_empty())
            .map(|dir| base.join(dir).components().collect())
            .collect()
    }

    /// Returns the directories for the user's plug-ins.
    pub fn user_dirs(&self) -> Vec<PathBuf> {
        let mut dirs = vec![self.dir.to_path_buf()];
        dirs.extend(self.fallback_dir.map(Path::to_path_buf));
        dirs.extend(self.dirs("RTF_PLUGIN_PATH"));
        dirs
    }

    /// Returns the directory to which relative paths in a variable refer: the
    /// suite's for a variable of the suite, else the current one.
    pub fn base(&self, name: &str) -> &Path {
        match self.declared(name) {
            Some(_) => self.dir,
            None => &self.runner.current_dir,
        }
    }

    fn declared(&self, name: &str) -> Option<&str> {
        let layers = [self.own_env, self.suite_env].into_iter();
        layers
            .flat_map(|layer| layer.iter().rev())
            .find(|(known, _)| known == name)
            .map(|(_, value)| value.as_str())
    }
}

/// Returns the variables that affect how a plug-in is found and loaded.
pub(super) fn search_variables(env: &Env) -> Vec<(String, String)> {
    env.iter().filter(|(name, _)| SEARCH_VARIABLES.contains(&name.as_str())).cloned().collect()
}
