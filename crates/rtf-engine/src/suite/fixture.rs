//! `<fixture>`, with a plug-in or `type="process"`.

use std::time::Duration;

use roxmltree::Node;
use rtf_model::Diagnostic;

use super::shape::{self, check};
use super::value::Reader;
use super::{Fixture, FixtureKind, Process, Span, Spanned, command, env, probe, signal, test};

/// Reads a `<fixture>`; `None` when it does not say what it is.
pub(super) fn read(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Option<Fixture> {
    let is_process = is_process(reader, node);
    check(reader, node, if is_process { &shape::PROCESS } else { &shape::FIXTURE });
    let name = reader.word(node, "name");
    let depends = node.has_attribute("depends").then(|| reader.words(node, "depends"));
    let setup = reader.duration(node, "timeout");
    let check = reader.duration(node, "check-timeout");
    let teardown = reader.duration(node, "teardown-timeout");
    let restarts = reader.number(node, "restarts", 0);
    let restart_delay = restart_delay(reader, node);
    let check_every = reader.duration(node, "check-every");
    let env = env::read(reader, node);
    let body = if is_process {
        FixtureKind::Process(Box::new(process(reader, node)))
    } else {
        FixtureKind::Plugin(test::plugin(reader, node)?)
    };
    let span = Reader::tag(node);
    Some(Fixture {
        span,
        name,
        depends,
        body,
        env,
        setup,
        check,
        teardown,
        restarts,
        restart_delay,
        check_every,
    })
}

/// A wait that grows with each restart never gets longer than this; one that
/// begins longer could not be kept.
const LONGEST_DELAY: Duration = Duration::from_secs(10);

fn restart_delay(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Option<Duration> {
    const NAME: &str = "restart-delay";
    let delay = reader.duration(node, NAME)?;
    if delay <= LONGEST_DELAY {
        return Some(delay);
    }
    let what = format!("is longer than {LONGEST_DELAY:?}, the longest wait before a restart");
    if let Some(written) = reader.attribute(node, NAME) {
        reader.wrong(NAME, &written, &what, None);
    }
    None
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

fn process(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Process {
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
                reader.once(child, &mut command_seen);
                process.command = command::read(reader, child);
            }
            "ready" => process.ready.extend(probe::read(reader, child, &shape::READY)),
            "alive" => process.alive.extend(probe::read(reader, child, &shape::ALIVE)),
            "stop" => {
                reader.once(child, &mut stop_seen);
                check(reader, child, &shape::STOP);
                process.stop_signal = stop_signal(reader, child);
                process.stop_grace = reader.duration(child, "grace");
            }
            _ => {}
        }
    }
    if command_seen.is_none() {
        reader.missing(node, "a `<command>` for `type=\"process\"`");
    }
    process
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
