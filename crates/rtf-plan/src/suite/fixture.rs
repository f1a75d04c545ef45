//! `<fixture>`, with a plug-in or `type="process"`; [`process`] reads the
//! children of the latter.

use std::time::Duration;

use roxmltree::Node;

use super::provide::{self, Provider};
use super::reader::ElementReader;
use super::schema::{self, check};
use super::{DeclaredFixture, FixtureKind, env, process, reset, test};

/// Reads a `<fixture>`; `None` if it names neither a plug-in nor a process.
pub(super) fn read(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<DeclaredFixture> {
    let is_process = is_process(reader, node);
    let is_attached = reader.boolean(node, "attach").unwrap_or_default();
    let element_schema = match (is_process, is_attached) {
        (true, true) => &schema::ATTACHED,
        (true, false) => &schema::PROCESS,
        (false, _) => &schema::FIXTURE,
    };
    check(reader, node, element_schema);
    if !is_process {
        for name in ["attach", "host"] {
            report_process_attribute(reader, node, name);
        }
    }
    let provider = match (is_process, is_attached) {
        (true, true) => Provider::Attached,
        (true, false) if node.has_attribute("host") => Provider::Remote,
        (true, false) => Provider::Process,
        (false, _) => Provider::Plugin,
    };
    Some(DeclaredFixture {
        span: ElementReader::tag(node),
        name: reader.word(node, "name"),
        depends: node.has_attribute("depends").then(|| reader.words(node, "depends")),
        setup: reader.duration(node, "timeout"),
        check: reader.duration(node, "check-timeout"),
        notify: reader.duration(node, "notify-timeout"),
        teardown: reader.duration(node, "teardown-timeout"),
        restarts: reader.number(node, "restarts", 0),
        restart_delay: restart_delay(reader, node),
        check_every: reader.duration(node, "check-every"),
        env: env::read(reader, node),
        provides: provide::read(reader, node, provider),
        reset: reset::read(reader, node),
        body: match (is_process, is_attached) {
            (true, true) => FixtureKind::Attached(process::attached(reader, node)),
            (true, false) => FixtureKind::Process(Box::new(process::read(reader, node))),
            (false, _) => FixtureKind::Plugin(test::plugin(reader, node)?),
        },
    })
}

/// Reports an attribute that has no meaning for a plug-in, which defines its own set-up.
fn report_process_attribute(reader: &mut ElementReader<'_>, node: Node<'_, '_>, name: &str) {
    let is_set = node.attribute(name).is_some_and(|value| value != "false");
    let span = ElementReader::name_span(node, name).filter(|_| is_set);
    let Some(span) = span else { return };
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
    reader.report(reader.error("wrong-type", span, message).hint(hint));
}

/// The maximum delay before any restart, also after it has doubled several times.
const MAX_RESTART_DELAY: Duration = Duration::from_secs(10);

fn restart_delay(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<Duration> {
    const NAME: &str = "restart-delay";
    let delay = reader.duration(node, NAME)?;
    if delay <= MAX_RESTART_DELAY {
        return Some(delay);
    }
    let what = format!("is longer than {MAX_RESTART_DELAY:?}, the maximum delay before a restart");
    if let Some(attribute) = reader.attribute(node, NAME) {
        reader.wrong(NAME, &attribute, &what, None);
    }
    None
}

/// Checks for the built-in fixture. A fixture with a `<command>` but another
/// `type` counts as one, so that it is one problem and not one per child.
fn is_process(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> bool {
    let declared = reader.attribute(node, "type");
    if declared.as_ref().is_some_and(|kind| kind.value.trim() == "process") {
        return true;
    }
    let has_command = node.children().any(|child| child.has_tag_name("command"));
    if has_command {
        let message = "a fixture with a `<command>` has the type `process`";
        let span = declared.map_or_else(|| ElementReader::tag(node), |declared| declared.span);
        let problem = reader.error("wrong-type", span, message).hint("write `type=\"process\"`");
        reader.report(problem);
    }
    has_command
}
