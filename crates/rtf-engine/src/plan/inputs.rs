//! The paths that the user gave → suite files and plug-ins, in a fixed order.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use rtf_model::Diagnostic;

use super::Surroundings;
use super::hosts::{self, HostKind};
use crate::suite::is_suite_file;

/// One thing to run.
#[derive(Debug)]
pub(super) enum Input {
    /// A suite file.
    Suite(Found),
    /// A plug-in.
    Plugin {
        /// Its file.
        found: Found,
        /// Its type.
        kind: &'static HostKind,
        /// Whether it was not named but lies in a folder that was: what turns
        /// out not to hold a test is then left out.
        from_folder: bool,
    },
}

/// A file.
#[derive(Debug)]
pub(super) struct Found {
    /// Absolute.
    pub path: PathBuf,
    /// As the user would name it.
    pub name: String,
}

/// Looks at each path.
pub(super) fn collect(
    paths: &[PathBuf],
    recursive: bool,
    surroundings: &Surroundings,
    problems: &mut Vec<Diagnostic>,
) -> Vec<Input> {
    let mut inputs = Vec::new();
    for path in paths {
        let found =
            Found { path: surroundings.absolute(path), name: path.to_string_lossy().into_owned() };
        let looked = if found.path.is_dir() {
            folder(&found, recursive)
        } else {
            file(found).map(|input| vec![input])
        };
        match looked {
            Ok(more) => inputs.extend(more),
            Err(problem) => problems.push(*problem),
        }
    }
    inputs
}

/// A file that the user named: a suite, or a plug-in by its extension.
fn file(found: Found) -> Result<Input, Box<Diagnostic>> {
    if !found.path.exists() {
        return Err(missing(&found).into());
    }
    if has_extension(&found.path, "xml") {
        return Ok(Input::Suite(found));
    }
    if let Some(kind) = hosts::by_extension(&found.path) {
        return Ok(Input::Plugin { found, kind, from_folder: false });
    }
    if is_suite_file(&found.path) {
        return Ok(Input::Suite(found));
    }
    let known: Vec<_> = hosts::HOSTS
        .iter()
        .flat_map(|kind| kind.extensions)
        .map(|extension| format!("`.{extension}`"))
        .collect();
    let message = format!("`{}` is neither a suite nor a plug-in", found.name);
    let note = format!("suites end in `.xml`, plug-ins in {}", known.join(", "));
    Err(Diagnostic::error("unknown-file", message).note(note).into())
}

fn missing(found: &Found) -> Diagnostic {
    let problem =
        Diagnostic::error("no-such-file", format!("there is no file or folder `{}`", found.name))
            .note(format!("looked for {}", found.path.display()));
    let endings = hosts::HOSTS.iter().flat_map(|kind| kind.extensions).chain(&["xml"]);
    let completed = endings
        .map(|ending| format!("{}.{ending}", found.path.display()))
        .find(|path| Path::new(path).is_file());
    match completed {
        Some(path) => {
            let ending = Path::new(&path).extension().and_then(OsStr::to_str).unwrap_or_default();
            problem.hint(format!("did you mean `{}.{ending}`?", found.name))
        }
        None => problem,
    }
}

/// A folder stands for its suites, and when it has none for its plug-ins.
fn folder(folder: &Found, recursive: bool) -> Result<Vec<Input>, Box<Diagnostic>> {
    let mut files = Vec::new();
    list(&folder.path, recursive, &mut files).map_err(|error| {
        let message = format!("cannot read the folder `{}`: {error}", folder.name);
        Box::new(Diagnostic::error("unreadable-folder", message))
    })?;
    // The file system's order is not one that can be relied on.
    files.sort();
    let named = |path: PathBuf| {
        let inside = path.strip_prefix(&folder.path).unwrap_or(&path);
        let name = Path::new(&folder.name).join(inside).to_string_lossy().into_owned();
        Found { path, name }
    };
    let is_suite = |path: &&PathBuf| has_extension(path, "xml") && is_suite_file(path);
    let suites: Vec<PathBuf> = files.iter().filter(is_suite).cloned().collect();
    let inputs: Vec<Input> = if suites.is_empty() {
        files.into_iter().filter_map(|path| plugin_in_folder(named(path))).collect()
    } else {
        suites.into_iter().map(|path| Input::Suite(named(path))).collect()
    };
    if inputs.is_empty() {
        let message = format!("the folder `{}` holds neither a suite nor a plug-in", folder.name);
        let problem = Diagnostic::error("no-tests", message);
        let hint = "folders inside of it are searched with `--recursive`";
        return Err(if recursive { problem } else { problem.hint(hint) }.into());
    }
    Ok(inputs)
}

fn plugin_in_folder(found: Found) -> Option<Input> {
    let kind = hosts::by_extension(&found.path)?;
    Some(Input::Plugin { found, kind, from_folder: true })
}

/// The files of a folder. Hidden folders, and links to folders, which could
/// lead in a circle, are not entered.
fn list(folder: &Path, recursive: bool, files: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in folder.read_dir()? {
        let entry = entry?;
        let path = entry.path();
        let hidden = entry.file_name().as_encoded_bytes().starts_with(b".");
        if entry.file_type()?.is_dir() {
            if recursive && !hidden && entry.file_name() != "__pycache__" {
                list(&path, recursive, files)?;
            }
        } else if !hidden && path.is_file() {
            files.push(path);
        }
    }
    Ok(())
}

fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}
