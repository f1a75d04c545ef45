//! `<test>`.

use std::time::Duration;

use roxmltree::Node;
use rtf_model::Diagnostic;

use super::reader::ElementReader;
use super::schema::{self, check};
use super::{
    AfterCollapse, DeclaredCases, DeclaredLimits, DeclaredPlugin, DeclaredTest, ForkPoint, Leaks,
    Retries, Span, Spanned, TestIsolation, TestSettings, env, episode_test, fault, known_failure,
    learn, matrix, monitor, reference,
};

/// The defaults that a suite declares for its tests.
#[derive(Clone, Copy, Default)]
pub(super) struct TestDefaults {
    pub limits: DeclaredLimits,
    pub settings: TestSettings,
}

/// Reads a `<test>`; `None` if it names no plug-in.
pub(super) fn read(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    defaults: TestDefaults,
) -> Option<DeclaredTest> {
    check(reader, node, &schema::TEST);
    let (declared, default) = (limits(reader, node, ""), defaults.limits);
    let limits = DeclaredLimits {
        load: declared.load.or(default.load),
        setup: declared.setup.or(default.setup),
        run: declared.run.or(default.run),
        teardown: declared.teardown.or(default.teardown),
        slow: declared.slow.or(default.slow),
        grace: declared.grace.or(default.grace),
        case: None,
    };
    let has_cases = node.attributes().any(|attribute| CASE_ATTRIBUTES.contains(&attribute.name()));
    let cases =
        if has_cases { CaseAttributes::read(reader, node) } else { CaseAttributes::default() };
    let own_domain = reader.choice(node, "middleware", &[("own", true)]).unwrap_or(false);
    let settings = TestSettings {
        repetitions: reader.number(node, "repetition", 1).unwrap_or(1),
        critical: reader.boolean(node, "critical").unwrap_or(false),
        exclusive: reader.boolean(node, "exclusive").unwrap_or(false),
        // The variables of a process cannot change.
        shared: cases.shared && !own_domain,
        own_domain,
        ..inherited_settings(reader, node, defaults.settings)
    };
    let slots = episode_test::read(reader, node);
    let settings = if slots.is_some() { episode_test::settings(settings) } else { settings };
    Some(DeclaredTest {
        span: ElementReader::tag(node),
        name: reader.word(node, "name"),
        was: reader.word(node, "was").map(|was| was.value),
        limits: DeclaredLimits { case: cases.timeout, ..limits },
        settings,
        slots,
        cases: cases.declared.map(Box::new),
        tags: values(reader.words(node, "tags")),
        env: env::read(reader, node),
        learn: learn::read(reader, node),
        monitors: monitor::read_all(reader, node),
        faults: fault::read_all(reader, node),
        known_failure: known_failure::read(reader, node).map(Box::new),
        matrix: matrix::read(reader, node).map(Box::new),
        plugin: plugin(reader, node)?,
        combination: None,
    })
}

/// The attributes about processes and cases. Most tests have none of them.
const CASE_ATTRIBUTES: [&str; 4] = ["cases", "case-timeout", "isolation", "fork"];

/// The values of [`CASE_ATTRIBUTES`].
#[derive(Default)]
struct CaseAttributes {
    timeout: Option<Duration>,
    shared: bool,
    declared: Option<DeclaredCases>,
}

