//! `<fixture>`, with a plug-in or `type="process"`.

use roxmltree::Node;
use rtf_model::Diagnostic;

use super::shape::{self, Shape, check};
use super::value::Reader;
use super::{Fixture, FixtureKind, Process, Span, Spanned, command, env, probe, signal, test};

/// Reads a `<fixture>`; `None` when it does not say what it is.
pub(super) fn read(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Option<Fixture> {
    let is_process = is_process(reader, node);
    check(reader, node, if is_process { &shape::PROCESS } else { &shape::FIXTURE });
    let name = reader.word(node, "name");
    let depends = reader.words(node, "depends");
    let setup = reader.duration(node, "timeout");
    let check = reader.duration(node, "check-timeout");
    let teardown = reader.duration(node, "teardown-timeout");
    let restarts = reader.number(node, "restarts", 0);
    let check_every = reader.duration(node, "check-every");
    let env = env::read(reader, node);
    let body = if is_process {
        FixtureKind::Process(Box::new(process(reader, node)?))
    } else {
        FixtureKind::Plugin(test::plugin(reader, node)?)
    };
    let span = Reader::tag(node);
    Some(Fixture { span, name, depends, body, env, setup, check, teardown, restarts, check_every })
}

/// Whether it is the built-in fixture. One with a `<command>` was meant to be,
/// whatever its `type` says: that is one mistake, not one for each child.
fn is_process(reader: &mut Reader<'_>, node: Node<'_, '_>) -> bool {
    let written = reader.attribute(node, "type");
    if written.as_ref().is_some_and(|kind| kind.value.trim() == "process") {
        return true;
    }
    let meant = node.children().any(|child| child.has_tag_name("command"));
    if meant {
        let message = "a fixture with a `<command>` is of another type";
        let span = written.map_or_else(|| Reader::tag(node), |written| written.span);
        let problem = Diagnostic::error("wrong-type", message)
            .label(reader.source.label(span, ""))
            .hint("write `type=\"process\"`");
        reader.report(problem);
    }
    meant
}

fn process(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Option<Process> {
    let mut process = Process {
        command: Spanned::new(Vec::new(), Span::default()),
        ready: Vec::new(),
        alive: Vec::new(),
        stop_signal: None,
        stop_grace: None,
    };
    let mut command_seen = None;
    let mut stop_seen = None;
    for child in node.children().filter(Node::is_element) {
        match child.tag_name().name() {
            "command" => {
                once(reader, child, &mut command_seen);
                process.command = read_command(reader, child);
            }
            "ready" => process.ready.extend(probe::read(reader, child, &shape::READY)),
            "alive" => process.alive.extend(probe::read(reader, child, &shape::ALIVE)),
            "stop" => {
                once(reader, child, &mut stop_seen);
                check(reader, child, &shape::STOP);
                process.stop_signal = stop_signal(reader, child);
                process.stop_grace = reader.duration(child, "grace");
            }
            _ => {}
        }
    }
    if command_seen.is_none() {
        reader.missing(node, "a `<command>` for `type=\"process\"`");
        return None;
    }
    Some(process)
}

fn once(reader: &mut Reader<'_>, node: Node<'_, '_>, seen: &mut Option<Span>) {
    let span = Reader::tag(node);
    if let Some(first) = seen.replace(span) {
        let message = format!("`<{}>` twice in one fixture", node.tag_name().name());
        let problem = Diagnostic::error("repeated-element", message)
            .label(reader.source.label(span, "the second one"))
            .label(reader.source.label(first, "the first one"));
        reader.report(problem);
    }
}

fn read_command(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Spanned<Vec<String>> {
    const SHAPE: Shape = shape::text("command");
    check(reader, node, &SHAPE);
    let nothing = Spanned::new(Vec::new(), Reader::tag(node));
    let Some(line) = reader.text(node) else {
        reader.missing(node, "a program as its text");
        return nothing;
    };
    let words = words(reader, "<command>", &line).unwrap_or_default();
    Spanned::new(words, line.span)
}

/// Splits a command line, and says so when it was meant for a shell.
pub(super) fn words(
    reader: &mut Reader<'_>,
    name: &str,
    line: &Spanned<String>,
) -> Option<Vec<String>> {
    let Ok(words) = command::split(&line.value) else {
        reader.wrong(name, line, "has a quote that is not closed", None);
        return None;
    };
    if let Some(word) = command::shell_word(&words) {
        let message =
            format!("no shell reads this command: the program gets `{word}` as an argument");
        let problem = Diagnostic::warning("no-shell", message)
            .label(reader.source.label(line.span, ""))
            .hint("if you want a shell, write `sh -c '…'`");
        reader.report(problem);
    }
    if words.first().is_none_or(String::is_empty) {
        reader.wrong(name, line, "names no program", None);
        return None;
    }
    Some(words)
}

fn stop_signal(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Option<i32> {
    let attribute = reader.word(node, "signal")?;
    let number = signal::number(&attribute.value);
    if number.is_none() {
        let names: Vec<_> = signal::names().map(|name| format!("`{name}`")).collect();
        let hint = format!("known are {} and the numbers 1 to 31", names.join(", "));
        reader.wrong("signal", &attribute, "is not a signal", Some(&hint));
    }
    number
}
