//! The elements and attributes of a suite file, and the report of unknown ones.
//!
//! `spec/suite.xsd` contains the same schema; a test validates files with both.

use roxmltree::Node;
use rtf_model::{Diagnostic, Label};

use super::Span;
use super::reader::ElementReader;
use crate::wording::{quoted, suggest};

/// The attributes and children that an element may have.
pub struct ElementSchema {
    /// The element's name in messages.
    pub name: &'static str,
    pub attributes: &'static [&'static str],
    pub elements: &'static [&'static str],
    /// Whether it may contain text.
    pub text: bool,
}

pub(super) const SUITE: ElementSchema = ElementSchema {
    name: "suite",
    attributes: &[
        "name",
        "timeout",
        "tags",
        "isolate",
        "requires",
        "critical-stops",
        "parallel",
        "middleware",
        "clock",
        "clock-backstop",
        "tolerate-collapse",
        "skips",
        "after-collapse",
        "leaks",
        "retries",
        "retry-delay",
        "test-timeout",
        "test-load-timeout",
        "test-setup-timeout",
        "test-teardown-timeout",
        "test-slow",
        "test-grace",
    ],
    elements: &[
        "description",
        "environment",
        "env",
        "fixture",
        "hook",
        "signal",
        "signals",
        "monitor",
        "envelope",
        "fault",
        "test",
    ],
    text: false,
};

pub(super) const TEST: ElementSchema = ElementSchema {
    name: "test",
    attributes: &[
        "name",
        "type",
        "param",
        "cases",
        "repetition",
        "tags",
        "timeout",
        "case-timeout",
        "load-timeout",
        "setup-timeout",
        "teardown-timeout",
        "slow",
        "grace",
        "after-collapse",
        "leaks",
        "retries",
        "retry-delay",
        "critical",
        "exclusive",
        "isolation",
        "middleware",
        "fork",
        "slots",
        "max-steps",
        "max-time",
        "expect",
        "issue",
        "until",
        "was",
    ],
    elements: &["env", "matrix", "matrix-exclude", "learn", "monitor", "fault"],
    text: true,
};

pub(super) const LEARN: ElementSchema = ElementSchema {
    name: "learn",
    attributes: &["measurement", "min-runs", "sigma", "limits", "since"],
    elements: &[],
    text: false,
};

/// `<fixture>` with a plug-in.
pub(super) const FIXTURE: ElementSchema = ElementSchema {
    name: "fixture",
    attributes: &[
        "name",
        "type",
        "param",
        "depends",
        "timeout",
        "check-timeout",
        "notify-timeout",
        "teardown-timeout",
        "restarts",
        "restart-delay",
        "check-every",
        "attach",
        "host",
    ],
    elements: &["env", "provide", "reset"],
    text: true,
};

/// `<fixture type="process">`.
pub(super) const PROCESS: ElementSchema = ElementSchema {
    name: "fixture type=\"process\"",
    attributes: &[
        "name",
        "type",
        "depends",
        "timeout",
        "teardown-timeout",
        "restarts",
        "restart-delay",
        "check-every",
        "attach",
        "host",
    ],
    elements: &["command", "ready", "alive", "stop", "reset", "env", "provide"],
    text: false,
};

/// `<fixture type="process" attach="true">`: a process that `rtf` neither starts nor stops.
pub(super) const ATTACHED: ElementSchema = ElementSchema {
    name: "fixture attach=\"true\"",
    attributes: &[
        "name",
        "type",
        "depends",
        "timeout",
        "restarts",
        "restart-delay",
        "check-every",
        "attach",
    ],
    elements: &["ready", "alive", "reset", "env", "provide"],
    text: false,
};

pub(super) const SIGNALS: ElementSchema = ElementSchema {
    name: "signals",
    attributes: &["time", "wait"],
    elements: &["command", "signal"],
    text: false,
};
pub(super) const COLUMN: ElementSchema = leaf("signal", &["name", "unit"]);
/// `<signal>` with its own source.
pub(super) const SIGNAL: ElementSchema = ElementSchema {
    name: "signal",
    attributes: &[
        "name", "unit", "time", "wait", "ros", "ros2", "yarp", "file", "topic", "test", "fixture",
        "of", "every",
    ],
    elements: &["command"],
    text: false,
};
pub(super) const MONITOR: ElementSchema =
    ElementSchema { name: "monitor", attributes: &["name", "severity"], elements: &[], text: true };

pub(super) const ENVELOPE: ElementSchema = leaf("envelope", &["file"]);
/// `<fault>`. `fault.rs` checks which attributes its kind has.
pub(super) const FAULT: ElementSchema = leaf(
    "fault",
    &[
        "name",
        "kind",
        "at",
        "for",
        "seed",
        "fixture",
        "process",
        "cpu",
        "size",
        "leave",
        "dir",
        "port",
        "delay",
        "jitter",
        "loss",
        "duplicate",
        "reorder",
        "refuse",
        "rate",
        "field",
        "set",
        "scale",
        "offset",
        "noise",
        "freeze",
    ],
);

