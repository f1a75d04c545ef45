//! `<monitor>`: a formula over signals that judges tests; `<envelope>`: a file of them.

use roxmltree::Node;
use rtf_model::FindingSeverity;

use super::reader::ElementReader;
use super::schema::{self, check};
use super::{DeclaredEnvelope, DeclaredMonitor};

/// Reads a `<monitor>`; `None` if it has no name or formula.
pub(super) fn read(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<DeclaredMonitor> {
    check(reader, node, &schema::MONITOR);
    let name = reader.required(node, "name", "");
    let severity = reader.choice(node, "severity", &FindingSeverity::ALL);
    let Some(formula) = reader.text(node) else {
        reader.missing(node, "a formula as its text");
        return None;
    };
    let severity = severity.unwrap_or(FindingSeverity::Fail);
    Some(DeclaredMonitor { span: ElementReader::tag(node), name: name?, severity, formula })
}

/// Reads an `<envelope>`; `None` if it has no file.
pub(super) fn read_envelope(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
) -> Option<DeclaredEnvelope> {
    check(reader, node, &schema::ENVELOPE);
    let file = reader.required(node, "file", "")?;
    Some(DeclaredEnvelope { span: ElementReader::tag(node), file })
}

pub(super) fn read_all(
    reader: &mut ElementReader<'_>,
    parent: Node<'_, '_>,
) -> Vec<DeclaredMonitor> {
    let mut monitors = Vec::new();
    for node in parent.children().filter(|child| child.has_tag_name("monitor")) {
        monitors.extend(read(reader, node));
    }
    monitors
}
