//! `<signals>` and `<signal>`: programs and fixtures whose values are recorded during tests.

use regex::Regex;
use roxmltree::Node;
use rtf_model::{Diagnostic, ProcessQuantity, SignalTime, TestQuantity};

use super::reader::ElementReader;
use super::schema::{self, check};
use super::{
    DeclaredSignal, DeclaredSource, DeclaredSourceKind, SignalMiddleware, Spanned, command,
};

/// Reads a `<signals>`; `None` if it declares no signal.
pub(super) fn read_group(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
) -> Option<DeclaredSource> {
    check(reader, node, &schema::SIGNALS);
    let kind = program(reader, node);
    let children = node.children().filter(|child| child.has_tag_name("signal"));
    let mut signals = Vec::new();
    for child in children {
        check(reader, child, &schema::COLUMN);
        signals.extend(signal(reader, child));
    }
    if !node.children().any(|child| child.has_tag_name("signal")) {
        reader.missing(node, "a `<signal>` for each value on a line");
    }
    let kind = kind?;
    (!signals.is_empty()).then_some(DeclaredSource { kind, signals })
}

/// The sources of a `<signal>`.
const SOURCES: &str = "a source: a `<command>`, `ros`, `ros2`, `yarp`, `file` and `topic`, `test`, or `fixture` and `of`";

const SOURCE_ATTRIBUTES: [&str; 6] = ["ros", "ros2", "yarp", "file", "test", "fixture"];

/// The syntax of values in messages. `fixtures/rtf_fixtures/signal_fields.py` has the same.
struct FieldSyntax {
    pattern: &'static str,
    what: &'static str,
    hint: &'static str,
}

/// A topic, and names with an index or not.
const ROS_FIELD: FieldSyntax = FieldSyntax {
    pattern: r"^/[^.\s]*(\.[A-Za-z][A-Za-z0-9_]*(\[[^\]]+\])?)+$",
    what: "is not a field of a topic",
    hint: "write a topic and a field: `/joint_states.position[elbow]`, `/odom.twist.twist.linear.x`",
};

/// A port, and the positions in its bottle and in lists in it.
const YARP_FIELD: FieldSyntax = FieldSyntax {
    pattern: r"^/[^\s\[\]]+(\[[0-9]+\])+$",
    what: "is not a value of a port",
    hint: "write a port and the position of a value in its bottle: `/arm/state:o[3]`, `/imu:o[0][2]`",
};

/// Any of them; numbers that tests sampled or measured have no field.
const RECORDED_FIELD: FieldSyntax = FieldSyntax {
    pattern: r"^/[^\s\[\]]*((\.[A-Za-z][A-Za-z0-9_]*(\[[^\]]+\])?)+|(\[[0-9]+\])+)?$",
    what: "is not a value in a recording",
    hint: "write a topic, and the field of a message or the position in a bottle: `/level`, \
           `/joint_states.position[elbow]`, `/arm/state:o[3]`",
};

/// The attributes of a `<signal>` that only signals with certain sources have.
const OF_COMMAND: &str = "is only for a signal with a `<command>`";
const OF_FIXTURE: &str = "is only for a signal with `fixture`";