/// `<hook>`. `hook.rs` checks which attributes require a plug-in.
pub(super) const HOOK: ElementSchema = ElementSchema {
    name: "hook",
    attributes: &["name", "on", "type", "param", "timeout"],
    elements: &["command", "env"],
    text: true,
};

pub(super) const ENV: ElementSchema = leaf("env", &["name", "value"]);
pub(super) const MATRIX: ElementSchema = leaf("matrix", &["name", "values", "values-from"]);
/// `<matrix-exclude>`, whose attributes are the parameters of its test.
pub(super) const MATRIX_EXCLUDE: ElementSchema = leaf("matrix-exclude", &[]);
pub(super) const READY: ElementSchema = leaf(
    "ready",
    &[
        "tcp",
        "http",
        "log",
        "file",
        "command",
        "ros-node",
        "ros-topic",
        "ros-service",
        "ros2-topic",
        "yarp-port",
        "min-rate",
        "timeout",
        "every",
    ],
);
pub(super) const ALIVE: ElementSchema = leaf(
    "alive",
    &[
        "tcp",
        "http",
        "log-bad",
        "file",
        "command",
        "ros-node",
        "ros-topic",
        "ros-service",
        "ros2-topic",
        "yarp-port",
        "min-rate",
        "timeout",
        "every",
    ],
);
pub(super) const PROVIDE: ElementSchema =
    leaf("provide", &["name", "log", "file", "command", "secret"]);
pub(super) const STOP: ElementSchema = leaf("stop", &["signal", "grace", "exit-codes"]);
pub(super) const RESET: ElementSchema = ElementSchema {
    name: "reset",
    attributes: &["command", "type", "param", "timeout", "restart-every"],
    elements: &[],
    text: true,
};
/// `<command>`, `<description>`, `<environment>`.
pub const fn text(name: &'static str) -> ElementSchema {
    ElementSchema { name, attributes: &[], elements: &[], text: true }
}

/// An element without children and text.
pub const fn leaf(name: &'static str, attributes: &'static [&'static str]) -> ElementSchema {
    ElementSchema { name, attributes, elements: &[], text: false }
}

/// The namespace of `xsi:noNamespaceSchemaLocation`, with which editors find
/// the schema. Its attributes are ignored.
const SCHEMA_INSTANCE: &str = "http://www.w3.org/2001/XMLSchema-instance";

/// Reports everything in `node` that `schema` does not contain.
pub fn check(reader: &mut ElementReader<'_>, node: Node<'_, '_>, schema: &ElementSchema) {
    for attribute in node.attributes() {
        if attribute.namespace() == Some(SCHEMA_INSTANCE) {
            continue;
        }
        let name = attribute.name();
        if attribute.namespace().is_some() || !schema.attributes.contains(&name) {
            let span = Span::new(attribute.range_qname());
            reader.report(unknown_attribute(name, schema).label(label(reader, span, schema)));
        }
    }
    check_content(reader, node, schema);
}

/// Reports child elements and text that `schema` does not contain.
pub(super) fn check_content(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    schema: &ElementSchema,
) {
    for child in node.children() {
        if child.is_element() {
            let name = child.tag_name();
            if name.namespace().is_some() || !schema.elements.contains(&name.name()) {
                let span = ElementReader::tag(child);
                let problem = unknown_element(name.name(), schema);
                reader.report(problem.label(label(reader, span, schema)));
            }
        } else if child.is_text() && !schema.text {
            report_stray_text(reader, child, schema);
        }
    }
}

fn report_stray_text(reader: &mut ElementReader<'_>, child: Node<'_, '_>, schema: &ElementSchema) {
    let Some(span) = reader.trimmed(child) else { return };
    let message = format!("text has no meaning in `<{}>`", schema.name);
    let label = reader.source.label(span, "not expected here");
    reader.report(Diagnostic::error("stray-text", message).label(label));
}

fn label(reader: &ElementReader<'_>, span: Span, schema: &ElementSchema) -> Label {
    reader.source.label(span, format!("not known in `<{}>`", schema.name))
}

fn unknown_attribute(name: &str, schema: &ElementSchema) -> Diagnostic {
    let message = format!("unknown attribute `{name}`");
    let problem = Diagnostic::error("unknown-attribute", message);
    with_known(problem, name, ("attributes", schema.attributes), schema)
}

fn unknown_element(name: &str, schema: &ElementSchema) -> Diagnostic {
    let problem = Diagnostic::error("unknown-element", format!("unknown element `<{name}>`"));
    let problem = with_known(problem, name, ("elements", schema.elements), schema);
    if problem.hint.is_none() && SUITE.elements.contains(&name) {
        return problem.hint(format!("`<{name}>` is written directly in `<suite>`"));
    }
    problem
}

fn with_known(
    problem: Diagnostic,
    name: &str,
    (plural, known): (&str, &[&'static str]),
    schema: &ElementSchema,
) -> Diagnostic {
    let note = match known {
        [] => format!("`<{}>` has no {plural}", schema.name),
        known => {
            let list = quoted(known.iter().copied(), ", ");
            format!("`<{}>` can have the {plural} {list}", schema.name)
        }
    };
    suggest(problem.note(note), name, known.iter().copied())
}
