//! The packages of a colcon workspace.

use std::path::{Path, PathBuf};

use crate::error::ImportError;
use crate::suite_file::ImportedTest;
use crate::{Import, ctest, recognize, rtf_suites};

/// Directories with tests of a Python package.
const TEST_DIRS: [&str; 2] = ["test", "tests"];

/// Directories of a workspace that contain no sources.
const NO_SOURCES: [&str; 3] = ["build", "install", "log"];

/// How deep packages are searched.
const DEPTH: usize = 8;

/// Finds the tests of all packages that were built.
pub fn import(workspace: &Path) -> Result<Import, ImportError> {
    let workspace = &crate::absolute(workspace)?;
    let build = workspace.join("build");
    let entries = std::fs::read_dir(&build).into_iter().flatten().filter_map(Result::ok);
    let mut packages: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    packages.retain(|path| path.join("colcon_build.rc").is_file());
    packages.sort();
    if packages.is_empty() {
        let error = format!("`{}` contains no packages that colcon has built", build.display());
        return Err(ImportError::new(error).hint("build the workspace with `colcon build`"));
    }
    let mut sources = Vec::new();
    find_packages(workspace, DEPTH, &mut sources);
    let mut tests = Vec::new();
    let mut suites = Vec::new();
    for package in &packages {
        let name = package.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let found = if package.join("CTestTestfile.cmake").is_file() {
            let (listed, found) = rtf_suites::take(ctest::list(package, None)?);
            found.into_iter().for_each(|suite| rtf_suites::add(&mut suites, suite));
            recognize::tests(&listed, package, None)
        } else if package.join("CMakeCache.txt").is_file() {
            // Built without tests.
            Vec::new()
        } else {
            python_tests(&name, &sources)
        };
        if let Some((_, dir)) = sources.iter().find(|(known, _)| *known == name) {
            let exported = rtf_suites::exported(dir)?;
            exported.into_iter().for_each(|suite| rtf_suites::add(&mut suites, suite));
        }
        // Names are unique in a package only.
        tests.extend(found.into_iter().map(|test| ImportedTest {
            name: if test.name.is_empty() { name.clone() } else { format!("{name}.{}", test.name) },
            ..test
        }));
    }
    if tests.is_empty() && suites.is_empty() {
        let error = format!("the packages in `{}` have no tests", build.display());
        let hint = "build them with `colcon build --cmake-args -DBUILD_TESTING=ON`";
        return Err(ImportError::new(error).hint(hint));
    }
    let name = workspace.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let source = format!("the colcon workspace {}", workspace.display());
    Ok(Import { name, source, tests, suites, set_up: set_up(workspace) })
}

/// The command that makes the packages of the workspace available.
fn set_up(workspace: &Path) -> Option<String> {
    let file = workspace.join("install/setup.bash");
    file.is_file().then(|| format!(". {}", file.display()))
}

/// The source directories of packages, with their names.
fn find_packages(dir: &Path, depth: usize, found: &mut Vec<(String, PathBuf)>) {
    if dir.join("COLCON_IGNORE").exists() {
        return;
    }
    if let Some(name) = package_name(dir) {
        found.push((name, dir.to_path_buf()));
        return;
    }
    let entries = std::fs::read_dir(dir).into_iter().flatten().filter_map(Result::ok);
    for entry in entries {
        let name = entry.file_name().to_string_lossy().into_owned();
        let is_source = !name.starts_with('.') && !NO_SOURCES.contains(&name.as_str());
        let is_dir = entry.file_type().is_ok_and(|kind| kind.is_dir());
        if is_source && is_dir && depth > 0 {
            find_packages(&entry.path(), depth - 1, found);
        }
    }
}

/// The name in `package.xml`, or of a directory with a Python package.
fn package_name(dir: &Path) -> Option<String> {
    if let Ok(text) = std::fs::read_to_string(dir.join("package.xml")) {
        let (_, rest) = text.split_once("<name>")?;
        return Some(rest.split_once("</name>")?.0.trim().to_owned());
    }
    let is_python =
        ["setup.py", "setup.cfg", "pyproject.toml"].iter().any(|it| dir.join(it).is_file());
    let name = dir.file_name()?.to_string_lossy().into_owned();
    is_python.then_some(name)
}

fn python_tests(package: &str, sources: &[(String, PathBuf)]) -> Vec<ImportedTest> {
    let dir = sources.iter().find(|(name, _)| name == package).map(|(_, dir)| dir);
    let test_dirs = dir.iter().flat_map(|dir| TEST_DIRS.map(|name| dir.join(name)));
    let tests = test_dirs.filter(|dir| dir.is_dir()).take(1).map(|dir| ImportedTest {
        kind: "pytest",
        subject: dir.to_string_lossy().into_owned(),
        comment: Some(format!("The tests of the Python package {package}")),
        ..ImportedTest::default()
    });
    tests.collect()
}
