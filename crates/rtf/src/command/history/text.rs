//! Text for people: verdicts in one line, sparklines, numbers.

use std::collections::BTreeSet;
use std::time::Duration;

use rtf_history::answers::{RunCounts, SeriesPoint, TestResult};
use rtf_model::{Verdict, format_rounded};
use rtf_report::{escape, format_duration};

/// How many of the newest runs a strip or a sparkline shows.
pub const WIDTH: usize = 60;

const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// The name of a test, made harmless.
pub fn name(identity: &impl std::fmt::Display) -> String {
    escape::line(&identity.to_string()).into_owned()
}

/// A time in seconds.
pub fn seconds(seconds: f64) -> String {
    format_duration(Duration::try_from_secs_f64(seconds).unwrap_or_default())
}

pub fn number(value: f64, unit: &str) -> String {
    let number = format_rounded(value);
    if unit.is_empty() { number } else { format!("{number} {}", escape::line(unit)) }
}

pub fn percent(rate: f64) -> String {
    format!("{:.0} %", rate * 100.0)
}

/// `12 passed, 1 failed`.
pub fn counts(counts: &RunCounts) -> String {
    let parts: Vec<_> =
        counts.present().map(|(verdict, count)| format!("{count} {verdict}")).collect();
    if parts.is_empty() { "no tests".to_owned() } else { parts.join(", ") }
}

/// The first digits of a commit; `*` marks uncommitted changes.
pub fn commit(commit: Option<&str>, dirty: Option<bool>) -> String {
    let Some(commit) = commit else { return String::new() };
    let short = commit.get(..8).unwrap_or(commit);
    format!("{}{}", escape::line(short), if dirty == Some(true) { "*" } else { "" })
}

/// The verdict, or `flaky` for a pass after a failure.
pub fn word(result: &TestResult) -> &'static str {
    match result.verdict {
        Verdict::Passed if result.flaky => "flaky",
        verdict => verdict.as_str(),
    }
}

/// The sign of a result in a strip.
fn sign(verdict: Verdict, is_flaky: bool) -> char {
    match verdict {
        Verdict::Passed if is_flaky => 'f',
        Verdict::Passed => '.',
        Verdict::Failed => 'F',
        Verdict::Error => 'E',
        Verdict::Crashed => 'X',
        Verdict::TimedOut => 'T',
        Verdict::Collapsed => 'C',
        Verdict::Skipped => 's',
        Verdict::Interrupted => 'i',
    }
}

/// A sign for each of the newest results, the oldest first, and the meaning of each sign.
pub fn strip(results: &[TestResult]) -> (String, String) {
    let shown = &results[results.len().saturating_sub(WIDTH)..];
    let strip = shown.iter().map(|result| sign(result.verdict, result.flaky)).collect();
    let meaning =
        |result: &TestResult| format!("{} {}", sign(result.verdict, result.flaky), word(result));
    let meanings: BTreeSet<String> = shown.iter().map(meaning).collect();
    (strip, meanings.into_iter().collect::<Vec<_>>().join(", "))
}

/// The newest numbers as bars; `·` where there is none.
pub fn sparkline(values: &[Option<f64>]) -> String {
    let shown = &values[values.len().saturating_sub(WIDTH)..];
    let finite = || shown.iter().flatten().copied();
    let (low, high) = (finite().fold(f64::MAX, f64::min), finite().fold(f64::MIN, f64::max));
    // Half of each: the difference of the largest numbers is infinite.
    let span = high / 2.0 - low / 2.0;
    let bar = |value: f64| {
        let share = if span > 0.0 { (value / 2.0 - low / 2.0) / span } else { 0.0 };
        BARS[((share * 8.0) as usize).min(7)]
    };
    shown.iter().map(|value| value.map_or('·', bar)).collect()
}

/// `1.2 ms … 3 ms, last 2 ms, limits ≤ 5 ms, 1 of 30 not finite`.
pub fn series(points: &[SeriesPoint], unit: &str) -> String {
    let values = || points.iter().filter_map(|point| point.value);
    let Some(last) = values().next_back() else { return "no finite number".to_owned() };
    let (low, high) = (values().fold(last, f64::min), values().fold(last, f64::max));
    let mut text = match low < high {
        true => {
            format!("{} … {}, last {}", number(low, unit), number(high, unit), number(last, unit))
        }
        false => number(last, unit),
    };
    if let Some(point) = points.last() {
        text += &match (point.low, point.high) {
            (Some(low), Some(high)) => {
                format!(", limits {} … {}", number(low, unit), number(high, unit))
            }
            (Some(low), None) => format!(", limit ≥ {}", number(low, unit)),
            (None, Some(high)) => format!(", limit ≤ {}", number(high, unit)),
            (None, None) => String::new(),
        };
    }
    let (count, not_finite) = points.iter().fold((0, 0), |(count, not_finite), point| {
        (count + point.count, not_finite + point.not_finite)
    });
    if not_finite > 0 {
        text += &format!(", {not_finite} of {count} not finite");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sparkline_has_a_bar_for_each_number() {
        assert_eq!(sparkline(&[]), "");
        assert_eq!(sparkline(&[Some(1.0), None, Some(1.0)]), "▁·▁");
        assert_eq!(sparkline(&[Some(0.0), Some(0.5), Some(1.0)]), "▁▅█");
        assert_eq!(sparkline(&[Some(f64::MIN), Some(0.0), Some(f64::MAX)]), "▁▅█");
        assert_eq!(sparkline(&[None, None]), "··");
    }
}
