//! `<env>`: environment variables of a suite, test, fixture or hook.

use roxmltree::Node;
use rtf_model::{Diagnostic, protocol};

use super::reader::ElementReader;
use super::reference;
use super::schema::{self, check};

/// Variables that only the runner sets. `RTF_PORT_*` and `RTF_FIXTURE_*` are reserved as well.
const RESERVED: [&str; 16] = [
    protocol::CHANNEL_VARIABLE,
    protocol::FORK_SERVER_VARIABLE,
    protocol::PROGRAM_FORKS_VARIABLE,
    protocol::SCOPE_VARIABLE,
    protocol::OWNER_VARIABLE,
    protocol::ENVIRONMENT_VARIABLE,
    protocol::RUN_DIR_VARIABLE,
    protocol::CLOCK_VARIABLE,
    protocol::CLOCK_FILE_VARIABLE,
    protocol::SESSION_VARIABLE,
    protocol::STACK_FILE_VARIABLE,
    "RTF_HOOK_TRIGGER",
    "RTF_HOOK_REASON",
    "RTF_HOOK_TEST",
    "RTF_SELECTED_CASES",
    "RTF_LISTING",
];

/// Reads the `<env>` children of an element.
pub(super) fn read(reader: &mut ElementReader<'_>, parent: Node<'_, '_>) -> Vec<(String, String)> {
    let mut found: Vec<(String, String)> = Vec::new();
    for node in parent.children().filter(|child| child.has_tag_name("env")) {
        check(reader, node, &schema::ENV);
        let Some(name) = reader.required(node, "name", "") else { continue };
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
        reference::check(reader, "value", &value);
        found.push((name.value, value.value));
    }
    found
}

/// Checks whether only `rtf` may set a variable.
pub(crate) fn is_reserved(name: &str) -> bool {
    RESERVED.contains(&name) || name.starts_with("RTF_PORT_") || name.starts_with("RTF_FIXTURE_")
}
