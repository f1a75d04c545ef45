//! The tests of a build directory or workspace, as the text of a suite.
//!
//! [`ctest`] lists the tests of CTest, [`recognize`] finds the framework of each,
//! [`colcon`] finds the packages of a workspace, and [`suite_file`] writes the suite.
//! [`rtf_suites`] finds suites that exist already. Starts `ctest`, and no test.

mod colcon;
mod ctest;
mod error;
mod recognize;
mod rtf_suites;
mod suite_file;

use std::path::{Path, PathBuf};

pub use colcon::import as from_colcon;
pub use error::ImportError;
pub use rtf_suites::ExistingSuite;
pub use suite_file::ImportedTest;

/// The tests that were found, and how to run them.
pub struct Import {
    /// The suite's name.
    pub name: String,
    /// Where they were found, for a comment.
    pub source: String,
    pub tests: Vec<ImportedTest>,
    /// Suites that exist already.
    pub suites: Vec<ExistingSuite>,
    /// A shell command that has to run before `rtf`.
    pub set_up: Option<String>,
}

impl Import {
    /// The text of a suite file in a directory, which is absolute.
    pub fn suite(&self, dir: &Path) -> String {
        suite_file::text(&self.name, &self.source, &self.tests, dir)
    }
}

/// Imports the tests of a build directory of CMake, in one of its configurations.
///
/// # Errors
/// There is no such directory, `ctest` cannot be started or fails, or there are no tests.
pub fn from_ctest(build: &Path, config: Option<&str>) -> Result<Import, ImportError> {
    let build = absolute(build)?;
    let (listed, suites) = rtf_suites::take(ctest::list(&build, config)?);
    let tests = recognize::tests(&listed, &build, config);
    if tests.is_empty() && suites.is_empty() {
        let error = format!("`{}` has no tests", build.display());
        let hint = match ctest::has_configurations(&build) && config.is_none() {
            true => "choose a configuration, for example with `-C Release`",
            false => "configure it with `-DBUILD_TESTING=ON`",
        };
        return Err(ImportError::new(error).hint(hint));
    }
    let name = ctest::project_name(&build);
    let source = format!("the build directory {}", build.display());
    Ok(Import { name, source, tests, suites, set_up: None })
}

/// The absolute path of a directory.
///
/// # Errors
/// There is none.
pub fn absolute(path: &Path) -> Result<PathBuf, ImportError> {
    let found = path.canonicalize().ok().filter(|path| path.is_dir());
    found.ok_or_else(|| ImportError::new(format!("there is no directory `{}`", path.display())))
}
