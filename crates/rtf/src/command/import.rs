//! `rtf import`: writes a suite file with the tests of a build directory or workspace.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::process::ExitCode;

use rtf_import::{ExistingSuite, Import, ImportError, absolute, from_colcon, from_ctest};
use rtf_report::escape;
use rtf_run::error::Failure;
use rtf_run::terminal;

use super::VerbResult;
use crate::cli::{ImportOutput, ImportVerb};

/// Imports tests.
pub fn run(verb: &ImportVerb) -> VerbResult {
    let (import, output) = match verb {
        ImportVerb::Ctest { build, config, output } => {
            refuse_existing(output)?;
            (from_ctest(build, config.as_deref()).map_err(failure)?, output)
        }
        ImportVerb::Colcon { workspace, output } => {
            refuse_existing(output)?;
            (from_colcon(workspace).map_err(failure)?, output)
        }
    };
    write(&import, output)?;
    Ok(ExitCode::SUCCESS)
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
    if import.tests.is_empty() {
        return print(import, None);
    }
    let file = &output.output;
    let dir = match file.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => absolute(parent).map_err(failure)?,
        _ => absolute(Path::new(".")).map_err(failure)?,
    };
    let text = import.suite(&dir);
    let written = match output.force {
        true => std::fs::write(file, text),
        false => std::fs::File::create_new(file)
            .and_then(|mut created| io::Write::write_all(&mut created, text.as_bytes())),
    };
    written.map_err(|error| match error.kind() {
        io::ErrorKind::AlreadyExists => exists(file),
        _ => Failure::input(format!("`{}` cannot be written: {error}", file.display())),
    })?;
    print(import, Some(file))
}

/// Prints the tests by type, the suites that exist already, and the next commands.
fn print(import: &Import, file: Option<&Path>) -> Result<(), Failure> {
    let mut by_type: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for test in &import.tests {
        by_type.entry(test.kind).or_default().push(&test.name);
    }
    let (count, file) = (import.tests.len(), file.map(|file| file.display().to_string()));
    let plural = if count == 1 { "" } else { "s" };
    let set_up = import.set_up.as_ref().map_or(String::new(), |command| format!("{command} && "));
    terminal::stdout(|out| {
        if let Some(file) = &file {
            writeln!(out, "wrote {}: {count} test{plural}", escape::line(file))?;
        }
        for (kind, names) in &by_type {
            writeln!(out, "  {kind}: {}", escape::line(&names.join(", ")))?;
        }
        for command in existing_suites(&import.suites) {
            writeln!(out, "next: {}{}", escape::line(&set_up), escape::line(&command))?;
        }
        let Some(file) = &file else { return Ok(()) };
        writeln!(out, "next: {}rtf run {}", escape::line(&set_up), escape::line(file))
    })
}

/// The commands that run suites: one for suites with the same environment.
fn existing_suites(suites: &[ExistingSuite]) -> Vec<String> {
    let mut commands: Vec<(&[String], String)> = Vec::new();
    for suite in suites {
        let file = suite.file.to_string_lossy();
        let file = shell_words::quote(&file);
        if let Some((_, command)) = commands.iter_mut().find(|(env, _)| *env == suite.env) {
            *command += &format!(" {file}");
            continue;
        }
        let assignment = |text: &String| match text.split_once('=') {
            Some((name, value)) => format!("{name}={} ", shell_words::quote(value)),
            None => String::new(),
        };
        let env: String = suite.env.iter().map(assignment).collect();
        commands.push((&suite.env, format!("{env}rtf run {file}")));
    }
    commands.into_iter().map(|(_, command)| command).collect()
}

fn failure(mut error: ImportError) -> Failure {
    let hint = error.hint.take();
    Failure::input(error).maybe_hint(hint)
}
