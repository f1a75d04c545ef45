//! `<fixture>`, with a plug-in or `type="process"`; what is in the latter is
//! read by [`process`].

use std::time::Duration;

use roxmltree::Node;
use rtf_model::Diagnostic;

use super::shape::{self, check};
use super::value::Reader;
use super::{Fixture, FixtureKind, Span, env, process, test};

/// Reads a `<fixture>`; `None` when it does not say what it is.
pub(super) fn read(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Option<Fixture> {
    let is_process = is_process(reader, node);
    let is_attached = reader.truth(node, "attach").unwrap_or_default();
    let shape = match (is_process, is_attached) {
        (true, true) => &shape::ATTACHED,
        (true, false) => &shape::PROCESS,
        (false, _) => &shape::FIXTURE,
    };
    check(reader, node, shape);
    if !is_process {
        for name in ["attach", "host"] {
            only_for_processes(reader, node, name);
        }
    }
    let name = reader.word(node, "name");
    let depends = node.has_attribute("depends").then(|| reader.words(node, "depends"));
    let setup = reader.duration(node, "timeout");
    let check = reader.duration(node, "check-timeout");
    let notice = reader.duration(node, "notice-timeout");
    let teardown = reader.duration(node, "teardown-timeout");
    let restarts = reader.number(node, "restarts", 0);
    let restart_delay = restart_delay(reader, node);
    let check_every = reader.duration(node, "check-every");
    let env = env::read(reader, node);
    let body = match (is_process, is_attached) {
        (true, true) => FixtureKind::Attached(process::attached(reader, node)),
        (true, false) => FixtureKind::Process(Box::new(process::read(reader, node))),
        (false, _) => FixtureKind::Plugin(test::plugin(reader, node)?),
    };
    let span = Reader::tag(node);
    Some(Fixture {
        span,
        name,
        depends,
        body,
        env,
        setup,
        check,
        notice,
        teardown,
        restarts,
        restart_delay,
        check_every,
    })
}

/// A plug-in decides itself what its `setup` and `tearDown` do, and where.
fn only_for_processes(reader: &mut Reader<'_>, node: Node<'_, '_>, name: &str) {
    let Some(attribute) = node.attribute_node(name).filter(|written| written.value() != "false")
    else {
        return;
    };
    let (message, hint) = match name {
        "attach" => (
            "only `type=\"process\"` can be attached",
            "a plug-in that only watches needs no `attach`: it has a `check`, and no `setup`",
        ),
        _ => (
            "only `type=\"process\"` can run on another machine",
            "write a `<command>` that is started there",
        ),
    };
    let label = reader.source.label(Span::new(attribute.range_qname()), "");
    reader.report(Diagnostic::error("wrong-type", message).label(label).hint(hint));
}

/// A wait that grows with each restart never gets longer than this; one that
/// begins longer could not be kept.
const LONGEST_DELAY: Duration = Duration::from_secs(10);

fn restart_delay(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Option<Duration> {
    const NAME: &str = "restart-delay";
    let delay = reader.duration(node, NAME)?;
    if delay <= LONGEST_DELAY {
        return Some(delay);
    }
    let what = format!("is longer than {LONGEST_DELAY:?}, the longest wait before a restart");
    if let Some(written) = reader.attribute(node, NAME) {
        reader.wrong(NAME, &written, &what, None);
    }
    None
}

/// Whether it is the built-in fixture. One with a `<command>` was meant to be,
/// whatever its `type` says: that is one mistake, not one for each child.
fn is_process(reader: &mut Reader<'_>, node: Node<'_, '_>) -> bool {
    let written = reader.attribute(node, "type");
    if written.as_ref().is_some_and(|kind| kind.value.trim() == "process") {
        return true;
    }
    let meant = node.children().any(|child| child.has_tag_name("command"));
    if meant {
        let message = "a fixture with a `<command>` is of another type";
        let span = written.map_or_else(|| Reader::tag(node), |written| written.span);
        let problem = Diagnostic::error("wrong-type", message)
            .label(reader.source.label(span, ""))
            .hint("write `type=\"process\"`");
        reader.report(problem);
    }
    meant
}
