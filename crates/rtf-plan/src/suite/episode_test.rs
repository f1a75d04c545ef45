//! Tests with `slots`, which run many episodes of a campaign in one process.

use std::time::Duration;

use roxmltree::Node;
use rtf_model::Diagnostic;
use rtf_model::protocol::EpisodeSlots;

use super::reader::ElementReader;
use super::{AfterCollapse, DeclaredSuite, Retries, Spanned, TestSettings};

/// The most episodes that a test runs at the same time.
const MOST_SLOTS: u32 = 4096;

/// What such a test cannot have, and why.
const EXCLUDED: [(&str, &str); 9] = [
    ("cases", "each episode is one of its cases"),
    ("repetition", "a campaign has more episodes instead"),
    ("retries", "a campaign repeats episodes without a result"),
    ("after-collapse", "a campaign repeats episodes without a result"),
    ("isolation", "it keeps its process for all episodes"),
    ("fork", "it keeps its process for all episodes"),
    ("expect", "the claim of the campaign says which rate is expected"),
    ("slow", "its `run` lasts as long as there are episodes"),
    ("exclusive", "it is the only test of its suite"),
];

/// What it cannot contain, and why.
const EXCLUDED_ELEMENTS: [(&str, &str); 2] = [
    ("matrix", "the parameters of a campaign have this effect"),
    ("learn", "limits are learned for measurements outside of cases"),
];

/// Reads `slots` and the limits of an episode.
pub(super) fn read(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
) -> Option<Spanned<EpisodeSlots>> {
    let max_steps = reader.number(node, "max-steps", 1).map(u64::from);
    let max_time = reader.duration(node, "max-time");
    let Some(span) = ElementReader::name_span(node, "slots") else {
        for name in ["max-steps", "max-time"] {
            exclude(reader, node, name, "only a test with `slots` has it");
        }
        return None;
    };
    let slots = reader.number_in(node, "slots", 1..=MOST_SLOTS);
    for (name, why) in EXCLUDED {
        exclude(reader, node, name, why);
    }
    for (name, why) in EXCLUDED_ELEMENTS {
        if let Some(child) = node.children().find(|child| child.has_tag_name(name)) {
            let message = format!("a test with `slots` cannot contain `<{name}>`: {why}");
            reader.report(reader.error("not-in-episode-test", ElementReader::tag(child), message));
        }
    }
    let (slots, max_time_us) = (slots?, max_time.map(microseconds));
    Some(Spanned::new(EpisodeSlots { slots, max_steps, max_time_us }, span))
}

fn exclude(reader: &mut ElementReader<'_>, node: Node<'_, '_>, name: &str, why: &str) {
    if let Some(span) = ElementReader::name_span(node, name) {
        let with = if node.has_attribute("slots") { "with" } else { "without" };
        let message = format!("a test {with} `slots` cannot have `{name}`: {why}");
        reader.report(reader.error("not-in-episode-test", span, message));
    }
}

/// A limit, which is not zero.
fn microseconds(limit: Duration) -> u64 {
    u64::try_from(limit.as_micros()).unwrap_or(u64::MAX).max(1)
}

/// Its settings: what its suite declares for tests in general has no effect on it.
pub(super) fn settings(settings: TestSettings) -> TestSettings {
    TestSettings {
        retries: Retries::default(),
        after_collapse: AfterCollapse::default(),
        ..settings
    }
}

/// Reports what a suite with such a test cannot have.
pub(super) fn check(reader: &mut ElementReader<'_>, suite: &DeclaredSuite) {
    let Some(slots) = suite.tests.iter().find_map(|test| test.slots.as_ref()) else { return };
    let source = reader.source;
    let mut problems = Vec::new();
    if let Some(test) = suite.tests.iter().find(|test| test.slots.is_none()) {
        let message = "a test with `slots` is the only one of its suite";
        let hint = "give the other tests a suite of their own";
        problems.push(source.error("not-the-only-test", test.span, message).hint(hint));
    }
    if suite.tests.iter().filter(|test| test.slots.is_some()).count() > 1 {
        let message = "a suite has at most one test with `slots`";
        problems.push(Diagnostic::error("not-the-only-test", message));
    }
    if let Some(clock) = &suite.clock {
        let message = "a suite with a simulated clock has no test with `slots`";
        let hint = "`max-time` limits an episode in simulated time";
        problems.push(source.error("not-in-episode-test", clock.span, message).hint(hint));
    }
    if suite.settings.timeout.is_some() {
        let message = "the suite of a test with `slots` cannot have `timeout`";
        let hint = "`timeout` of the test is the limit of each episode";
        problems.push(Diagnostic::error("not-in-episode-test", message).hint(hint));
    }
    for problem in problems {
        reader.report(problem.label(source.label(slots.span, "this test runs many episodes")));
    }
}
