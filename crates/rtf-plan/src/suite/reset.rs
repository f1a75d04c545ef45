//! `<reset>`: how a fixture is reset between two episodes of a campaign.

use roxmltree::Node;

use super::reader::ElementReader;
use super::schema::{self, check};
use super::{DeclaredReset, HookKind, Span, Spanned, command, hook, test};

pub(super) fn read(reader: &mut ElementReader<'_>, fixture: Node<'_, '_>) -> Option<DeclaredReset> {
    let mut seen: Option<Span> = None;
    let mut reset = None;
    for node in fixture.children().filter(|child| child.has_tag_name("reset")) {
        reader.once(node, &mut seen);
        check(reader, node, &schema::RESET);
        let timeout = reader.duration(node, "timeout");
        let restart_every = reader.number(node, "restart-every", 1);
        let Some(body) = body(reader, node) else { continue };
        reset = Some(DeclaredReset { body, timeout, restart_every });
    }
    reset
}

fn body(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<HookKind> {
    let text = node.children().filter(Node::is_text).find_map(|text| reader.trimmed(text));
    match (node.has_attribute("command"), text) {
        (true, text) => {
            hook::report_plugin_parts(reader, node, text, ("`command`", "remove one of them"));
            let line = reader.word(node, "command")?;
            let words = command::words(reader, "command", &line)?;
            Some(HookKind::Command(Spanned::new(words, line.span)))
        }
        (false, Some(_)) => test::plugin(reader, node).map(HookKind::Plugin),
        (false, None) => {
            reader.missing(node, "the attribute `command`, or the name of a plug-in as its text");
            None
        }
    }
}
