//! Turns a host's answers into diagnostics at the suite's lines.

use std::path::Path;
use std::sync::Arc;

use rtf_model::Diagnostic;

use super::{CheckAnswer, CheckFindings, CheckGroup, CheckId, CheckReport, FileUse};
use crate::plan::hosts;
use crate::plan::use_site::PluginRole;
use crate::suite::SourceText;

/// The maximum size of a plug-in from which a diagnostic quotes.
const MAX_QUOTED_BYTES: u64 = 4 * 1024 * 1024;

pub(super) fn diagnose(
    index: usize,
    group: &CheckGroup,
    answers: Vec<CheckAnswer>,
    findings: &mut CheckFindings,
) {
    let check = match group.framework {
        Some((_, framework)) if framework.lists_cases => "listing the cases of",
        Some(_) => "checking",
        None => "loading",
    };
    for (file, (entry, answer)) in group.files.iter().zip(answers).enumerate() {
        let problem = match answer {
            CheckAnswer::Report(report) if report.ok => {
                check_kinds(entry, &report, findings);
                if group.framework.is_some() {
                    let id = CheckId { group: index, file };
                    findings.cases.insert(id, report.cases.map(Arc::from));
                }
                continue;
            }
            CheckAnswer::Report(report) => not_loadable(group, entry, &report, findings),
            CheckAnswer::Died { how, stderr } => {
                let name = file_name(&entry.file);
                let message = format!("{check} `{name}` ended its host: {how}");
                with_stderr(Diagnostic::error("plugin-not-loadable", message), &stderr)
            }
            CheckAnswer::Silent(limit) => {
                let name = file_name(&entry.file);
                let message = format!("{check} `{name}` takes longer than {limit:?}");
                Diagnostic::error("plugin-not-loadable", message)
            }
            CheckAnswer::HostFailed { how, stderr } => {
                let problem = host_failed(group, &how, &stderr);
                // Reported once per host, not per plug-in or suite.
                if findings.problems.iter().any(|known| known.message == problem.message) {
                    continue;
                }
                problem
            }
        };
        let sites = entry.sites.values();
        findings.problems.push(sites.fold(problem, |it, sites| sites.label(it, "needed here")));
    }
}

fn file_name(file: &Path) -> String {
    file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned()
}

fn with_stderr(problem: Diagnostic, stderr: &str) -> Diagnostic {
    if stderr.is_empty() { problem } else { problem.note(format!("it printed\n{stderr}")) }
}

fn host_failed(group: &CheckGroup, how: &str, stderr: &str) -> Diagnostic {
    let command = shell_words::join(&group.host.command);
    let message = format!("the host `{command}` does not work: {how}");
    let problem = with_stderr(Diagnostic::error("host-failed", message), stderr);
    problem.hint(format!("`{command} --check` must exit with code 0"))
}

/// Quotes the message of the host's loader or compiler.
fn not_loadable(
    group: &CheckGroup,
    entry: &FileUse,
    report: &CheckReport,
    findings: &mut CheckFindings,
) -> Diagnostic {
    let reason = report.message.as_deref().unwrap_or("the host gives no reason").trim();
    // Some hosts start with the same words as this message.
    let reason = reason.strip_prefix("cannot be loaded: ").unwrap_or(reason);
    let (first, rest) = reason.split_once('\n').unwrap_or((reason, ""));
    let name = file_name(&entry.file);
    let mut message = match group.framework {
        // The message of most hosts names the file.
        Some(_) if first.contains(&format!("`{name}`")) => first.to_owned(),
        Some((kind, _)) => format!("`{name}` cannot be run as a test of type `{kind}`: {first}"),
        None => format!("the plug-in `{name}` cannot be loaded: {first}"),
    };
    let label = report.line.and_then(|line| {
        let source = plugin_text(&entry.file)?;
        let label = source.label(source.line_span(line)?, first);
        findings.sources.add(Arc::new(source));
        Some(label)
    });
    if let (Some(line), None) = (report.line, &label) {
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

fn plugin_text(file: &Path) -> Option<SourceText> {
    let is_short = file.metadata().is_ok_and(|found| found.len() <= MAX_QUOTED_BYTES);
    let text = is_short.then(|| std::fs::read_to_string(file).ok())??;
    Some(SourceText::new(file.to_string_lossy(), text))
}

/// Checks that a loadable file contains the kinds of plug-ins for which it is used.
fn check_kinds(entry: &FileUse, report: &CheckReport, findings: &mut CheckFindings) {
    let Some(kinds) = &report.kinds else { return };
    for (role, sites) in &entry.sites {
        if kinds.iter().any(|kind| kind == role.kind()) {
            continue;
        }
        if entry.optional {
            findings.omitted.insert(entry.file.clone());
            continue;
        }
        let problem = match kinds.first() {
            Some(other) => {
                let (file, expected) = (file_name(&entry.file), role.kind());
                let message = format!("the plug-in `{file}` is a {other}, not a {expected}");
                Diagnostic::error("wrong-kind", message).hint(role.advice())
            }
            None => contains_none(&entry.file, *role),
        };
        findings.problems.push(sites.label(problem, "used here"));
    }
}

fn contains_none(file: &Path, role: PluginRole) -> Diagnostic {
    let expected = role.kind();
    let message = format!("`{}` contains no {expected}", file_name(file));
    let problem = Diagnostic::error("wrong-kind", message);
    let class = if role == PluginRole::Fixture { "FixtureManager" } else { "TestCase" };
    match hosts::by_extension(file).and_then(|kind| kind.class_prefix) {
        Some(prefix) => {
            problem.hint(format!("a {expected} is a class that derives from `{prefix}{class}`"))
        }
        None => problem,
    }
}
