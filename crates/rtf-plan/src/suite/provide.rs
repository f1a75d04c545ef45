//! `<provide>`: the values that a fixture hands to tests, hooks and other fixtures.

use regex::Regex;
use roxmltree::Node;
use rtf_model::{Diagnostic, FixtureProvided};

use super::reader::ElementReader;
use super::schema::{self, check};
use super::{DeclaredProvide, DeclaredValueSource, Spanned, command, probe, reference};

/// Which kinds of values a fixture can provide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Provider {
    /// A plug-in: it provides its values itself.
    Plugin,
    /// A process of which the runner reads the output.
    Process,
    /// A process on another machine, whose files the runner cannot read.
    Remote,
    /// A process that is only monitored.
    Attached,
}

/// Reads the `<provide>` children of a fixture.
pub(super) fn read(
    reader: &mut ElementReader<'_>,
    fixture: Node<'_, '_>,
    provider: Provider,
) -> Vec<DeclaredProvide> {
    let mut values: Vec<DeclaredProvide> = Vec::new();
    for node in fixture.children().filter(|child| child.has_tag_name("provide")) {
        check(reader, node, &schema::PROVIDE);
        let secret = reader.boolean(node, "secret").unwrap_or_default();
        let source = source(reader, node, provider);
        let (Some(name), Some(source)) = (name(reader, node), source) else { continue };
        if let Some(other) = values.iter().find(|other| other.name.value == name.value) {
            let message = format!("the value `{}` is declared twice", name.value);
            let problem = reader
                .error("repeated-value", name.span, message)
                .label(reader.source.label(other.name.span, "the first one"));
            reader.report(problem);
            continue;
        }
        values.push(DeclaredProvide { name, source, secret });
    }
    values
}

fn name(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<Spanned<String>> {
    let name = reader.required(node, "name", "")?;
    if !FixtureProvided::is_name(&name.value) {
        let hint = format!(
            "a name is a letter, followed by letters, digits, `-` and `_`: at most {} characters",
            FixtureProvided::MAX_NAME_LENGTH
        );
        reader.wrong("name", &name, "is not the name of a value", Some(&hint));
        return None;
    }
    Some(name)
}

fn source(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    provider: Provider,
) -> Option<DeclaredValueSource> {
    let sources = ["log", "file", "command"];
    let mut value = |name| match name {
        "log" => reader.blank_preserving(node, name),
        _ => reader.word(node, name),
    };
    let declared: Vec<_> =
        sources.into_iter().filter_map(|name| Some((name, value(name)?))).collect();
    match (provider, declared.as_slice()) {
        (Provider::Plugin, []) => Some(DeclaredValueSource::Plugin),
        (Provider::Plugin, [(name, value), ..]) => {
            let message = format!("`{name}` is for `type=\"process\"`");
            let problem = reader
                .error("wrong-type", value.span, message)
                .hint("a plug-in provides its values itself, with `provide(name, value)`");
            reader.report(problem);
            None
        }
        (_, [(name, value)]) => process_source(reader, (name, value), provider),
        (_, []) => {
            reader.missing(node, "one of the attributes `log`, `file` and `command`");
            None
        }
        (_, [_, (name, value), ..]) => {
            let message = "`<provide>` has one of the attributes `log`, `file` and `command`";
            let label = reader.source.label(value.span, format!("`{name}` is a second one"));
            reader.report(Diagnostic::error("several-sources", message).label(label));
            None
        }
    }
}

fn process_source(
    reader: &mut ElementReader<'_>,
    (name, value): (&str, &Spanned<String>),
    provider: Provider,
) -> Option<DeclaredValueSource> {
    match (name, provider) {
        ("log", Provider::Attached) => {
            let message = "`rtf` cannot read the output of an attached process";
            reader.report(reader.error("no-output", value.span, message));
            None
        }
        ("log", _) => pattern(reader, name, value).map(DeclaredValueSource::Log),
        ("file", Provider::Remote) => {
            probe::report_local_file(reader, value.span, "use `log`, or `command=\"ssh …\"`");
            None
        }
        ("file", _) => reference::check(reader, name, value)
            .then(|| DeclaredValueSource::File(value.value.clone())),
        _ => {
            let words = command::words(reader, name, value)?;
            Some(DeclaredValueSource::Command(Spanned::new(words, value.span)))
        }
    }
}

fn pattern(reader: &mut ElementReader<'_>, name: &str, value: &Spanned<String>) -> Option<Regex> {
    let pattern = probe::read_pattern(reader, name, value)?;
    if pattern.captures_len() < 2 {
        let hint = "put the value in parentheses: `listening on port (\\d+)`";
        reader.wrong(name, value, "has no group", Some(hint));
        return None;
    }
    Some(pattern)
}
