//! `<hook>`, with a plug-in or a `<command>`.

use roxmltree::Node;
use rtf_model::{Diagnostic, Trigger};

use super::shape::{self, check, nearest};
use super::value::Reader;
use super::{Hook, HookKind, Span, Spanned, command, env, test};

/// Reads a `<hook>`; `None` when it does not say what it is.
pub(super) fn read(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Option<Hook> {
    check(reader, node, &shape::HOOK);
    let name = reader.word(node, "name");
    let on = on(reader, node);
    let timeout = reader.duration(node, "timeout");
    let env = env::read(reader, node);
    let body = body(reader, node)?;
    Some(Hook { name, on, body, env, timeout })
}

/// What calls for it: a hook that nothing calls for is a mistake.
fn on(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Vec<Trigger> {
    let Some(attribute) = reader.attribute(node, "on") else {
        reader.missing(node, "the attribute `on`, which says when it is run");
        return Vec::new();
    };
    let words = reader.words(node, "on");
    if words.is_empty() {
        let hint = format!("it can have {}", known());
        reader.wrong("on", &attribute, "names nothing that calls for the hook", Some(&hint));
    }
    let mut on = Vec::new();
    for word in &words {
        match Trigger::ALL.into_iter().find(|trigger| trigger.as_str() == word.value) {
            Some(trigger) if on.contains(&trigger) => {}
            Some(trigger) => on.push(trigger),
            None => unknown(reader, word),
        }
    }
    on
}

fn unknown(reader: &mut Reader<'_>, word: &Spanned<String>) {
    let message = format!("nothing calls for a hook with the word `{}`", word.value);
    let problem = Diagnostic::error("invalid-value", message)
        .label(reader.source.label(word.span, "not known in `on`"))
        .note(format!("`on` can have {}", known()));
    let nearest = nearest(&word.value, Trigger::ALL.iter().map(|trigger| trigger.as_str()));
    reader.report(match nearest {
        Some(trigger) => problem.hint(format!("did you mean `{trigger}`?")),
        None => problem,
    });
}

fn known() -> String {
    Trigger::ALL.map(|trigger| format!("`{trigger}`")).join(", ")
}

fn body(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Option<HookKind> {
    let text = node.children().filter(Node::is_text).find_map(|text| reader.trimmed(text));
    let mut seen = None;
    let mut program = None;
    for child in node.children().filter(|child| child.has_tag_name("command")) {
        reader.once(child, &mut seen);
        program = Some(command::read(reader, child));
    }
    match (program, text) {
        (Some(program), text) => {
            only_a_plugin_has(reader, node, text);
            Some(HookKind::Command(program))
        }
        (None, Some(_)) => test::plugin(reader, node).map(HookKind::Plugin),
        (None, None) => {
            reader.missing(node, "the name of a plug-in as its text, or a `<command>`");
            None
        }
    }
}

/// Reports what stands beside a `<command>` and belongs to a plug-in.
fn only_a_plugin_has(reader: &mut Reader<'_>, node: Node<'_, '_>, text: Option<Span>) {
    if let Some(text) = text {
        let problem = Diagnostic::error("wrong-type", "the hook has a plug-in and a `<command>`")
            .label(reader.source.label(text, "the plug-in"))
            .hint("write two hooks; both are run");
        reader.report(problem);
    }
    let hints = [
        ("type", "a program has no type; leave it out"),
        ("param", "write the arguments behind the program, in `<command>`"),
    ];
    for (name, hint) in hints {
        let Some(attribute) = node.attribute_node(name) else { continue };
        let message = format!("`{name}` has no effect beside `<command>`");
        let label = reader.source.label(Span::new(attribute.range_qname()), "");
        reader.report(Diagnostic::error("without-effect", message).label(label).hint(hint));
    }
}
