//! `<suite>`, the root element; `<suit>` in 1.x.

use roxmltree::Node;
use rtf_model::Diagnostic;

use super::reader::ElementReader;
use super::schema::{self, check};
use super::source_file::SUITE_ROOTS;
use super::test::{self, TestDefaults};
use super::{
    DeclaredIsolation, DeclaredMiddleware, DeclaredSuite, ReferenceUser, SourceText, Spanned,
    SuiteSettings, TestSettings, clock, env, episode_test, fault, fixture, hook, monitor,
    read_document, reference, requires, signal_source,
};

/// Parses the text of a suite file and adds every problem to `problems`.
///
/// Returns the readable part of the suite even if there are errors, so that the
/// planner can find further ones; `None` if the text is not a suite at all.
#[must_use]
pub fn parse(source: &SourceText, problems: &mut Vec<Diagnostic>) -> Option<DeclaredSuite> {
    read_document(source, problems, |reader, root| {
        let name = root.tag_name();
        if !SUITE_ROOTS.contains(&name.name()) || name.namespace().is_some() {
            reader.report(not_a_suite(source, root));
            return None;
        }
        Some(read_suite(reader, root))
    })
}

fn not_a_suite(source: &SourceText, root: Node<'_, '_>) -> Diagnostic {
    let name = root.tag_name();
    let message = match name.namespace() {
        Some(_) if SUITE_ROOTS.contains(&name.name()) => {
            "a suite file has no XML namespace; remove the `xmlns`".to_owned()
        }
        _ => {
            format!("`{}` is not a suite: its first element is `<{}>`", source.name(), name.name())
        }
    };
    let label = source.label(ElementReader::tag(root), "`<suite>` is expected here");
    let problem = Diagnostic::error("not-a-suite", message).label(label);
    match name.name() {
        "campaign" => problem.hint(
            "`rtf campaign run` runs all episodes of a campaign, `rtf run --episode ID` one of them",
        ),
        _ => problem,
    }
}

fn read_suite(reader: &mut ElementReader<'_>, root: Node<'_, '_>) -> DeclaredSuite {
    check(reader, root, &schema::SUITE);
    let defaults = TestDefaults {
        limits: test::limits(reader, root, "test-"),
        settings: test::inherited_settings(reader, root, TestSettings::default()),
    };
    let settings = SuiteSettings {
        description: String::new(),
        environment: String::new(),
        timeout: reader.duration(root, "timeout"),
        requires: requires::read(reader, root),
        tolerates_collapse: reader.boolean(root, "tolerate-collapse").unwrap_or(false),
        critical_stops_run: reader
            .choice(root, "critical-stops", &[("suite", false), ("run", true)])
            .unwrap_or(false),
        skips_fail: reader
            .choice(root, "skips", &[("pass", false), ("fail", true)])
            .unwrap_or(false),
        parallel: reader.number(root, "parallel", 1).unwrap_or(1),
    };
    let mut suite = DeclaredSuite {
        span: ElementReader::tag(root),
        name: reader.word(root, "name"),
        env: env::read(reader, root),
        tags: test::values(reader.words(root, "tags")),
        isolate: isolation(reader, root),
        settings,
        clock: clock::read(reader, root),
        fixtures: Vec::new(),
        hooks: Vec::new(),
        signals: Vec::new(),
        monitors: Vec::new(),
        envelopes: Vec::new(),
        faults: Vec::new(),
        tests: Vec::new(),
        fixture_references: super::FixtureReferences::default(),
    };
    for node in root.children().filter(Node::is_element) {
        reader.user = match node.tag_name().name() {
            "fixture" => ReferenceUser::Fixture(suite.fixtures.len()),
            // Signals are read, and faults injected, after all fixtures are set up.
            "hook" | "test" | "signal" | "signals" | "fault" => ReferenceUser::TestOrHook,
            _ => ReferenceUser::Suite,
        };
        read_child(reader, node, &mut suite, defaults);
    }
    suite.isolate.ports = reader.ports.names();
    suite.fixture_references = std::mem::take(&mut reader.fixture_references);
    episode_test::check(reader, &suite);
    // An unknown element may be a misspelt test, and is reported as unknown.
    let may_be_test = |node: &Node<'_, '_>| {
        node.has_tag_name("test") || !schema::SUITE.elements.contains(&node.tag_name().name())
    };
    if !root.children().filter(Node::is_element).any(|node| may_be_test(&node)) {
        let problem = Diagnostic::error("no-tests", "the suite has no tests")
            .label(reader.source.label(suite.span, "contains no `<test>`"));
        reader.report(problem);
    }
    suite
}

fn read_child(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    suite: &mut DeclaredSuite,
    defaults: TestDefaults,
) {
    match node.tag_name().name() {
        "description" => {
            let text = last_text(reader, node, "description");
            suite.settings.description =
                text.value.split_whitespace().collect::<Vec<_>>().join(" ");
        }
        "environment" => {
            let text = last_text(reader, node, "environment");
            reference::check(reader, "<environment>", &text);
            suite.settings.environment = text.value;
        }
        "fixture" => suite.fixtures.extend(fixture::read(reader, node)),
        "hook" => suite.hooks.extend(hook::read(reader, node)),
        "signal" => suite.signals.extend(signal_source::read(reader, node)),
        "signals" => suite.signals.extend(signal_source::read_group(reader, node)),
        "fault" => suite.faults.extend(fault::read(reader, node)),
        "monitor" => suite.monitors.extend(monitor::read(reader, node)),
        "envelope" => suite.envelopes.extend(monitor::read_envelope(reader, node)),
        "test" => suite.tests.extend(test::read(reader, node, defaults)),
        _ => {}
    }
}

fn isolation(reader: &mut ElementReader<'_>, root: Node<'_, '_>) -> DeclaredIsolation {
    let middleware = [("own", DeclaredMiddleware::Own), ("shared", DeclaredMiddleware::Shared)];
    DeclaredIsolation {
        network: reader.choice(root, "isolate", &[("network", ())]).is_some(),
        middleware: reader.choice(root, "middleware", &middleware),
        ports: Vec::new(),
    }
}

/// Reads the text of an element. Of several, the last one applies, as in 2.x,
/// with a warning.
fn last_text(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    name: &'static str,
) -> Spanned<String> {
    check(reader, node, &schema::text(name));
    let earlier = node.prev_siblings().skip(1).find(|sibling| sibling.has_tag_name(name));
    if let Some(earlier) = earlier {
        let message = format!("repeated `<{name}>`: the last one applies");
        let problem = reader
            .source
            .warning("repeated-element", ElementReader::tag(node), message)
            .label(reader.source.label(ElementReader::tag(earlier), "the earlier one"));
        reader.report(problem);
    }
    reader.text(node).unwrap_or_else(|| Spanned::new(String::new(), ElementReader::tag(node)))
}
