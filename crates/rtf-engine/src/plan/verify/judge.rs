//! From a host's answers to diagnostics at the suite's lines.

use std::path::Path;
use std::sync::Arc;

use rtf_model::Diagnostic;

use super::ask::{Answer, Word};
use super::{FileUse, Group, Places, SHOWN_PLACES, Verified};
use crate::plan::context::Role;
use crate::plan::hosts;
use crate::suite::Source;

/// A plug-in's text longer than this is not shown.
const SHOWN_BYTES: u64 = 4 * 1024 * 1024;

/// Judges the answers about a group's files from `first` on.
pub(super) fn judge(group: &Group, first: usize, answers: Vec<Answer>, verified: &mut Verified) {
    for (entry, answer) in group.files[first..].iter().zip(answers) {
        let problem = match answer {
            Answer::Said(word) if word.ok => {
                kinds(entry, &word, verified);
                continue;
            }
            Answer::Said(word) => unloadable(entry, &word, verified),
            Answer::Died { how, stderr } => {
                let message = format!("loading `{}` ended its host: {how}", shown(&entry.file));
                with_stderr(Diagnostic::error("plugin-not-loadable", message), &stderr)
            }
            Answer::Silent(limit) => {
                let message =
                    format!("loading `{}` takes longer than {limit:?}", shown(&entry.file));
                Diagnostic::error("plugin-not-loadable", message)
            }
            Answer::HostFailed { how, stderr } => {
                let problem = host(group, &how, &stderr);
                if verified.problems.iter().any(|known| known.message == problem.message) {
                    continue;
                }
                problem
            }
        };
        verified.problems.push(all_places(entry, problem));
    }
}

fn shown(file: &Path) -> String {
    file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned()
}

fn with_stderr(problem: Diagnostic, stderr: &str) -> Diagnostic {
    if stderr.is_empty() { problem } else { problem.note(format!("it printed\n{stderr}")) }
}

/// Said once of a host, however many plug-ins and suites need it.
fn host(group: &Group, how: &str, stderr: &str) -> Diagnostic {
    let command = shell_words::join(&group.host.command);
    let message = format!("the host `{command}` does not work: {how}");
    let problem = with_stderr(Diagnostic::error("host-failed", message), stderr);
    problem.hint(format!("`{command} --check` has to end with exit code 0"))
}

/// The host could not load it: its loader's or its compiler's words.
fn unloadable(entry: &FileUse, word: &Word, verified: &mut Verified) -> Diagnostic {
    let said = word.message.as_deref().unwrap_or("the host does not say why").trim();
    // Some hosts begin with the words of the message itself.
    let said = said.strip_prefix("cannot be loaded: ").unwrap_or(said);
    let (first, rest) = said.split_once('\n').unwrap_or((said, ""));
    let mut message = format!("the plug-in `{}` cannot be loaded: {first}", shown(&entry.file));
    let label = word.line.and_then(|line| {
        let source = text_of(&entry.file)?;
        let label = source.label(source.line_span(line)?, first);
        verified.sources.add(Arc::new(source));
        Some(label)
    });
    if let (Some(line), None) = (word.line, &label) {
        message = format!("{message} (line {line})");
    }
    let problem = Diagnostic::error("plugin-not-loadable", message);
    let problem = if rest.is_empty() { problem } else { problem.note(rest.trim_end()) };
    let problem = match first.starts_with("undefined symbol") {
        true => problem.hint("link the plug-in with the library that defines it"),
        false => problem,
    };
    match label {
        Some(label) => problem.label(label),
        None => problem.note(format!("the file is {}", entry.file.display())),
    }
}

fn text_of(file: &Path) -> Option<Source> {
    let short = file.metadata().is_ok_and(|found| found.len() <= SHOWN_BYTES);
    let text = short.then(|| std::fs::read_to_string(file).ok())??;
    Some(Source::new(file.to_string_lossy(), text))
}

/// It loads; is it what the suite takes it for?
fn kinds(entry: &FileUse, word: &Word, verified: &mut Verified) {
    let Some(kinds) = &word.kinds else { return };
    let uses =
        [(Role::Test, &entry.tests), (Role::Fixture, &entry.fixtures), (Role::Hook, &entry.hooks)];
    for (role, places) in uses {
        if places.count == 0 || kinds.iter().any(|kind| kind == role.kind()) {
            continue;
        }
        if entry.optional {
            verified.left_out.insert(entry.file.clone());
            continue;
        }
        let file = shown(&entry.file);
        let wanted = role.kind();
        let problem = match kinds.first() {
            Some(other) => {
                let message = format!("the plug-in `{file}` is a {other}, not a {wanted}");
                Diagnostic::error("wrong-kind", message).hint(role.advice())
            }
            None => nothing_in(entry, &role),
        };
        verified.problems.push(show(places, problem, "used here"));
    }
}

fn nothing_in(entry: &FileUse, role: &Role) -> Diagnostic {
    let wanted = role.kind();
    let message = format!("`{}` holds no {wanted}", shown(&entry.file));
    let problem = Diagnostic::error("wrong-kind", message);
    let class = if matches!(role, Role::Fixture) { "FixtureManager" } else { "TestCase" };
    match hosts::by_extension(&entry.file).and_then(|kind| kind.classes_in) {
        Some(of) => problem.hint(format!("a {wanted} is a class that derives from `{of}{class}`")),
        None => problem,
    }
}

fn all_places(entry: &FileUse, problem: Diagnostic) -> Diagnostic {
    let problem = show(&entry.tests, problem, "needed here");
    let problem = show(&entry.fixtures, problem, "needed here");
    show(&entry.hooks, problem, "needed here")
}

/// The suite's places come first, the plug-in's own line after them.
fn show(places: &Places, mut problem: Diagnostic, text: &str) -> Diagnostic {
    let own = std::mem::take(&mut problem.labels);
    for place in &places.shown {
        problem = place.show(problem, text);
    }
    problem.labels.extend(own);
    match places.count.saturating_sub(SHOWN_PLACES) {
        0 => problem,
        more => problem.note(format!("needed in {more} more places")),
    }
}
