//! `<suite>`: the way from a text to a [`Suite`].

use roxmltree::Node;
use rtf_model::Diagnostic;

use super::shape::{self, check};
use super::test::{self, Defaults};
use super::value::Reader;
use super::{
    Middleware, Retries, Source, Spanned, Suite, WrittenIsolation, clock, env, fixture, hook, port,
    requires, xml,
};

/// Reads a suite file's text.
///
/// Every problem is added to `problems`. What could be read is returned even
/// when there are errors, so that the planner can find further ones; `None`
/// when the text is not a suite at all.
#[must_use]
pub fn load(source: &Source, problems: &mut Vec<Diagnostic>) -> Option<Suite> {
    let scan = xml::prepare(source, problems)?;
    let document = xml::parse(source, &scan.text, problems)?;
    let root = document.root_element();
    let mut reader = Reader { source, problems, ports: port::Ports::default() };
    let name = root.tag_name();
    if name.name() != "suite" || name.namespace().is_some() {
        reader.report(not_a_suite(source, root));
        return None;
    }
    Some(read_suite(&mut reader, root))
}

fn not_a_suite(source: &Source, root: Node<'_, '_>) -> Diagnostic {
    let name = root.tag_name();
    let message = match name.namespace() {
        Some(_) if name.name() == "suite" => {
            "a suite file has no XML namespace; remove the `xmlns`".to_owned()
        }
        _ => {
            format!("`{}` is not a suite: its first element is `<{}>`", source.name(), name.name())
        }
    };
    let label = source.label(Reader::tag(root), "`<suite>` is expected here");
    Diagnostic::error("not-a-suite", message).label(label)
}

fn read_suite(reader: &mut Reader<'_>, root: Node<'_, '_>) -> Suite {
    check(reader, root, &shape::SUITE);
    let defaults = Defaults {
        limits: test::limits(reader, root, "test-"),
        after_collapse: test::after_collapse(reader, root).unwrap_or_default(),
        leaks: test::leaks(reader, root).unwrap_or_default(),
        retries: test::retries(reader, root, Retries::default()),
    };
    let mut suite = Suite {
        span: Reader::tag(root),
        name: reader.word(root, "name"),
        description: String::new(),
        environment: String::new(),
        env: env::read(reader, root),
        timeout: reader.duration(root, "timeout"),
        tags: test::values(reader.words(root, "tags")),
        isolate: isolation(reader, root),
        requires: requires::read(reader, root),
        tolerates_collapse: reader.truth(root, "tolerate-collapse").unwrap_or(false),
        critical_stops_run: reader
            .choice(root, "critical-stops", &[("suite", false), ("run", true)])
            .unwrap_or(false),
        parallel: reader.number(root, "parallel", 1).unwrap_or(1),
        clock: clock::read(reader, root),
        fixtures: Vec::new(),
        hooks: Vec::new(),
        tests: Vec::new(),
    };
    for node in root.children().filter(Node::is_element) {
        match node.tag_name().name() {
            "description" => {
                let text = only_text(reader, node, "description");
                suite.description = text.value.split_whitespace().collect::<Vec<_>>().join(" ");
            }
            "environment" => {
                let text = only_text(reader, node, "environment");
                port::check(reader, "<environment>", &text);
                suite.environment = text.value;
            }
            "fixture" => suite.fixtures.extend(fixture::read(reader, node)),
            "hook" => suite.hooks.extend(hook::read(reader, node)),
            "test" => suite.tests.extend(test::read(reader, node, defaults)),
            _ => {}
        }
    }
    suite.isolate.ports = reader.ports.names();
    // An element of another name may be a test that was mistyped: that is told.
    let may_be_test = |node: &Node<'_, '_>| {
        node.has_tag_name("test") || !shape::SUITE.elements.contains(&node.tag_name().name())
    };
    if !root.children().filter(Node::is_element).any(|node| may_be_test(&node)) {
        let problem = Diagnostic::error("no-tests", "the suite has no tests")
            .label(reader.source.label(suite.span, "no `<test>` in it"));
        reader.report(problem);
    }
    suite
}

fn isolation(reader: &mut Reader<'_>, root: Node<'_, '_>) -> WrittenIsolation {
    let middleware = [("own", Middleware::Own), ("shared", Middleware::Shared)];
    WrittenIsolation {
        network: reader.choice(root, "isolate", &[("network", ())]).is_some(),
        middleware: reader.choice(root, "middleware", &middleware),
        ports: Vec::new(),
    }
}

/// The trimmed text of an element that there is once. The predecessor took the
/// last one; so do we, but tell.
fn only_text(reader: &mut Reader<'_>, node: Node<'_, '_>, name: &'static str) -> Spanned<String> {
    check(reader, node, &shape::text(name));
    let earlier = node.prev_siblings().skip(1).find(|sibling| sibling.has_tag_name(name));
    if let Some(earlier) = earlier {
        let message = format!("`<{name}>` again; the last one counts");
        let problem = Diagnostic::warning("repeated-element", message)
            .label(reader.source.label(Reader::tag(node), ""))
            .label(reader.source.label(Reader::tag(earlier), "the earlier one"));
        reader.report(problem);
    }
    reader.text(node).unwrap_or_else(|| Spanned::new(String::new(), Reader::tag(node)))
}
