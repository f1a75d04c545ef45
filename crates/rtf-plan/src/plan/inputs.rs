//! The paths that the user gave → suite files and plug-ins, in a fixed order.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use rtf_model::Diagnostic;

use super::hosts::{self, HOSTS};
use super::input_file::{DirectPlugin, InputFile};
use super::plugin_search::{self, PluginFinder};
use super::search_scope::SearchScope;
use super::{InputPath, Options};
use crate::suite::{is_replay_suite, is_suite_file};
use crate::wording::quoted;

/// A suite file or a plug-in to run.
#[derive(Debug)]
pub(super) enum ResolvedInput {
    Suite {
        file: InputFile,
        /// The names of the selected tests; empty for all.
        only: Vec<String>,
    },
    Plugin(DirectPlugin),
}

impl ResolvedInput {
    fn suite(file: InputFile) -> Self {
        Self::Suite { file, only: Vec::new() }
    }
}

/// The content of a directory to run.
#[derive(Clone, Copy, PartialEq, Eq)]
enum DirContent {
    /// The suites; if there are none, the plug-ins.
    Any,
    Suites,
    Plugins,
}

/// Resolves all paths and reports those that lead to nothing.
pub(super) fn resolve(
    inputs: &[InputPath],
    options: &Options,
    problems: &mut Vec<Diagnostic>,
) -> Vec<ResolvedInput> {
    let mut resolved = Vec::new();
    for input in inputs {
        match resolve_path(input, options) {
            Ok(more) => more.into_iter().for_each(|input| match unusable(&input) {
                Some(problem) => problems.push(problem),
                None => add(&mut resolved, input),
            }),
            Err(problem) => problems.push(*problem),
        }
    }
    resolved
}

/// Reports a suite whose path cannot be in a journal. That of a plug-in is checked where it is
/// planned.
fn unusable(input: &ResolvedInput) -> Option<Diagnostic> {
    let ResolvedInput::Suite { file, .. } = input else { return None };
    if file.path.to_str().is_some() {
        return None;
    }
    let message = format!("the suite `{}` cannot be used: its path is not UTF-8", file.name);
    Some(Diagnostic::error("path-encoding", message).hint("rename the file or its directory"))
}

/// Adds an input; merges selected tests of the same suite.
fn add(resolved: &mut Vec<ResolvedInput>, input: ResolvedInput) {
    if let (
        Some(ResolvedInput::Suite { file: last, only }),
        ResolvedInput::Suite { file, only: more },
    ) = (resolved.last_mut(), &input)
        && last.path == file.path
        && !only.is_empty()
        && !more.is_empty()
    {
        only.extend_from_slice(more);
        return;
    }
    resolved.push(input);
}

/// Resolves `suite.xml::EncoderTest`, one test of a suite. The text after `::` is not part
/// of a path: it keeps `//` and a slash at its end.
fn one_test(input: &InputFile, options: &Options) -> Option<ResolvedInput> {
    let (path, file, name) = (input.name.match_indices("::"))
        .map(|(at, _)| (&input.name[..at], &input.name[at + 2..]))
        .map(|(file, name)| (options.runner.absolute(Path::new(file)), file, name))
        .find(|(path, ..)| path.is_file())?;
    let only = vec![name.to_owned()];
    let file = InputFile { path, name: file.to_owned() };
    is_suite_file(&file.path).then_some(ResolvedInput::Suite { file, only })
}

fn resolve_path(
    input: &InputPath,
    options: &Options,
) -> Result<Vec<ResolvedInput>, Box<Diagnostic>> {
    let path = input.path();
    let name = path.to_string_lossy().into_owned();
    let file = InputFile { path: options.runner.absolute(path), name };
    let one = |input: ResolvedInput| vec![input];
    match input {
        InputPath::Any(_) if file.path.is_dir() => {
            resolve_dir(&file, DirContent::Any, options.recursive)
        }
        InputPath::Any(_) => resolve_file(file, options).map(one),
        InputPath::Plugins(_) => resolve_dir(&file, DirContent::Plugins, options.recursive),
        InputPath::Suites(_) => resolve_dir(&file, DirContent::Suites, options.recursive),
        InputPath::Suite(_) if file.path.exists() => Ok(one(ResolvedInput::suite(file))),
        InputPath::Suite(_) => Err(missing(&file).into()),
        InputPath::Plugin(_) => named_plugin(file, options).map(one),
    }
}

/// Finds a plug-in by its path, or by its name as in a suite.
fn named_plugin(file: InputFile, options: &Options) -> Result<ResolvedInput, Box<Diagnostic>> {
    let kind = hosts::by_extension(&file.path).unwrap_or(&HOSTS[0]);
    let scope = SearchScope::of_runner(&options.runner);
    match PluginFinder::default().find(&file.name, kind, &scope) {
        Some(path) => {
            let file = InputFile { path, ..file };
            Ok(ResolvedInput::Plugin(DirectPlugin { file, kind, from_dir: false }))
        }
        None => Err(plugin_search::not_found(&file.name, kind, &scope, true).into()),
    }
}

