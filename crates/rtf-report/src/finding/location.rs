//! Locations in the repository, for code hosts.

use std::path::{Component, Path, PathBuf};

use rtf_model::{Location, Record, SuiteRecord, TestRecord};

use crate::explain;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct RepositoryLocation {
    /// The file, from the repository's root, with `/`.
    pub file: String,
    /// The line, from 1; 0 when it is unknown.
    pub line: u32,
    /// The column, from 1; 0 when it is unknown.
    pub column: u32,
}

/// Where paths begin.
pub(crate) struct Roots<'a> {
    /// The directory in which the run was started.
    folder: &'a Path,
    repository: &'a Path,
}

impl<'a> Roots<'a> {
    /// The roots of a run. Without a repository, the run's directory is used.
    pub fn new(record: &'a Record, repository: Option<&'a Path>) -> Self {
        let folder = Path::new(record.run.as_ref().map_or("", |run| run.working_dir.as_str()));
        Self { folder, repository: repository.unwrap_or(folder) }
    }

    /// A place in a file; `None` when the file is not in the repository.
    pub fn place(&self, file: &str, line: u32) -> Option<RepositoryLocation> {
        if file.is_empty() {
            return None;
        }
        let absolute = normal(&self.folder.join(file));
        let inside = absolute.strip_prefix(normal(self.repository)).ok()?;
        let parts: Vec<_> =
            inside.components().map(|part| part.as_os_str().to_string_lossy()).collect();
        Some(RepositoryLocation { file: parts.join("/"), line, column: 0 })
    }

    /// The file of a suite.
    pub fn suite(&self, suite: &SuiteRecord) -> Option<RepositoryLocation> {
        self.place(&suite.plan.file, 0)
    }

    /// Where a test went wrong: the first failure with a place in the
    /// repository, else its suite's file, else its plug-in.
    pub fn test(&self, record: &Record, test: &TestRecord) -> Option<RepositoryLocation> {
        let attempt = test.decisive_attempt();
        let own = attempt.into_iter().flat_map(explain::own_failures);
        let failures = own.chain(attempt.into_iter().flat_map(|attempt| attempt.failures()));
        let violations = attempt.into_iter().flat_map(|attempt| attempt.violations());
        let series = attempt.into_iter().flat_map(|attempt| &attempt.series);
        let series = series.filter(|series| series.outside > 0);
        let mut locations = failures
            .filter_map(|failure| failure.location.as_ref())
            .chain(violations.filter_map(|violation| violation.location.as_ref()))
            .chain(series.filter_map(|series| series.location.as_ref()));
        let at = |Location { file, line }: &Location| self.place(file, *line);
        let suite = || record.suites.get(test.plan.suite.index());
        locations
            .find_map(at)
            .or_else(|| self.suite(suite()?))
            .or_else(|| self.place(&test.plan.plugin, 0))
    }
}

/// The path without `.` and `..`, resolved lexically.
fn normal(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if normal.file_name().is_some() => {
                normal.pop();
            }
            part => normal.push(part),
        }
    }
    normal
}

#[cfg(test)]
mod tests {
    use super::*;

    fn placed(file: &str) -> Option<String> {
        let roots = Roots {
            folder: Path::new("/home/r/robot/tests"),
            repository: Path::new("/home/r/robot"),
        };
        roots.place(file, 1).map(|place| place.file)
    }

    #[test]
    fn files_are_named_from_the_repositorys_root() {
        assert_eq!(placed("arm.xml").as_deref(), Some("tests/arm.xml"));
        assert_eq!(placed("./a/../arm.xml").as_deref(), Some("tests/arm.xml"));
        assert_eq!(placed("../src/rate.cpp").as_deref(), Some("src/rate.cpp"));
        assert_eq!(placed("/home/r/robot/src/rate.cpp").as_deref(), Some("src/rate.cpp"));
        assert_eq!(placed("/usr/include/c++/vector"), None);
        assert_eq!(placed("/home/r/robot2/x.py"), None);
        assert_eq!(placed(""), None);
    }
}
