//! `rtf import`: writes a suite file with the tests of a build directory or workspace.
//!
//! [`ctest`] lists the tests of CTest, [`recognize`] finds the framework of each,
//! [`colcon`] finds the packages of a workspace, and [`suite_file`] writes the suite.

mod colcon;
mod ctest;
mod recognize;
mod suite_file;

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use rtf_report::escape;

use super::VerbResult;
use crate::cli::{ImportOutput, ImportVerb};
use crate::error::Failure;
use crate::terminal;
use suite_file::ImportedTest;

/// The tests that were found, and how to run them.
struct Import {
    /// The suite's name.
    name: String,
    /// Where they were found.
    source: String,
    tests: Vec<ImportedTest>,
    /// A shell command that has to run before `rtf`.
    set_up: Option<String>,
}

/// Imports tests.
pub fn run(verb: &ImportVerb) -> VerbResult {
    let (import, output) = match verb {
        ImportVerb::Ctest { build, config, output } => {
            refuse_existing(output)?;
            (from_ctest(build, config.as_deref())?, output)
        }
        ImportVerb::Colcon { workspace, output } => {
            refuse_existing(output)?;
            (colcon::import(&absolute(workspace)?)?, output)
        }
    };
    write(&import, output)?;
    Ok(ExitCode::SUCCESS)
}

fn from_ctest(build: &Path, config: Option<&str>) -> Result<Import, Failure> {
    let build = absolute(build)?;
    let listed = ctest::list(&build, config)?;
    let tests = recognize::tests(&listed, &build, config);
    if tests.is_empty() {
        let error = format!("`{}` has no tests", build.display());
        let hint = match ctest::has_configurations(&build) && config.is_none() {
            true => "choose a configuration, for example with `-C Release`",
            false => "configure it with `-DBUILD_TESTING=ON`",
        };
        return Err(Failure::input(error).hint(hint));
    }
    let name = ctest::project_name(&build);
    let source = format!("the build directory {}", build.display());
    Ok(Import { name, source, tests, set_up: None })
}

fn absolute(path: &Path) -> Result<PathBuf, Failure> {
    let found = path.canonicalize().ok().filter(|path| path.is_dir());
    found.ok_or_else(|| Failure::input(format!("there is no directory `{}`", path.display())))
}

/// Fails early, before programs are started.
fn refuse_existing(output: &ImportOutput) -> Result<(), Failure> {
    if output.force || !output.output.exists() {
        return Ok(());
    }
    Err(exists(&output.output))
}

fn exists(file: &Path) -> Failure {
    let error = format!("`{}` exists", file.display());
    Failure::input(error).hint("`--force` overwrites it, `--output FILE` writes to another file")
}

fn write(import: &Import, output: &ImportOutput) -> Result<(), Failure> {
    let file = &output.output;
    let dir = match file.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => absolute(parent)?,
        _ => absolute(Path::new("."))?,
    };
    let text = suite_file::text(&import.name, &import.source, &import.tests, &dir);
    let written = match output.force {
        true => std::fs::write(file, text),
        false => std::fs::File::create_new(file)
            .and_then(|mut created| io::Write::write_all(&mut created, text.as_bytes())),
    };
    written.map_err(|error| match error.kind() {
        io::ErrorKind::AlreadyExists => exists(file),
        _ => Failure::input(format!("`{}` cannot be written: {error}", file.display())),
    })?;
    print(import, file)
}

/// Prints the tests by type, and the next command.
fn print(import: &Import, file: &Path) -> Result<(), Failure> {
    let mut by_type: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for test in &import.tests {
        by_type.entry(test.kind).or_default().push(&test.name);
    }
    let (count, file) = (import.tests.len(), file.display().to_string());
    let plural = if count == 1 { "" } else { "s" };
    let set_up = import.set_up.as_ref().map_or(String::new(), |command| format!("{command} && "));
    terminal::stdout(|out| {
        writeln!(out, "wrote {}: {count} test{plural}", escape::line(&file))?;
        for (kind, names) in &by_type {
            writeln!(out, "  {kind}: {}", escape::line(&names.join(", ")))?;
        }
        writeln!(out, "next: {}rtf run {}", escape::line(&set_up), escape::line(&file))
    })
}