/// Resolves a file: a suite, or a plug-in by its extension.
fn resolve_file(file: InputFile, options: &Options) -> Result<ResolvedInput, Box<Diagnostic>> {
    if !file.path.exists() {
        return one_test(&file, options).ok_or_else(|| missing_test(&file).into());
    }
    if has_extension(&file.path, "xml") {
        return Ok(ResolvedInput::suite(file));
    }
    if let Some(kind) = hosts::by_extension(&file.path) {
        return Ok(ResolvedInput::Plugin(DirectPlugin { file, kind, from_dir: false }));
    }
    if is_suite_file(&file.path) {
        return Ok(ResolvedInput::suite(file));
    }
    let extensions = hosts::HOSTS.iter().flat_map(|kind| kind.extensions);
    let extensions: Vec<_> = extensions.map(|extension| format!(".{extension}")).collect();
    let list = quoted(extensions.iter().map(String::as_str), ", ");
    let message = format!("`{}` is neither a suite nor a plug-in", file.name);
    let note = format!("suites end in `.xml`, plug-ins in {list}");
    Err(Diagnostic::error("unknown-file", message).note(note).into())
}

/// Reports a missing file, or a file before `::` that is not a suite.
fn missing_test(input: &InputFile) -> Diagnostic {
    let paths = input.path.to_str().and_then(|path| path.split_once("::"));
    let names = input.name.split_once("::");
    let (Some((path, _)), Some((name, _))) = (paths, names) else { return missing(input) };
    let file = InputFile { path: PathBuf::from(path), name: name.to_owned() };
    if !file.path.exists() {
        return missing(&file);
    }
    let message = format!("`{name}` is not a suite: `::` cannot select a test of it");
    Diagnostic::error("unknown-file", message).hint(format!("remove the `::`: `{name}`"))
}

fn missing(file: &InputFile) -> Diagnostic {
    let problem =
        Diagnostic::error("no-such-file", format!("there is no file or directory `{}`", file.name))
            .note(format!("looked for {}", file.path.display()));
    let extensions = hosts::HOSTS.iter().flat_map(|kind| kind.extensions).chain(&["xml"]);
    let completed = extensions
        .map(|extension| format!("{}.{extension}", file.path.display()))
        .find(|path| Path::new(path).is_file());
    match completed {
        Some(path) => {
            let extension = Path::new(&path).extension().and_then(OsStr::to_str);
            let extension = extension.unwrap_or_default();
            problem.hint(format!("did you mean `{}.{extension}`?", file.name))
        }
        None => problem,
    }
}

/// Resolves a directory to its suites, or to its plug-ins.
fn resolve_dir(
    dir: &InputFile,
    content: DirContent,
    recursive: bool,
) -> Result<Vec<ResolvedInput>, Box<Diagnostic>> {
    let mut files = Vec::new();
    list_files(&dir.path, recursive, &mut files).map_err(|error| {
        let message = format!("cannot read the directory `{}`: {error}", dir.name);
        Box::new(Diagnostic::error("unreadable-directory", message))
    })?;
    // The file system returns entries in any order.
    files.sort();
    let input_file = |path: PathBuf| {
        let inside = path.strip_prefix(&dir.path).unwrap_or(&path);
        let name = Path::new(&dir.name).join(inside).to_string_lossy().into_owned();
        InputFile { path, name }
    };
    let is_suite = |path: &PathBuf| {
        has_extension(path, "xml") && !is_replay_suite(path) && is_suite_file(path)
    };
    let mut inputs: Vec<ResolvedInput> = Vec::new();
    if content != DirContent::Plugins {
        let suites = files.iter().filter(|path| is_suite(path)).cloned();
        inputs.extend(suites.map(|path| ResolvedInput::suite(input_file(path))));
    }
    if inputs.is_empty() && content != DirContent::Suites {
        inputs.extend(files.into_iter().filter_map(|path| {
            let kind = hosts::by_extension(&path)?;
            let file = input_file(path);
            Some(ResolvedInput::Plugin(DirectPlugin { file, kind, from_dir: true }))
        }));
    }
    if inputs.is_empty() {
        let what = match content {
            DirContent::Any => "neither a suite nor a plug-in",
            DirContent::Suites => "no suite",
            DirContent::Plugins => "no plug-in",
        };
        let message = format!("the directory `{}` contains {what}", dir.name);
        let problem = Diagnostic::error("no-tests", message);
        let hint = "`--recursive` also searches subdirectories";
        return Err(if recursive { problem } else { problem.hint(hint) }.into());
    }
    Ok(inputs)
}

/// Lists the files of a directory. Skips hidden directories, and links to
/// directories, which could form a cycle.
fn list_files(dir: &Path, recursive: bool, files: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in dir.read_dir()? {
        let entry = entry?;
        let path = entry.path();
        let is_hidden = entry.file_name().as_encoded_bytes().starts_with(b".");
        if entry.file_type()?.is_dir() {
            if recursive && !is_hidden && entry.file_name() != "__pycache__" {
                list_files(&path, recursive, files)?;
            }
        } else if !is_hidden && path.is_file() {
            files.push(path);
        }
    }
    Ok(())
}

fn has_extension(path: &Path, expected: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(expected))
}
