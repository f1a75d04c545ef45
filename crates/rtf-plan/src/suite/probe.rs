//! `<ready>` and `<alive>`.

use regex::Regex;
use roxmltree::Node;

use super::command::words;
use super::reader::ElementReader;
use super::schema::{ElementSchema, check};
use super::{DeclaredProbe, DeclaredProbeKind, Span, Spanned, middleware, reference};
use crate::wording::{in_attribute, quoted};

/// The attributes that modify a probe; each other attribute is a kind of probe.
const MODIFIERS: [&str; 3] = ["min-rate", "timeout", "every"];

/// Reads a probe; `None` if it is invalid.
pub(super) fn read(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    schema: &ElementSchema,
) -> Option<DeclaredProbe> {
    check(reader, node, schema);
    let every = reader.duration(node, "every");
    let timeout = reader.duration(node, "timeout");
    let kinds = schema.attributes.iter().copied().filter(|name| !MODIFIERS.contains(name));
    let kinds: Vec<&str> = kinds.collect();
    let declared: Vec<&str> =
        kinds.iter().copied().filter(|name| node.has_attribute(*name)).collect();
    let name = match declared[..] {
        [] => {
            let list = quoted(kinds, ", ");
            reader.missing(node, &format!("one of the attributes {list}"));
            return None;
        }
        [name] => name,
        _ => {
            report_several(reader, node, schema, declared);
            return None;
        }
    };
    let value = match name {
        // A blank is a part of a prompt.
        "log" | "log-bad" => reader.blank_preserving(node, name)?,
        _ => reader.word(node, name)?,
    };
    // `rtf` matches a log line when it is printed, and `file` only checks whether
    // the file exists: neither of them takes time to answer.
    let unused: &[&str] = match name {
        "log" | "log-bad" => &["every", "timeout", "min-rate"],
        "file" => &["timeout", "min-rate"],
        "ros-topic" | "ros2-topic" => &[],
        _ => &["min-rate"],
    };
    for modifier in unused.iter().filter(|modifier| node.has_attribute(**modifier)) {
        report_without_effect(reader, node, modifier, name);
    }
    let kind = if middleware::is_probe(name) {
        middleware::read(reader, node, name, &value)?
    } else {
        read_kind(reader, name, &value)?
    };
    Some(DeclaredProbe { kind, span: value.span, every, timeout })
}

fn read_kind(
    reader: &mut ElementReader<'_>,
    name: &str,
    value: &Spanned<String>,
) -> Option<DeclaredProbeKind> {
    // `words` checks the ports of a command, and a pattern cannot refer to one.
    if matches!(name, "tcp" | "http" | "file") && !reference::check(reader, name, value) {
        return None;
    }
    // With an example port the syntax of the rest can be checked.
    let example = crate::config::sample(&reference::example(&value.value));
    match name {
        "tcp" => {
            let port = example.rsplit_once(':').filter(|(host, _)| !host.is_empty());
            if port.is_none_or(|(_, port)| port.parse::<u16>().unwrap_or(0) == 0) {
                let hint = Some("write it like `127.0.0.1:5000`");
                reader.wrong(name, value, "is not a host and a port", hint);
                return None;
            }
            Some(DeclaredProbeKind::Tcp(value.value.clone()))
        }
        "http" => read_url(reader, name, value, &example),
        "file" => Some(DeclaredProbeKind::File(value.value.clone())),
        "command" => words(reader, name, value).map(DeclaredProbeKind::Command),
        _ => read_pattern(reader, name, value).map(DeclaredProbeKind::Log),
    }
}

/// Reads a regular expression, which cannot contain references.
pub(super) fn read_pattern(
    reader: &mut ElementReader<'_>,
    name: &str,
    value: &Spanned<String>,
) -> Option<Regex> {
    if reference::is_in(&value.value) {
        let hint = "write a pattern for the value: `\\d+`";
        reader.wrong(name, value, "cannot contain `${port:…}` or `${fixture:…}`", Some(hint));
        return None;
    }
    match Regex::new(&value.value) {
        Ok(pattern) => Some(pattern),
        Err(error) => {
            let message = format!("`{name}` is not a regular expression: `{}`", value.value);
            let problem = reader.error("invalid-value", value.span, message);
            reader.report(problem.note(error.to_string()));
            None
        }
    }
}

/// Reports a file of a process on another machine.
pub(super) fn report_local_file(reader: &mut ElementReader<'_>, span: Span, hint: &str) {
    let message = "`file` checks this machine, and the fixture runs on another one";
    let problem = reader.error("other-machine", span, message).hint(hint);
    reader.report(problem);
}

fn read_url(
    reader: &mut ElementReader<'_>,
    name: &str,
    value: &Spanned<String>,
    example: &str,
) -> Option<DeclaredProbeKind> {
    if example.get(..6).is_some_and(|start| start.eq_ignore_ascii_case("https:")) {
        let url = in_attribute(&value.value);
        let hint = format!("probe it with `command=\"curl -fsS {url}\"`");
        reader.wrong(name, value, "supports only plain HTTP, not TLS", Some(&hint));
        return None;
    }
    let url = url::Url::parse(example).ok();
    if url.is_none_or(|url| url.scheme() != "http" || !url.has_host()) {
        let hint = Some("write it like `http://127.0.0.1:8080/health`");
        reader.wrong(name, value, "is not a URL with `http://`", hint);
        return None;
    }
    Some(DeclaredProbeKind::Http(value.value.clone()))
}

fn report_several(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    schema: &ElementSchema,
    declared: Vec<&str>,
) {
    let message = format!("`<{}>` has several probes: {}", schema.name, quoted(declared, " and "));
    let problem = reader
        .error("several-probes", ElementReader::tag(node), message)
        .hint(format!("write a separate `<{}>` for each; all of them must pass", schema.name));
    reader.report(problem);
}

fn report_without_effect(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    modifier: &str,
    name: &str,
) {
    let Some(span) = ElementReader::name_span(node, modifier) else { return };
    let message = format!("`{modifier}` has no effect with `{name}`");
    reader.report(reader.error("without-effect", span, message));
}
