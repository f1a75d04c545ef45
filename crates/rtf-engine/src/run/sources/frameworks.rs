//! The files of a test of another framework, in addition to its program.

use std::path::{Path, PathBuf};

use rtf_plan::plan::PluginPlan;

use super::scripts::below;

/// The files that a test needs, apart from the file that it names; `None` if they are not known.
pub(super) fn files(plugin: &PluginPlan, suite_dir: &Path) -> Option<Vec<PathBuf>> {
    let of_project = |mark: &str, extensions: &[&str]| {
        let root = plugin.file.ancestors().find(|dir| dir.join(mark).is_file());
        below(root.unwrap_or(&plugin.file), extensions)
    };
    match &*plugin.plugin_type {
        // The programs that a build directory or a launch file names are not known.
        "ctest" | "rostest" => None,
        "cargo" => of_project("Cargo.lock", &["rs", "toml", "lock"]),
        "go" => of_project("go.mod", &["go", "mod", "sum"]),
        "junit" if plugin.file.is_dir() => below(&plugin.file, &["class"]),
        "pytest" | "unittest" | "launch_testing" => {
            let mut files = configuration(&plugin.file, suite_dir);
            if plugin.file.is_dir() {
                files.extend(below(&plugin.file, &["py"])?);
            }
            Some(files)
        }
        // An interpreter and its script.
        "program" | "tap" => {
            let script = plugin.args.iter().find(|arg| !arg.starts_with('-'));
            let script = script.map(|script| suite_dir.join(script));
            Some(script.filter(|script| script.is_file()).into_iter().collect())
        }
        _ => Some(Vec::new()),
    }
}

/// The files that pytest loads first: `conftest.py` of the directory of the tests and of those above
/// it, up to that of the suite.
fn configuration(tests: &Path, suite_dir: &Path) -> Vec<PathBuf> {
    let is_inside = tests.starts_with(suite_dir);
    let dirs = tests.ancestors().skip(1);
    let dirs = dirs.take_while(|dir| is_inside && dir.starts_with(suite_dir));
    dirs.map(|dir| dir.join("conftest.py")).filter(|file| file.is_file()).collect()
}