/// Reads a `<signal>` that has its own source; `None` if it has no name or source.
pub(super) fn read(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<DeclaredSource> {
    check(reader, node, &schema::SIGNAL);
    report_second_source(reader, node);
    let attribute = SOURCE_ATTRIBUTES.into_iter().find(|name| node.has_attribute(*name));
    if attribute.is_some() {
        report_without_effect(reader, node, &["time", "wait"], OF_COMMAND);
    }
    if attribute != Some("fixture") {
        report_without_effect(reader, node, &["of", "every"], OF_FIXTURE);
    }
    if attribute != Some("file") {
        report_without_effect(reader, node, &["topic"], "is only for a signal with `file`");
    }
    let kind = match attribute {
        Some("fixture") => {
            report_without_effect(reader, node, &["unit"], "is fixed for a signal with `fixture`");
            fixture(reader, node)
        }
        Some("file") => recording(reader, node),
        Some("test") => {
            let quantities =
                [("sample", TestQuantity::Sample), ("measurement", TestQuantity::Measurement)];
            reader.choice(node, "test", &quantities).map(DeclaredSourceKind::Test)
        }
        Some(_) => topic(reader, node),
        None if node.children().any(|child| child.has_tag_name("command")) => program(reader, node),
        None => {
            reader.missing(node, SOURCES);
            None
        }
    };
    let signal = signal(reader, node);
    let (Some(kind), Some(mut signal)) = (kind, signal) else { return None };
    if let DeclaredSourceKind::Fixture { quantity, .. } = &kind {
        quantity.unit().clone_into(&mut signal.unit.value);
    }
    Some(DeclaredSource { kind, signals: vec![signal] })
}

fn report_second_source(reader: &mut ElementReader<'_>, node: Node<'_, '_>) {
    let command = node.children().find(|child| child.has_tag_name("command"));
    let command = command.map(ElementReader::tag);
    let attributes = SOURCE_ATTRIBUTES.map(|name| ElementReader::name_span(node, name));
    let sources = std::iter::once(command).chain(attributes);
    if let Some(second) = sources.flatten().nth(1) {
        let message = "a signal has one source: a `<command>`, `ros`, `ros2`, `yarp`, `file`, `test` or `fixture`";
        let label = reader.source.label(second, "a second source");
        reader.report(Diagnostic::error("several-sources", message).label(label));
    }
}

fn report_without_effect(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    attributes: &[&str],
    what: &str,
) {
    for name in attributes {
        let Some(span) = ElementReader::name_span(node, name) else { continue };
        let label = reader.source.label(span, "");
        reader.report(Diagnostic::error("wrong-type", format!("`{name}` {what}")).label(label));
    }
}

/// Reads the value of a topic or port.
fn topic(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<DeclaredSourceKind> {
    let mut all = SignalMiddleware::ALL.into_iter();
    let (name, middleware) = all.find(|(name, _)| node.has_attribute(*name))?;
    let syntax = if middleware == SignalMiddleware::Yarp { YARP_FIELD } else { ROS_FIELD };
    let field = field(reader, node, name, &syntax)?;
    Some(DeclaredSourceKind::Topic { middleware, field })
}

fn recording(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<DeclaredSourceKind> {
    if !node.has_attribute("topic") {
        reader.missing(node, "the attribute `topic`: the value in the recording");
    }
    let file = reader.word(node, "file");
    let field = field(reader, node, "topic", &RECORDED_FIELD);
    Some(DeclaredSourceKind::Recording { file: file?, field: field? })
}

fn field(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    name: &str,
    syntax: &FieldSyntax,
) -> Option<Spanned<String>> {
    let field = reader.word(node, name)?;
    if !Regex::new(syntax.pattern).is_ok_and(|pattern| pattern.is_match(&field.value)) {
        reader.wrong(name, &field, syntax.what, Some(syntax.hint));
        return None;
    }
    Some(field)
}

fn program(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<DeclaredSourceKind> {
    let times =
        [("clock", SignalTime::Clock), ("own", SignalTime::Own), ("arrival", SignalTime::Arrival)];
    let time = reader.choice(node, "time", &times).unwrap_or_default();
    let wait = reader.boolean(node, "wait").unwrap_or(true);
    let mut first = None;
    let mut command = None;
    for child in node.children().filter(|child| child.has_tag_name("command")) {
        reader.once(child, &mut first);
        let read = command::read(reader, child);
        command.get_or_insert(read);
    }
    if command.is_none() {
        reader.missing(node, "a `<command>` that writes the samples");
    }
    Some(DeclaredSourceKind::Program { command: command?, time, wait })
}

fn fixture(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<DeclaredSourceKind> {
    let quantities = [
        ("cpu", ProcessQuantity::Cpu),
        ("rss", ProcessQuantity::Rss),
        ("fds", ProcessQuantity::Fds),
    ];
    if !node.has_attribute("of") {
        reader.missing(node, "the attribute `of`: `cpu`, `rss` or `fds`");
    }
    let quantity = reader.choice(node, "of", &quantities);
    let every = reader.duration(node, "every");
    let name = reader.word(node, "fixture");
    Some(DeclaredSourceKind::Fixture { name: name?, quantity: quantity?, every })
}

fn signal(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<DeclaredSignal> {
    let name = reader.required(node, "name", "")?;
    // Formulas quote names that are not words.
    if name.value.contains(|c: char| c.is_control() || matches!(c, '"' | '\'')) {
        let hint = "a name has no quotes and no control characters";
        reader.wrong("name", &name, "is not the name of a signal", Some(hint));
        return None;
    }
    let unit = match reader.attribute(node, "unit") {
        Some(unit) => Spanned::new(unit.value.trim().to_owned(), unit.span),
        None => Spanned::new(String::new(), name.span),
    };
    Some(DeclaredSignal { name, unit })
}
