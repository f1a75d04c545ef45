//! `<test>`.

use roxmltree::Node;
use rtf_model::Diagnostic;

use super::reader::ElementReader;
use super::schema::{self, check};
use super::{
    AfterCollapse, DeclaredLimits, DeclaredPlugin, DeclaredTest, Leaks, Retries, Spanned, env,
    port_reference,
};

/// The defaults that a suite declares for its tests.
#[derive(Clone, Copy, Default)]
pub(super) struct TestDefaults {
    /// The limits.
    pub limits: DeclaredLimits,
    /// `after-collapse`.
    pub after_collapse: AfterCollapse,
    /// `leaks`.
    pub leaks: Leaks,
    /// `retries` and `retry-delay`.
    pub retries: Retries,
}

/// Reads a `<test>`; `None` if it names no plug-in.
pub(super) fn read(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    defaults: TestDefaults,
) -> Option<DeclaredTest> {
    check(reader, node, &schema::TEST);
    let name = reader.word(node, "name");
    let (declared, default) = (limits(reader, node, ""), defaults.limits);
    let limits = DeclaredLimits {
        load: declared.load.or(default.load),
        setup: declared.setup.or(default.setup),
        run: declared.run.or(default.run),
        teardown: declared.teardown.or(default.teardown),
        slow: declared.slow.or(default.slow),
        grace: declared.grace.or(default.grace),
    };
    let shared = is_shared(reader, node);
    let repetitions = reader.number(node, "repetition", 1).unwrap_or(1);
    let after_collapse = after_collapse(reader, node).unwrap_or(defaults.after_collapse);
    let leaks = leaks(reader, node).unwrap_or(defaults.leaks);
    let retries = retries(reader, node, defaults.retries);
    let critical = reader.boolean(node, "critical").unwrap_or(false);
    let exclusive = reader.boolean(node, "exclusive").unwrap_or(false);
    let tags = values(reader.words(node, "tags"));
    let env = env::read(reader, node);
    let plugin = plugin(reader, node)?;
    let span = ElementReader::tag(node);
    Some(DeclaredTest {
        span,
        name,
        plugin,
        repetitions,
        limits,
        after_collapse,
        leaks,
        retries,
        critical,
        exclusive,
        shared,
        tags,
        env,
    })
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
    }
}

/// Reads `after-collapse` of `<suite>` or `<test>`.
pub(super) fn after_collapse(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
) -> Option<AfterCollapse> {
    let words = [
        ("rerun", AfterCollapse::Rerun),
        ("fail", AfterCollapse::Fail),
        ("skip", AfterCollapse::Skip),
    ];
    reader.choice(node, "after-collapse", &words)
}

/// Reads `leaks` of `<suite>` or `<test>`.
pub(super) fn leaks(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<Leaks> {
    reader.choice(node, "leaks", &[("report", Leaks::Report), ("fail", Leaks::Fail)])
}

/// Reads `retries` and `retry-delay` of `<suite>` or `<test>`.
pub(super) fn retries(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    default: Retries,
) -> Retries {
    Retries {
        count: reader.number(node, "retries", 0).unwrap_or(default.count),
        delay: reader.duration(node, "retry-delay").unwrap_or(default.delay),
    }
}

/// Reads the plug-in of a test, a fixture or a hook.
pub(super) fn plugin(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<DeclaredPlugin> {
    let plugin_type = reader.word(node, "type");
    let param = reader.attribute(node, "param");
    if let Some(param) = &param {
        port_reference::check(reader, "param", param);
    }
    if let Some(param) = &param
        && param.value.bytes().filter(|byte| *byte == b'"').count() % 2 == 1
    {
        let problem = Diagnostic::warning("open-quote", "a quote in `param` is never closed")
            .label(reader.source.label(param.span, "the last argument reaches to the end"));
        reader.report(problem);
    }
    let Some(name) = reader.text(node) else {
        reader.missing(node, "the name of a plug-in as its text");
        return None;
    };
    let param = param.map(|param| param.value).unwrap_or_default();
    Some(DeclaredPlugin { name, plugin_type, param })
}

/// Returns the texts without their positions.
pub(super) fn values(words: Vec<Spanned<String>>) -> Vec<String> {
    words.into_iter().map(|word| word.value).collect()
}

/// Reads whether the test may share a host with other tests.
fn is_shared(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> bool {
    let words = [("process", false), ("shared", true)];
    reader.choice(node, "isolation", &words).unwrap_or(false)
}
