//! The children of `<fixture type="process">`: command, probes and stop.

use roxmltree::Node;

use super::reader::ElementReader;
use super::schema::{self, check};
use super::{
    DeclaredProbeKind, DeclaredProbes, DeclaredProcess, Span, Spanned, command, probe, reference,
    signal,
};

/// Reads the children of `<fixture type="process">`.
pub(super) fn read(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> DeclaredProcess {
    let mut process = DeclaredProcess {
        command: Spanned::new(Vec::new(), Span::default()),
        probes: DeclaredProbes::default(),
        stop_signal: None,
        stop_grace: None,
        stop_codes: Vec::new(),
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
            "ready" => process.probes.ready.extend(probe::read(reader, child, &schema::READY)),
            "alive" => process.probes.alive.extend(probe::read(reader, child, &schema::ALIVE)),
            "stop" => {
                reader.once(child, &mut stop_seen);
                check(reader, child, &schema::STOP);
                process.stop_signal = stop_signal(reader, child);
                process.stop_grace = reader.duration(child, "grace");
                process.stop_codes = exit_codes(reader, child);
            }
            _ => {}
        }
    }
    if command_seen.is_none() {
        reader.missing(node, "a `<command>` for `type=\"process\"`");
    }
    if process.host.is_some() {
        let hint = "use `log`, `tcp` or `http`, or `command=\"ssh …\"`";
        for found in process.probes.ready.iter().chain(&process.probes.alive) {
            if matches!(found.kind, DeclaredProbeKind::File(_)) {
                probe::report_local_file(reader, found.span, hint);
            }
        }
    }
    process
}

/// Reads the remote machine, in the syntax of `ssh`.
fn host(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<Spanned<String>> {
    const EXAMPLE: &str = "write it like `user@machine` or `ssh://user@machine:2222`";
    let host = reader.word(node, "host")?;
    reference::check(reader, "host", &host);
    // With an example of each reference, the syntax of the rest can be checked.
    let example = crate::config::sample(&reference::example(&host.value));
    let port = example.matches(':').count() == 1 && !example.starts_with("ssh://");
    if example.starts_with('-') || example.contains(char::is_whitespace) || port {
        reader.wrong("host", &host, "is not a host name for `ssh`", Some(EXAMPLE));
    }
    if node.parent().and_then(|suite| suite.attribute("isolate")) == Some("network") {
        let message = "a suite with a private network cannot reach another machine";
        reader.report(reader.error("other-machine", host.span, message));
    }
    Some(host)
}

fn stop_signal(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<i32> {
    let names: Vec<_> = signal::names().map(|name| format!("`{name}`")).collect();
    let hint = format!("valid are {} and the numbers 1 to 31", names.join(", "));
    reader.parsed(node, "signal", signal::number, ("is not a signal", Some(&hint)))
}

fn exit_codes(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Vec<i32> {
    const NAME: &str = "exit-codes";
    if reader.word(node, NAME).is_none() {
        return Vec::new();
    }
    let mut codes = Vec::new();
    for word in reader.words(node, NAME) {
        match word.value.parse::<u8>() {
            Ok(code) => codes.push(i32::from(code)),
            Err(_) => reader.wrong(NAME, &word, "has to be numbers from 0 to 255", None),
        }
    }
    codes
}

/// Reads the children of `<fixture type="process" attach="true">`.
pub(super) fn attached(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> DeclaredProbes {
    let mut attached = DeclaredProbes::default();
    let mut probes = 0;
    for child in node.children().filter(Node::is_element) {
        let (schema, list) = match child.tag_name().name() {
            "ready" => (&schema::READY, &mut attached.ready),
            "alive" => (&schema::ALIVE, &mut attached.alive),
            _ => continue,
        };
        probes += 1;
        let Some(probe) = probe::read(reader, child, schema) else { continue };
        if matches!(probe.kind, DeclaredProbeKind::Log(_)) {
            let message = "`rtf` cannot read the output of an attached process";
            reader.report(reader.error("no-output", probe.span, message));
        } else {
            list.push(probe);
        }
    }
    if probes == 0 {
        reader.missing(node, "a `<ready>` or an `<alive>` with `attach=\"true\"`");
    }
    attached
}
