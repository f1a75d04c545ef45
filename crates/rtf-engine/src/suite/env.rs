//! `<env name value/>`.

use roxmltree::Node;
use rtf_model::{Diagnostic, protocol};

use super::port;
use super::shape::{self, check};
use super::value::Reader;

/// Variables that the runner sets for its processes itself.
const RESERVED: [&str; 12] = [
    protocol::CHANNEL_VARIABLE,
    protocol::FORK_SERVER_VARIABLE,
    protocol::SCOPE_VARIABLE,
    protocol::OWNER_VARIABLE,
    protocol::ENVIRONMENT_VARIABLE,
    protocol::RUN_FOLDER_VARIABLE,
    protocol::CLOCK_VARIABLE,
    protocol::CLOCK_FILE_VARIABLE,
    "RTF_FIXTURE_START",
    "RTF_HOOK_TRIGGER",
    "RTF_HOOK_REASON",
    "RTF_HOOK_TEST",
];

/// Reads the `<env>` children of an element.
pub(super) fn read(reader: &mut Reader<'_>, parent: Node<'_, '_>) -> Vec<(String, String)> {
    let mut found: Vec<(String, String)> = Vec::new();
    for node in parent.children().filter(|child| child.has_tag_name("env")) {
        check(reader, node, &shape::ENV);
        let Some(name) = reader.word(node, "name") else {
            if node.attribute("name").is_none() {
                reader.missing(node, "the attribute `name`");
            }
            continue;
        };
        if name.value.contains('=') {
            reader.wrong("name", &name, "cannot have a `=`", None);
        } else if is_reserved(&name.value) {
            reader.wrong("name", &name, "is a variable that rtf sets itself", None);
        } else if found.iter().any(|(known, _)| *known == name.value) {
            let message = format!("the variable `{}` is set twice", name.value);
            let label = reader.source.label(name.span, "a second time");
            reader.report(Diagnostic::error("repeated-variable", message).label(label));
        }
        let Some(value) = reader.attribute(node, "value") else {
            reader.missing(node, "the attribute `value`; it may be empty");
            continue;
        };
        port::check(reader, "value", &value);
        found.push((name.value, value.value));
    }
    found
}

/// Whether a variable is rtf's own.
pub(crate) fn is_reserved(name: &str) -> bool {
    RESERVED.contains(&name) || name.starts_with("RTF_PORT_")
}
