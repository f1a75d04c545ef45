//! Which elements and attributes there are, and what is wrong with others.
//!
//! `spec/suite.xsd` says the same; a test validates files with both.

use roxmltree::Node;
use rtf_model::Diagnostic;

use super::Span;
use super::value::Reader;

/// What an element may have.
pub(super) struct Shape {
    /// The element, as messages name it.
    pub name: &'static str,
    /// Its attributes.
    pub attributes: &'static [&'static str],
    /// Its child elements.
    pub elements: &'static [&'static str],
    /// Whether it may hold text.
    pub text: bool,
    /// Attributes and elements that are designed and not built. They must
    /// never be ignored: who writes them relies on them.
    pub planned: &'static [&'static str],
}

/// `<suite>`.
pub(super) const SUITE: Shape = Shape {
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
    elements: &["description", "environment", "env", "fixture", "hook", "test"],
    text: false,
    planned: &[],
};

/// `<test>`.
pub(super) const TEST: Shape = Shape {
    name: "test",
    attributes: &[
        "name",
        "type",
        "param",
        "repetition",
        "tags",
        "timeout",
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
    ],
    elements: &["env"],
    text: true,
    planned: &[],
};

/// `<fixture>` with a plug-in.
pub(super) const FIXTURE: Shape = Shape {
    name: "fixture",
    attributes: &[
        "name",
        "type",
        "param",
        "depends",
        "timeout",
        "check-timeout",
        "notice-timeout",
        "teardown-timeout",
        "restarts",
        "restart-delay",
        "check-every",
        "attach",
        "host",
    ],
    elements: &["env"],
    text: true,
    planned: &[],
};

/// `<fixture type="process">`.
pub(super) const PROCESS: Shape = Shape {
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
    elements: &["command", "ready", "alive", "stop", "env"],
    text: false,
    planned: &[],
};

/// `<fixture type="process" attach="true">`: what is neither started nor stopped.
pub(super) const ATTACHED: Shape = Shape {
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
    elements: &["ready", "alive", "env"],
    text: false,
    planned: &[],
};

/// `<hook>`. What goes with a plug-in only is told apart in `hook.rs`.
pub(super) const HOOK: Shape = Shape {
    name: "hook",
    attributes: &["name", "on", "type", "param", "timeout"],
    elements: &["command", "env"],
    text: true,
    planned: &[],
};

/// `<env>`.
pub(super) const ENV: Shape = leaf("env", &["name", "value"]);
/// `<ready>`.
pub(super) const READY: Shape = leaf(
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
/// `<alive>`.
pub(super) const ALIVE: Shape = leaf(
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
/// `<stop>`.
pub(super) const STOP: Shape = leaf("stop", &["signal", "grace"]);
/// `<command>`, `<description>`, `<environment>`.
pub(super) const fn text(name: &'static str) -> Shape {
    Shape { name, attributes: &[], elements: &[], text: true, planned: &[] }
}

const fn leaf(name: &'static str, attributes: &'static [&'static str]) -> Shape {
    Shape { name, attributes, elements: &[], text: false, planned: &[] }
}

/// The namespace of `xsi:noNamespaceSchemaLocation`, with which editors find
/// the schema. Its attributes are left alone.
const SCHEMA_INSTANCE: &str = "http://www.w3.org/2001/XMLSchema-instance";

/// Reports whatever `node` has and `shape` does not.
pub(super) fn check(reader: &mut Reader<'_>, node: Node<'_, '_>, shape: &Shape) {
    for attribute in node.attributes() {
        if attribute.namespace() == Some(SCHEMA_INSTANCE) {
            continue;
        }
        let name = attribute.name();
        if attribute.namespace().is_some() || !shape.attributes.contains(&name) {
            let span = Span::new(attribute.range_qname());
            let unknown = Unknown { name, span, kind: Kind::Attribute };
            unknown.report(reader, shape);
        }
    }
    for child in node.children() {
        if child.is_element() {
            let name = child.tag_name();
            if name.namespace().is_some() || !shape.elements.contains(&name.name()) {
                let span = Reader::tag(child);
                let unknown = Unknown { name: name.name(), span, kind: Kind::Element };
                unknown.report(reader, shape);
            }
        } else if child.is_text() && !shape.text {
            stray_text(reader, child, shape);
        }
    }
}

fn stray_text(reader: &mut Reader<'_>, child: Node<'_, '_>, shape: &Shape) {
    let Some(span) = reader.trimmed(child) else { return };
    let message = format!("text has no meaning in `<{}>`", shape.name);
    let label = reader.source.label(span, "not expected here");
    reader.report(Diagnostic::error("stray-text", message).label(label));
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Attribute,
    Element,
}

struct Unknown<'a> {
    name: &'a str,
    span: Span,
    kind: Kind,
}

impl Unknown<'_> {
    fn report(&self, reader: &mut Reader<'_>, shape: &Shape) {
        let label = |text: &str| reader.source.label(self.span, text);
        let problem = if shape.planned.contains(&self.name) {
            let written = self.written();
            let message = format!("{written} is not supported by this version of rtf");
            Diagnostic::error("not-supported", message).label(label(""))
        } else {
            self.unknown(shape).label(label(&format!("not known in `<{}>`", shape.name)))
        };
        reader.report(problem);
    }

    fn written(&self) -> String {
        match self.kind {
            Kind::Attribute => format!("`{}`", self.name),
            Kind::Element => format!("`<{}>`", self.name),
        }
    }

    fn unknown(&self, shape: &Shape) -> Diagnostic {
        let (code, word, plural, known) = match self.kind {
            Kind::Attribute => ("unknown-attribute", "attribute", "attributes", shape.attributes),
            Kind::Element => ("unknown-element", "element", "elements", shape.elements),
        };
        let problem = Diagnostic::error(code, format!("unknown {word} {}", self.written()));
        let problem = if known.is_empty() {
            problem.note(format!("`<{}>` has no {plural}", shape.name))
        } else {
            let list: Vec<_> = known.iter().map(|name| format!("`{name}`")).collect();
            problem.note(format!("`<{}>` can have the {plural} {}", shape.name, list.join(", ")))
        };
        match nearest(self.name, known.iter().copied()) {
            Some(name) => problem.hint(format!("did you mean `{name}`?")),
            None if matches!(self.kind, Kind::Element) && SUITE.elements.contains(&self.name) => {
                problem.hint(format!("{} is written directly in `<suite>`", self.written()))
            }
            None => problem,
        }
    }
}

/// The known word that `word` is most likely a slip of.
pub(crate) fn nearest<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let lower = word.to_lowercase();
    known
        .map(|name| (strsim::damerau_levenshtein(&lower, &name.to_lowercase()), name))
        .filter(|(distance, name)| *distance <= name.chars().count().max(3) / 3)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}
