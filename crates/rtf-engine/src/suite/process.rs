//! What is in a `<fixture type="process">`: its command, probes and stop.

use roxmltree::Node;
use rtf_model::Diagnostic;

use super::shape::{self, check};
use super::value::Reader;
use super::{Attached, Probe, Process, Question, Span, Spanned, command, port, probe, signal};

/// Reads what is in a `<fixture type="process">`.
pub(super) fn read(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Process {
    let mut process = Process {
        command: Spanned::new(Vec::new(), Span::default()),
        ready: Vec::new(),
        alive: Vec::new(),
        stop_signal: None,
        stop_grace: None,
        host: host(reader, node),
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
    if process.host.is_some() {
        for probe in process.ready.iter().chain(&process.alive) {
            local_file(reader, probe);
        }
    }
    process
}

/// The machine as `ssh` understands it.
fn host(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Option<Spanned<String>> {
    const EXAMPLE: &str = "write it like `user@machine` or `ssh://user@machine:2222`";
    let host = reader.word(node, "host")?;
    port::check(reader, "host", &host);
    let port = host.value.matches(':').count() == 1 && !host.value.starts_with("ssh://");
    if host.value.starts_with('-') || host.value.contains(char::is_whitespace) || port {
        reader.wrong("host", &host, "is no machine that `ssh` would find", Some(EXAMPLE));
    }
    if node.parent().and_then(|suite| suite.attribute("isolate")) == Some("network") {
        let message = "a suite with a network of its own reaches no other machine";
        let label = reader.source.label(host.span, "");
        reader.report(Diagnostic::error("other-machine", message).label(label));
    }
    Some(host)
}

fn local_file(reader: &mut Reader<'_>, probe: &Probe) {
    if matches!(probe.question, Question::File(_)) {
        let message = "a `file` is looked for on this machine, and the fixture runs on another one";
        let problem = Diagnostic::error("other-machine", message)
            .label(reader.source.label(probe.span, ""))
            .hint("ask with `log`, `tcp` or `http`, or with `command=\"ssh …\"`");
        reader.report(problem);
    }
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

/// Reads what is in a `<fixture type="process" attach="true">`.
pub(super) fn attached(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Attached {
    let mut attached = Attached { ready: Vec::new(), alive: Vec::new() };
    let mut probes = 0;
    for child in node.children().filter(Node::is_element) {
        let (shape, list) = match child.tag_name().name() {
            "ready" => (&shape::READY, &mut attached.ready),
            "alive" => (&shape::ALIVE, &mut attached.alive),
            _ => continue,
        };
        probes += 1;
        let Some(probe) = probe::read(reader, child, shape) else { continue };
        if matches!(probe.question, Question::Log(_)) {
            let message = "what is attached prints nothing that could be seen here";
            let label = reader.source.label(probe.span, "");
            reader.report(Diagnostic::error("no-output", message).label(label));
        } else {
            list.push(probe);
        }
    }
    if probes == 0 {
        reader.missing(node, "a `<ready>` or an `<alive>` with `attach=\"true\"`");
    }
    attached
}
