//! `<ready>` and `<alive>`.

use roxmltree::Node;
use rtf_model::Diagnostic;

use super::command::words;
use super::shape::{Shape, check};
use super::value::Reader;
use super::{Probe, Question, Span, Spanned, middleware, port};

/// The attributes that say what is asked; each probe has exactly one of them.
const QUESTIONS: [&str; 11] = [
    "tcp",
    "http",
    "log",
    "log-bad",
    "file",
    "command",
    "ros-node",
    "ros-topic",
    "ros-service",
    "ros2-topic",
    "yarp-port",
];

/// Reads a probe; `None` when it cannot be asked.
pub(super) fn read(reader: &mut Reader<'_>, node: Node<'_, '_>, shape: &Shape) -> Option<Probe> {
    check(reader, node, shape);
    let every = reader.duration(node, "every");
    let timeout = reader.duration(node, "timeout");
    let known = |name: &&str| shape.attributes.contains(name);
    let asked: Vec<&str> =
        QUESTIONS.into_iter().filter(known).filter(|name| node.has_attribute(*name)).collect();
    let [name] = asked[..] else {
        number_of_questions(reader, node, shape, &asked);
        return None;
    };
    let value = reader.word(node, name)?;
    // A log is watched as it is written, and a file is there or not: neither
    // takes time to answer.
    let idle: &[&str] = match name {
        "log" | "log-bad" => &["every", "timeout", "min-rate"],
        "file" => &["timeout", "min-rate"],
        "ros-topic" | "ros2-topic" => &[],
        _ => &["min-rate"],
    };
    for unused in idle.iter().filter(|unused| node.has_attribute(**unused)) {
        without_effect(reader, node, unused, name);
    }
    let question = if middleware::is_question(name) {
        middleware::read(reader, node, name, &value)?
    } else {
        question(reader, name, &value)?
    };
    Some(Probe { question, span: value.span, every, timeout })
}

fn question(reader: &mut Reader<'_>, name: &str, value: &Spanned<String>) -> Option<Question> {
    // Commands are looked at with all others, patterns have none.
    if matches!(name, "tcp" | "http" | "file") && !port::check(reader, name, value) {
        return None;
    }
    // Any port will do to see whether the rest is right.
    let example = crate::config::sample(&port::expand(&value.value, |_| "1".to_owned()));
    match name {
        "tcp" => {
            let port = example.rsplit_once(':').filter(|(host, _)| !host.is_empty());
            if port.is_none_or(|(_, port)| port.parse::<u16>().unwrap_or(0) == 0) {
                let hint = Some("write it like `127.0.0.1:5000`");
                reader.wrong(name, value, "is not a host and a port", hint);
                return None;
            }
            Some(Question::Tcp(value.value.clone()))
        }
        "http" => {
            if example.get(..6).is_some_and(|start| start.eq_ignore_ascii_case("https:")) {
                let hint = format!(
                    "probes speak plain HTTP; ask with `command=\"curl -fsS {}\"`",
                    value.value
                );
                reader.wrong(name, value, "cannot ask over TLS", Some(&hint));
                return None;
            }
            let url = url::Url::parse(&example).ok();
            if url.is_none_or(|url| url.scheme() != "http" || !url.has_host()) {
                let hint = Some("write it like `http://127.0.0.1:8080/health`");
                reader.wrong(name, value, "is not a URL with `http://`", hint);
                return None;
            }
            Some(Question::Http(value.value.clone()))
        }
        "file" => Some(Question::File(value.value.clone())),
        "command" => words(reader, name, value).map(Question::Command),
        _ if port::mentions(&value.value) => {
            let hint = "write what the number looks like, `\\d+`";
            reader.wrong(name, value, "cannot have a `${port:…}`", Some(hint));
            None
        }
        _ => match regex::Regex::new(&value.value) {
            Ok(pattern) => Some(Question::Log(pattern)),
            Err(error) => {
                let problem = Diagnostic::error(
                    "invalid-value",
                    format!("`{name}` is not a regular expression: `{}`", value.value),
                );
                let label = reader.source.label(value.span, "");
                reader.report(problem.label(label).note(error.to_string()));
                None
            }
        },
    }
}

fn number_of_questions(reader: &mut Reader<'_>, node: Node<'_, '_>, shape: &Shape, asked: &[&str]) {
    if asked.is_empty() {
        let known = QUESTIONS.iter().filter(|name| shape.attributes.contains(name));
        let list: Vec<_> = known.map(|name| format!("`{name}`")).collect();
        reader.missing(node, &format!("one of the attributes {}", list.join(", ")));
        return;
    }
    let list: Vec<_> = asked.iter().map(|name| format!("`{name}`")).collect();
    let message = format!("`<{}>` asks several things: {}", shape.name, list.join(" and "));
    let problem = Diagnostic::error("several-questions", message)
        .label(reader.source.label(Reader::tag(node), ""))
        .hint(format!("write one `<{}>` for each; all of them count", shape.name));
    reader.report(problem);
}

fn without_effect(reader: &mut Reader<'_>, node: Node<'_, '_>, unused: &str, name: &str) {
    let Some(attribute) = node.attribute_node(unused) else { return };
    let message = format!("`{unused}` has no effect beside `{name}`");
    let label = reader.source.label(Span::new(attribute.range_qname()), "");
    reader.report(Diagnostic::error("without-effect", message).label(label));
}
