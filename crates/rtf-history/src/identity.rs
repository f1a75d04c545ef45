//! The identities of runs and tests.

use std::path::{Component, Path, PathBuf};

use rtf_model::RunStarted;
use serde::Serialize;
use utoipa::ToSchema;

/// The identity of a test, or of a case of it, in all runs.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, ToSchema)]
pub struct TestIdentity {
    /// The suite's file, relative to the root of its repository; empty for plug-ins given
    /// on the command line.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub suite_file: String,
    /// The name of the suite.
    pub suite: String,
    /// The name of the test, with its values of a matrix.
    pub test: String,
    /// The path of the case; empty for the test itself.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub case: String,
}

impl std::fmt::Display for TestIdentity {
    /// `SUITE/TEST`, `SUITE/TEST::CASE`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.suite, self.test)?;
        if self.case.is_empty() { Ok(()) } else { write!(f, "::{}", self.case) }
    }
}

/// Makes the names of suite files independent of the directory in which a run was started.
#[derive(Debug)]
pub struct SuiteFileBase {
    working_dir: PathBuf,
    /// The working directory relative to the root of the repository.
    dir: PathBuf,
    /// The root of the repository, or the working directory.
    root: PathBuf,
}

impl SuiteFileBase {
    /// The base of a run.
    #[must_use]
    pub fn new(run: &RunStarted) -> Self {
        let revision = run.manifest.revision.as_ref();
        let dir = revision.and_then(|revision| revision.dir.as_deref()).unwrap_or_default();
        Self::of_dir(Path::new(&run.working_dir), Path::new(dir))
    }

    /// The base of runs in a working directory, which is `dir` relative to the root of its
    /// repository.
    #[must_use]
    pub fn of_dir(working_dir: &Path, dir: &Path) -> Self {
        let (working_dir, dir) = (working_dir.to_owned(), dir.to_owned());
        let depth = dir.components().count();
        let root = working_dir.ancestors().nth(depth).unwrap_or(&working_dir).to_owned();
        Self { working_dir, dir, root }
    }

    /// Returns the file relative to the root of the repository, with `/` between names. A
    /// file outside of the repository keeps its absolute path.
    #[must_use]
    pub fn normalize(&self, file: &str) -> String {
        if file.is_empty() {
            return String::new();
        }
        let path = Path::new(file);
        let path = if path.is_absolute() {
            let inside = path.strip_prefix(&self.working_dir).map(|rest| self.dir.join(rest));
            inside.unwrap_or_else(|_| path.strip_prefix(&self.root).unwrap_or(path).to_owned())
        } else {
            self.dir.join(path)
        };
        without_dots(&path).to_string_lossy().into_owned()
    }
}

/// Resolves `.` and `..` by name only.
fn without_dots(path: &Path) -> PathBuf {
    let mut resolved = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir
                if matches!(resolved.components().next_back(), Some(Component::Normal(_))) =>
            {
                resolved.pop();
            }
            other => resolved.push(other),
        }
    }
    resolved
}

#[cfg(test)]
mod tests {
    use rtf_model::{Manifest, Revision};

    use super::*;

    fn base(working_dir: &str, dir: Option<&str>) -> SuiteFileBase {
        let revision = Revision { dir: dir.map(str::to_owned), ..Revision::default() };
        let manifest = Manifest { revision: Some(revision), ..Manifest::default() };
        SuiteFileBase::new(&RunStarted {
            version: 1,
            run: "r".to_owned(),
            rtf: "0".to_owned(),
            started_at: String::new(),
            command: Vec::new(),
            working_dir: working_dir.to_owned(),
            suites: 0,
            tests: 0,
            manifest: Box::new(manifest),
        })
    }

    #[test]
    fn a_suite_file_is_the_same_from_every_directory() {
        let cases = [
            ("/w/repo", Some(""), "tests/arm.xml"),
            ("/w/repo", Some(""), "./tests/../tests/arm.xml"),
            ("/w/repo", Some(""), "/w/repo/tests/arm.xml"),
            ("/w/repo/tests", Some("tests"), "arm.xml"),
            ("/w/repo/tests", Some("tests"), "/w/repo/tests/arm.xml"),
            ("/w/repo/build", Some("build"), "../tests/arm.xml"),
            ("/w/repo/build", Some("build"), "/w/repo/tests/arm.xml"),
            ("/w/repo", None, "tests/arm.xml"),
        ];
        for (working_dir, dir, file) in cases {
            let found = base(working_dir, dir).normalize(file);
            assert_eq!(found, "tests/arm.xml", "{file} in {working_dir}");
        }
    }

    #[test]
    fn a_suite_file_outside_of_the_repository_keeps_its_path() {
        let base = base("/w/repo", Some(""));
        assert_eq!(base.normalize("/opt/arm.xml"), "/opt/arm.xml");
        assert_eq!(base.normalize("../arm.xml"), "../arm.xml");
        assert_eq!(base.normalize(""), "");
    }
}
