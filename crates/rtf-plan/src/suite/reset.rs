//! `<reset>`: how a fixture is reset between two episodes of a campaign.

use roxmltree::Node;

use super::reader::ElementReader;
use super::schema::{self, check};
use super::{DeclaredReset, Span, Spanned, command};

/// Reads the `<reset>` of a fixture.
pub(super) fn read(reader: &mut ElementReader<'_>, fixture: Node<'_, '_>) -> Option<DeclaredReset> {
    let mut seen: Option<Span> = None;
    let mut reset = None;
    for node in fixture.children().filter(|child| child.has_tag_name("reset")) {
        reader.once(node, &mut seen);
        check(reader, node, &schema::RESET);
        let timeout = reader.duration(node, "timeout");
        let restart_every = reader.number(node, "restart-every", 1);
        let Some(line) = reader.word(node, "command") else {
            if !node.has_attribute("command") {
                reader.missing(node, "the attribute `command`");
            }
            continue;
        };
        let Some(words) = command::words(reader, "command", &line) else { continue };
        let command = Spanned::new(words, line.span);
        reset = Some(DeclaredReset { command, timeout, restart_every });
    }
    reset
}
