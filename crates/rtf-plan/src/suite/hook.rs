//! `<hook>`, with a plug-in or a `<command>`.

use roxmltree::Node;
use rtf_model::{Diagnostic, Trigger};

use super::reader::ElementReader;
use super::schema::{self, check};
use super::{DeclaredHook, HookKind, Span, Spanned, command, env, test};
use crate::wording::{quoted, suggest};

/// Reads a `<hook>`; `None` if it has neither a plug-in nor a command.
pub(super) fn read(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<DeclaredHook> {
    check(reader, node, &schema::HOOK);
    let name = reader.word(node, "name");
    let on = triggers(reader, node);
    let timeout = reader.duration(node, "timeout");
    let env = env::read(reader, node);
    let body = body(reader, node)?;
    Some(DeclaredHook { name, on, body, env, timeout })
}

/// Reads the triggers; a hook needs at least one.
fn triggers(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Vec<Trigger> {
    let Some(attribute) = reader.attribute(node, "on") else {
        reader.missing(node, "the attribute `on` with its triggers");
        return Vec::new();
    };
    let words = reader.words(node, "on");
    if words.is_empty() {
        let hint = format!("the triggers are {}", known_triggers());
        reader.wrong("on", &attribute, "names no trigger", Some(&hint));
    }
    let mut on = Vec::new();
    for word in &words {
        match Trigger::ALL.into_iter().find(|trigger| trigger.as_str() == word.value) {
            Some(trigger) if on.contains(&trigger) => {}
            Some(trigger) => on.push(trigger),
            None => report_unknown(reader, word),
        }
    }
    on
}

fn report_unknown(reader: &mut ElementReader<'_>, word: &Spanned<String>) {
    let problem = Diagnostic::error("invalid-value", format!("unknown trigger `{}`", word.value))
        .label(reader.source.label(word.span, "not known in `on`"))
        .note(format!("the triggers are {}", known_triggers()));
    let known = Trigger::ALL.iter().map(|trigger| trigger.as_str());
    reader.report(suggest(problem, &word.value, known));
}

fn known_triggers() -> String {
    quoted(Trigger::ALL.iter().map(|trigger| trigger.as_str()), ", ")
}

fn body(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<HookKind> {
    let text = node.children().filter(Node::is_text).find_map(|text| reader.trimmed(text));
    let mut seen = None;
    let mut program = None;
    for child in node.children().filter(|child| child.has_tag_name("command")) {
        reader.once(child, &mut seen);
        program = Some(command::read(reader, child));
    }
    match (program, text) {
        (Some(program), text) => {
            let hint = "write two hooks; both are run";
            report_plugin_parts(reader, node, text, ("`<command>`", hint));
            Some(HookKind::Command(program))
        }
        (None, Some(_)) => test::plugin(reader, node).map(HookKind::Plugin),
        (None, None) => {
            reader.missing(node, "the name of a plug-in as its text, or a `<command>`");
            None
        }
    }
}

/// Reports the text and the attributes that an element with `command` cannot have. The hint is that
/// for the text.
pub(super) fn report_plugin_parts(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    text: Option<Span>,
    (command, hint): (&str, &str),
) {
    if let Some(text) = text {
        let name = node.tag_name().name();
        let message = format!("the {name} has a plug-in and a {command}");
        let problem = Diagnostic::error("wrong-type", message)
            .label(reader.source.label(text, "the plug-in"))
            .hint(hint);
        reader.report(problem);
    }
    let hints = [
        ("type", "a program has no type; remove the attribute".to_owned()),
        ("param", format!("write the arguments after the program, in {command}")),
    ];
    for (name, hint) in hints {
        let Some(span) = ElementReader::name_span(node, name) else { continue };
        let message = format!("`{name}` has no effect with {command}");
        reader.report(reader.error("without-effect", span, message).hint(hint));
    }
}
