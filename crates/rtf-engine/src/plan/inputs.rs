//! The paths that the user gave → suite files and plug-ins, in a fixed order.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use rtf_model::Diagnostic;

use super::hosts::{self, HOSTS, HostKind};
use super::plugin::{self, Finder};
use super::scope::Scope;
use super::{Options, Request};
use crate::suite::is_suite_file;

/// One thing to run.
#[derive(Debug)]
pub(super) enum Input {
    /// A suite file, and the names of the only tests that are wanted of it;
    /// none stands for all.
    Suite(Found, Vec<String>),
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

/// What of a folder is wanted.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Content {
    /// Its suites, and when it has none its plug-ins.
    Any,
    Suites,
    Plugins,
}

/// Looks at each path.
pub(super) fn collect(
    requests: &[Request],
    options: &Options,
    problems: &mut Vec<Diagnostic>,
) -> Vec<Input> {
    let mut inputs = Vec::new();
    for request in requests {
        match look(request, options) {
            Ok(more) => more.into_iter().for_each(|input| add(&mut inputs, input)),
            Err(problem) => problems.push(*problem),
        }
    }
    inputs
}

/// Several tests of a suite are one input.
fn add(inputs: &mut Vec<Input>, input: Input) {
    if let (Some(Input::Suite(last, wanted)), Input::Suite(found, more)) =
        (inputs.last_mut(), &input)
        && last.path == found.path
        && !wanted.is_empty()
        && !more.is_empty()
    {
        wanted.extend_from_slice(more);
        return;
    }
    inputs.push(input);
}

/// `suite.xml::EncoderTest`: one test of a suite.
fn one_test(found: &Found) -> Option<Input> {
    let path = found.path.to_str()?;
    let (file, name) = (path.match_indices("::"))
        .map(|(at, _)| (Path::new(&path[..at]), &path[at + 2..]))
        .find(|(file, _)| file.is_file())?;
    let suite_name = found.name.strip_suffix(name)?.strip_suffix("::")?.to_owned();
    let suite = Found { path: file.to_owned(), name: suite_name };
    is_suite_file(file).then(|| Input::Suite(suite, vec![name.to_owned()]))
}

fn look(request: &Request, options: &Options) -> Result<Vec<Input>, Box<Diagnostic>> {
    let found = |path: &Path| Found {
        path: options.surroundings.absolute(path),
        name: path.to_string_lossy().into_owned(),
    };
    let one = |input: Input| vec![input];
    match request {
        Request::Any(path) if found(path).path.is_dir() => {
            folder(&found(path), Content::Any, options.recursive)
        }
        Request::Any(path) => file(found(path)).map(one),
        Request::Plugins(path) => folder(&found(path), Content::Plugins, options.recursive),
        Request::Suites(path) => folder(&found(path), Content::Suites, options.recursive),
        Request::Suite(path) => match found(path) {
            found if found.path.exists() => Ok(one(Input::Suite(found, Vec::new()))),
            found => Err(missing(&found).into()),
        },
        Request::Plugin(path) => named_plugin(found(path), options).map(one),
    }
}

/// A plug-in that is named like in a suite, or by its path.
fn named_plugin(found: Found, options: &Options) -> Result<Input, Box<Diagnostic>> {
    let kind = hosts::by_extension(&found.path).unwrap_or(&HOSTS[0]);
    let surroundings = &options.surroundings;
    let folder = &surroundings.current_folder;
    let scope = Scope { surroundings, folder, beside: None, suite: &[], own: &[] };
    match Finder::new().find(&found.name, kind, &scope) {
        Some(path) => {
            Ok(Input::Plugin { found: Found { path, ..found }, kind, from_folder: false })
        }
        None => Err(plugin::not_found(&found.name, kind, &scope, true).into()),
    }
}

/// A file that the user named: a suite, or a plug-in by its extension.
fn file(found: Found) -> Result<Input, Box<Diagnostic>> {
    if !found.path.exists() {
        return one_test(&found).ok_or_else(|| missing_test(found).into());
    }
    if has_extension(&found.path, "xml") {
        return Ok(Input::Suite(found, Vec::new()));
    }
    if let Some(kind) = hosts::by_extension(&found.path) {
        return Ok(Input::Plugin { found, kind, from_folder: false });
    }
    if is_suite_file(&found.path) {
        return Ok(Input::Suite(found, Vec::new()));
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

/// What was named has `::` in it, perhaps, and leads to no test of a suite.
fn missing_test(found: Found) -> Diagnostic {
    let parts = found.path.to_str().and_then(|path| path.split_once("::"));
    let names = found.name.split_once("::");
    let (Some((path, _)), Some((name, _))) = (parts, names) else { return missing(&found) };
    let file = Found { path: PathBuf::from(path), name: name.to_owned() };
    if !file.path.exists() {
        return missing(&file);
    }
    let message = format!("`{name}` is no suite of which `::` could name a test");
    Diagnostic::error("unknown-file", message).hint(format!("leave `::` away: `{name}`"))
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
fn folder(
    folder: &Found,
    content: Content,
    recursive: bool,
) -> Result<Vec<Input>, Box<Diagnostic>> {
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
    let is_suite = |path: &PathBuf| has_extension(path, "xml") && is_suite_file(path);
    let mut inputs: Vec<Input> = Vec::new();
    if content != Content::Plugins {
        let suites = files.iter().filter(|path| is_suite(path)).cloned();
        inputs.extend(suites.map(|path| Input::Suite(named(path), Vec::new())));
    }
    if inputs.is_empty() && content != Content::Suites {
        inputs.extend(files.into_iter().filter_map(|path| plugin_in_folder(named(path))));
    }
    if inputs.is_empty() {
        let what = match content {
            Content::Any => "neither a suite nor a plug-in",
            Content::Suites => "no suite",
            Content::Plugins => "no plug-in",
        };
        let message = format!("the folder `{}` holds {what}", folder.name);
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
