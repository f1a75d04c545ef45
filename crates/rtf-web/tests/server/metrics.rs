//! Metrics of the history, behind an option.

use rtf_model::Verdict;

use crate::client::ask;
use crate::history::import;
use crate::world::{World, settings};

fn value(text: &str, name: &str) -> Option<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' '));
    line.and_then(|value| value.parse().ok())
}

#[test]
fn the_history_is_shown_as_metrics() {
    let (world, _run) = World::showing();
    for day in 1..=5 {
        let verdict = if day == 4 { Verdict::Failed } else { Verdict::Passed };
        import(&world, day, "main", verdict, 0.5);
    }
    let answer = world.get("/metrics");
    assert_eq!(answer.status, 200, "{}", answer.text());
    let kind = answer.header("content-type").unwrap_or_default();
    assert!(kind.starts_with("application/openmetrics-text; version=1.0.0"), "{kind}");
    let text = answer.text();
    for (name, expected) in [
        ("rtf_history_readable", 1.0),
        ("rtf_runs{result=\"green\"}", 4.0),
        ("rtf_runs{result=\"red\"}", 1.0),
        ("rtf_results{verdict=\"passed\"}", 9.0),
        ("rtf_results{verdict=\"failed\"}", 1.0),
        ("rtf_last_run_green", 1.0),
        ("rtf_last_run_start_time_seconds", 1_793_860_212.0),
        ("rtf_last_run_tests{verdict=\"passed\"}", 2.0),
        ("rtf_recent_runs", 5.0),
        ("rtf_recent_flaky_tests", 1.0),
        ("rtf_recent_flaky_ratio", 0.5),
    ] {
        assert_eq!(value(&text, name), Some(expected), "{name} in\n{text}");
    }
    assert!(text.ends_with("# EOF\n"), "{text}");
    assert!(!text.contains("steady"), "no metric names a test: {text}");
}

#[test]
fn a_history_that_cannot_be_read_is_a_metric() {
    let (world, _run) = World::showing();
    let text = world.get("/metrics").text();
    assert_eq!(value(&text, "rtf_history_readable"), Some(0.0), "{text}");
    assert_eq!(value(&text, "rtf_recent_runs"), None, "{text}");
}

#[test]
fn without_the_option_there_are_no_metrics() {
    let (world, _run) = World::with(&settings());
    let answer = world.get("/metrics");
    assert_eq!(answer.status, 404);
    assert!(answer.text().contains("--web-metrics"), "{}", answer.text());
    let foreign = ask(world.address(), "GET /metrics", &["Host: robots.example.org"], "");
    assert_eq!(foreign.status, 421);
}
