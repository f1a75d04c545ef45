//! `<test>`.

use roxmltree::Node;
use rtf_model::Diagnostic;

use super::shape::{self, check};
use super::value::Reader;
use super::{AfterCollapse, Leaks, Plugin, Retries, Spanned, Test, WrittenLimits, env, port};

/// What the suite says for all of its tests.
#[derive(Clone, Copy, Default)]
pub(super) struct Defaults {
    /// Its limits.
    pub limits: WrittenLimits,
    /// Its `after-collapse`.
    pub after_collapse: AfterCollapse,
    /// Its `leaks`.
    pub leaks: Leaks,
    /// Its `retries` and `retry-delay`.
    pub retries: Retries,
}

/// Reads a `<test>`; `None` when it names no plug-in.
pub(super) fn read(
    reader: &mut Reader<'_>,
    node: Node<'_, '_>,
    defaults: Defaults,
) -> Option<Test> {
    check(reader, node, &shape::TEST);
    let name = reader.word(node, "name");
    let own = limits(reader, node, "");
    let given = defaults.limits;
    let limits = WrittenLimits {
        load: own.load.or(given.load),
        setup: own.setup.or(given.setup),
        run: own.run.or(given.run),
        teardown: own.teardown.or(given.teardown),
        slow: own.slow.or(given.slow),
        grace: own.grace.or(given.grace),
    };
    let shared = isolation(reader, node);
    let repetitions = reader.number(node, "repetition", 1).unwrap_or(1);
    let after_collapse = after_collapse(reader, node).unwrap_or(defaults.after_collapse);
    let leaks = leaks(reader, node).unwrap_or(defaults.leaks);
    let retries = retries(reader, node, defaults.retries);
    let critical = reader.truth(node, "critical").unwrap_or(false);
    let exclusive = reader.truth(node, "exclusive").unwrap_or(false);
    let tags = values(reader.words(node, "tags"));
    let env = env::read(reader, node);
    let plugin = plugin(reader, node)?;
    let span = Reader::tag(node);
    Some(Test {
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

/// The limits of tests: on `<test>` as they are, on `<suite>` with `test-` before.
pub(super) fn limits(reader: &mut Reader<'_>, node: Node<'_, '_>, prefix: &str) -> WrittenLimits {
    let mut get = |name: &str| {
        if prefix.is_empty() {
            reader.duration(node, name)
        } else {
            reader.duration(node, &format!("{prefix}{name}"))
        }
    };
    WrittenLimits {
        load: get("load-timeout"),
        setup: get("setup-timeout"),
        run: get("timeout"),
        teardown: get("teardown-timeout"),
        slow: get("slow"),
        grace: get("grace"),
    }
}

/// The attribute of `<suite>` and of `<test>`.
pub(super) fn after_collapse(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Option<AfterCollapse> {
    let words = [
        ("rerun", AfterCollapse::Rerun),
        ("fail", AfterCollapse::Fail),
        ("skip", AfterCollapse::Skip),
    ];
    reader.choice(node, "after-collapse", &words)
}

/// The attribute of `<suite>` and of `<test>`.
pub(super) fn leaks(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Option<Leaks> {
    reader.choice(node, "leaks", &[("report", Leaks::Report), ("fail", Leaks::Fail)])
}

/// The attributes of `<suite>` and of `<test>`.
pub(super) fn retries(reader: &mut Reader<'_>, node: Node<'_, '_>, given: Retries) -> Retries {
    Retries {
        count: reader.number(node, "retries", 0).unwrap_or(given.count),
        delay: reader.duration(node, "retry-delay").unwrap_or(given.delay),
    }
}

/// The plug-in of a test, a fixture or a hook.
pub(super) fn plugin(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Option<Plugin> {
    let plugin_type = reader.word(node, "type");
    let param = reader.attribute(node, "param");
    if let Some(param) = &param {
        port::check(reader, "param", param);
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
    Some(Plugin { name, plugin_type, param })
}

/// The texts without their places.
pub(super) fn values(words: Vec<Spanned<String>>) -> Vec<String> {
    words.into_iter().map(|word| word.value).collect()
}

/// Whether its host may have served other tests before, and may after it.
fn isolation(reader: &mut Reader<'_>, node: Node<'_, '_>) -> bool {
    let words = [("process", false), ("shared", true)];
    reader.choice(node, "isolation", &words).unwrap_or(false)
}
