//! Suites of `rtf` that a build directory or a package already has: they are run as they are.

use std::path::{Path, PathBuf};

use crate::ctest::ListedTest;
use crate::error::ImportError;

/// The element of `package.xml` that exports a suite.
const EXPORT: &str = "rtf_suite";

/// A suite, and how to run it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExistingSuite {
    pub file: PathBuf,
    /// The environment variables with which CTest runs it, as `NAME=VALUE`.
    pub env: Vec<String>,
}

/// Takes the tests that run suites, or show results of one, out of a list.
pub fn take(listed: Vec<ListedTest>) -> (Vec<ListedTest>, Vec<ExistingSuite>) {
    let mut suites = Vec::new();
    let mut others = Vec::new();
    for test in listed {
        match classify(&test.command) {
            Part::Run(suite) => add(&mut suites, suite),
            Part::Result => {}
            Part::Other => others.push(test),
        }
    }
    (others, suites)
}

/// Adds a suite unless its file is known.
pub fn add(suites: &mut Vec<ExistingSuite>, mut suite: ExistingSuite) {
    suite.file = suite.file.canonicalize().unwrap_or(suite.file);
    if suites.iter().all(|known| known.file != suite.file) {
        suites.push(suite);
    }
}

/// The suites in `<export><rtf_suite>FILE</rtf_suite></export>` of a package's `package.xml`.
pub fn exported(package: &Path) -> Result<Vec<ExistingSuite>, ImportError> {
    let manifest = package.join("package.xml");
    let Ok(text) = std::fs::read_to_string(&manifest) else { return Ok(Vec::new()) };
    let (start, end) = (format!("<{EXPORT}>"), format!("</{EXPORT}>"));
    let elements = text.split(&start).skip(1).filter_map(|rest| rest.split_once(&end));
    let suite = |(name, _): (&str, &str)| {
        let file = package.join(name.trim());
        let file = file.canonicalize().map_err(|_| {
            let error = format!("`{}` exports a suite that does not exist", manifest.display());
            ImportError::new(error).hint(format!("there is no file `{}`", file.display()))
        })?;
        Ok(ExistingSuite { file, env: Vec::new() })
    };
    elements.map(suite).collect()
}

/// What a command of CTest does.
enum Part {
    Run(ExistingSuite),
    /// It shows a result of a run.
    Result,
    Other,
}

fn classify(command: &[String]) -> Part {
    // As `rtf_add_suite` writes it.
    let suite = command.iter().find_map(|word| word.strip_prefix("-Drtf_suite="));
    if let Some(suite) = suite {
        return Part::Run(ExistingSuite { file: suite.into(), env: assignments(command) });
    }
    let is_rtf = |word: &String| Path::new(word).file_name().is_some_and(|name| name == "rtf");
    let Some(at) = command.iter().rposition(is_rtf) else { return Part::Other };
    let (before, after) = command.split_at(at);
    match after.get(1).map(String::as_str) {
        Some("show") => return Part::Result,
        Some("run") => {}
        _ => return Part::Other,
    }
    let files = after.iter().skip(2).filter(|word| !word.contains('='));
    let files = files.map(|word| word.split("::").next().unwrap_or(word));
    let suites: Vec<&str> = files.filter(|file| file.ends_with(".xml")).collect();
    match suites.as_slice() {
        [suite] => Part::Run(ExistingSuite { file: suite.into(), env: assignments(before) }),
        _ => Part::Other,
    }
}

/// The variables that wrappers set: `cmake -E env` and ament's `run_test.py --env`.
fn assignments(words: &[String]) -> Vec<String> {
    let is_name = |name: &str| {
        name.chars().all(|c| c == '_' || c.is_ascii_alphanumeric())
            && name.starts_with(|c: char| !c.is_ascii_digit())
    };
    let is_assignment =
        |word: &&String| word.split_once('=').is_some_and(|(name, _)| is_name(name));
    words.iter().filter(is_assignment).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn test(command: &str) -> ListedTest {
        ListedTest::new("arm", &command.split(' ').collect::<Vec<_>>(), &[])
    }

    #[test]
    fn tests_of_suites_are_recognised() {
        let (others, suites) = take(vec![
            test("/usr/bin/cmake -E env A=1 /usr/bin/cmake -Drtf_suite=/p/one.xml -P run.cmake"),
            test("/usr/bin/cmake -E env A=1 /usr/bin/rtf show --single-test=one/Move /b/link"),
            test(
                "python3 -u /x/run_test.py r.xml --env B=2 --command /bin/rtf run /p/two.xml --report junit=r.xml",
            ),
            test("/usr/bin/cmake -E env /usr/bin/rtf run /p/three.xml::Move"),
            test("/usr/bin/cmake -E env /usr/bin/rtf run /p/three.xml::Grip"),
            test("/usr/bin/rtf run /b/ArmTest.so"),
            test("/b/arm_test"),
        ]);
        assert_eq!(others.len(), 2);
        let suite = |file: &str, env: &[&str]| ExistingSuite {
            file: file.into(),
            env: env.iter().map(|&text| text.to_owned()).collect(),
        };
        let expected = [
            suite("/p/one.xml", &["A=1"]),
            suite("/p/two.xml", &["B=2"]),
            suite("/p/three.xml", &[]),
        ];
        assert_eq!(suites, expected);
    }

    #[test]
    fn exported_suites() {
        let dir = tempfile::tempdir().unwrap();
        let dir = dir.path().canonicalize().unwrap();
        assert_eq!(exported(&dir).unwrap(), []);
        let manifest = "<package><export><rtf_suite> a.xml </rtf_suite><rtf_suite>b.xml</rtf_suite></export></package>";
        std::fs::write(dir.join("package.xml"), manifest).unwrap();
        std::fs::write(dir.join("a.xml"), "").unwrap();
        assert!(exported(&dir).is_err());
        std::fs::write(dir.join("b.xml"), "").unwrap();
        let files: Vec<_> = exported(&dir).unwrap().into_iter().map(|suite| suite.file).collect();
        assert_eq!(files, [dir.join("a.xml"), dir.join("b.xml")]);
    }
}