impl CaseAttributes {
    fn read(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Self {
        let timeout = reader.duration(node, "case-timeout");
        let isolation = isolation(reader, node);
        let shared = isolation == Some(TestIsolation::Shared);
        Self { timeout, shared, declared: cases(reader, node, isolation) }
    }
}

fn isolation(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<TestIsolation> {
    let words = [
        ("process", None),
        ("shared", Some(TestIsolation::Shared)),
        ("case", Some(TestIsolation::Case)),
    ];
    reader.choice(node, "isolation", &words).flatten()
}

/// Reads the attributes whose meaning depends on the type of the test.
fn cases(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    isolation: Option<TestIsolation>,
) -> Option<DeclaredCases> {
    let patterns = reader.word(node, "cases");
    if let Some(patterns) = &patterns {
        warn_of_open_quote(reader, "cases", patterns, "the last pattern reaches to the end");
    }
    let position = |name| node.attribute_node(name).map(|it| Span::new(it.range_value()));
    let case_timeout = position("case-timeout");
    // Only a test with a `type` can be one of another framework.
    let isolation = isolation
        .filter(|isolation| *isolation == TestIsolation::Case || node.has_attribute("type"))
        .zip(position("isolation"))
        .map(|(isolation, span)| Spanned::new(isolation, span));
    let fork =
        reader.choice(node, "fork", &[("start", ForkPoint::Start), ("main", ForkPoint::Main)]);
    let fork = fork.zip(position("fork")).map(|(point, span)| Spanned::new(point, span));
    let is_empty =
        patterns.is_none() && case_timeout.is_none() && isolation.is_none() && fork.is_none();
    (!is_empty).then_some(DeclaredCases { patterns, case_timeout, isolation, fork })
}

/// Reads the limits of tests; on `<suite>` their attributes have the prefix `test-`.
pub(super) fn limits(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    prefix: &str,
) -> DeclaredLimits {
    let mut get = |name: &str| {
        if prefix.is_empty() {
            reader.duration(node, name)
        } else {
            reader.duration(node, &format!("{prefix}{name}"))
        }
    };
    DeclaredLimits {
        load: get("load-timeout"),
        setup: get("setup-timeout"),
        run: get("timeout"),
        teardown: get("teardown-timeout"),
        slow: get("slow"),
        grace: get("grace"),
        case: None,
    }
}

/// Reads the settings that both `<suite>` and `<test>` can have.
pub(super) fn inherited_settings(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    default: TestSettings,
) -> TestSettings {
    let reactions = [
        ("rerun", AfterCollapse::Rerun),
        ("fail", AfterCollapse::Fail),
        ("skip", AfterCollapse::Skip),
    ];
    let after_collapse = reader.choice(node, "after-collapse", &reactions);
    let leaks = reader.choice(node, "leaks", &[("report", Leaks::Report), ("fail", Leaks::Fail)]);
    let retries = Retries {
        count: reader.number(node, "retries", 0).unwrap_or(default.retries.count),
        delay: reader.duration(node, "retry-delay").unwrap_or(default.retries.delay),
    };
    TestSettings {
        after_collapse: after_collapse.unwrap_or(default.after_collapse),
        leaks: leaks.unwrap_or(default.leaks),
        retries,
        ..default
    }
}

/// Reads the plug-in of a test, a fixture or a hook.
pub(super) fn plugin(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<DeclaredPlugin> {
    let plugin_type = reader.word(node, "type");
    let param = reader.attribute(node, "param");
    if let Some(param) = &param {
        reference::check(reader, "param", param);
        warn_of_open_quote(reader, "param", param, "the last argument reaches to the end");
    }
    let Some(name) = reader.text(node) else {
        reader.missing(node, "the name of a plug-in as its text");
        return None;
    };
    let param = param.map(|param| param.value).unwrap_or_default();
    Some(DeclaredPlugin { name, plugin_type, param })
}

fn warn_of_open_quote(
    reader: &mut ElementReader<'_>,
    name: &str,
    value: &Spanned<String>,
    effect: &str,
) {
    if value.value.bytes().filter(|byte| *byte == b'"').count() % 2 == 1 {
        let message = format!("a quote in `{name}` is never closed");
        let label = reader.source.label(value.span, effect);
        reader.report(Diagnostic::warning("open-quote", message).label(label));
    }
}

/// Returns the texts without their positions.
pub(super) fn values(words: Vec<Spanned<String>>) -> Vec<String> {
    words.into_iter().map(|word| word.value).collect()
}
