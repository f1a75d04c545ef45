//! `<learn>`: limits of measurements that are learned from earlier runs.

use jiff::Timestamp;
use jiff::tz::TimeZone;
use roxmltree::Node;

use super::known_failure::parse_day;
use super::reader::ElementReader;
use super::schema::{self, check};
use super::{LearnPlan, LearnedSides};

/// The fewest runs by default.
const MIN_RUNS: u32 = 10;

/// Fewer runs say nothing about how much a measurement varies.
const FEWEST_RUNS: u32 = 3;

/// The distance of the limits from the median by default.
const SIGMA: f64 = 4.0;

const MAX_SIGMA: f64 = 1000.0;

/// Reads the `<learn>` elements of a test.
pub(super) fn read(reader: &mut ElementReader<'_>, test: Node<'_, '_>) -> Vec<LearnPlan> {
    let mut found: Vec<LearnPlan> = Vec::new();
    for node in test.children().filter(|node| node.has_tag_name("learn")) {
        check(reader, node, &schema::LEARN);
        let Some(learn) = element(reader, node) else { continue };
        if found.iter().any(|known| known.measurement == learn.measurement) {
            let message = format!("a second `<learn>` for `{}`", learn.measurement);
            reader.report(reader.error("duplicate", learn.span, message));
            continue;
        }
        found.push(learn);
    }
    found
}

fn element(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<LearnPlan> {
    if !node.has_attribute("measurement") {
        reader.missing(node, "the attribute `measurement`");
        return None;
    }
    let sides =
        [("low", LearnedSides::Low), ("high", LearnedSides::High), ("both", LearnedSides::Both)];
    let hint = "write it like `2027-01-31` or `2027-01-31T12:00:00Z`";
    let since = reader.parsed(node, "since", parse_since, ("is not a time", Some(hint)));
    Some(LearnPlan {
        span: ElementReader::tag(node),
        measurement: reader.word(node, "measurement")?.value,
        min_runs: reader.number(node, "min-runs", FEWEST_RUNS).unwrap_or(MIN_RUNS),
        sigma: sigma(reader, node),
        limits: reader.choice(node, "limits", &sides).unwrap_or(LearnedSides::Both),
        since,
    })
}

/// A time with its zone, or a day, which starts at midnight UTC: it is the same on all machines.
fn parse_since(text: &str) -> Option<Timestamp> {
    let day = parse_day(text).and_then(|day| day.to_zoned(TimeZone::UTC).ok());
    day.map(|day| day.timestamp()).or_else(|| text.parse().ok())
}

fn sigma(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> f64 {
    let hint = format!("a number above 0, at most {MAX_SIGMA}");
    let parse = |text: &str| text.parse().ok().filter(|it| *it > 0.0 && *it <= MAX_SIGMA);
    let expected = ("is not a number of deviations", Some(hint.as_str()));
    reader.parsed(node, "sigma", parse, expected).unwrap_or(SIGMA)
}
