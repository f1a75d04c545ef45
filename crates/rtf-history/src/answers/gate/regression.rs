//! Measurements that are worse than in the baseline.

use std::collections::HashSet;
use std::str::FromStr;

use rtf_model::Verdict;
use serde::Serialize;

use super::{Compared, MIN_BASELINE_RUNS};
use crate::TestIdentity;
use crate::answers::{TestHistory, TestSeries};
use crate::entry::SeriesName;
use crate::statistics::robust::median;

/// Which change of a measurement is worse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// A larger value.
    Higher,
    /// A smaller value.
    Lower,
    /// Any other value.
    Any,
}

/// How much worse a measurement may be.
#[derive(Clone, Debug, PartialEq)]
pub struct RegressionLimit {
    /// The name of the measurement or signal.
    pub name: String,
    /// Which change is worse; `None`: as its limits say.
    pub direction: Option<Direction>,
    /// The largest change, as a share of the baseline's median.
    pub max: f64,
}

impl FromStr for RegressionLimit {
    type Err = String;

    /// Parses `lag>10%`, `lag>+10%` or `lag>-10%`.
    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || {
            format!(
                "expected a measurement and a change such as `lag>10%`, `lag>+10%` (only a rise) \
                 or `lag>-10%` (only a fall), got `{text}`"
            )
        };
        let (name, change) = text.rsplit_once('>').ok_or_else(expected)?;
        let (name, change) = (name.trim(), change.trim());
        let number = change.strip_suffix('%').ok_or_else(expected)?.trim_end();
        let (direction, number) = match number.as_bytes().first() {
            Some(b'+') => (Some(Direction::Higher), &number[1..]),
            Some(b'-') => (Some(Direction::Lower), &number[1..]),
            _ => (None, number),
        };
        let percent = parse_percent(number).filter(|_| !name.is_empty()).ok_or_else(expected)?;
        Ok(Self { name: name.to_owned(), direction, max: percent / 100.0 })
    }
}

/// Parses a number that is not negative.
fn parse_percent(text: &str) -> Option<f64> {
    let is_number = text.starts_with(|c: char| c.is_ascii_digit() || c == '.');
    let percent = text.parse::<f64>().ok().filter(|percent| percent.is_finite())?;
    is_number.then_some(percent)
}

/// The gate for a measurement or signal.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RegressionGate {
    /// Whether the run passes it.
    pub passed: bool,
    /// The name of the measurement or signal.
    pub name: String,
    /// The largest change, as a share of the baseline's median.
    pub max: f64,
    /// Its series in the tests of the run, regressions first.
    pub series: Vec<JudgedSeries>,
    /// Those that cannot be compared.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_judged: Vec<NotJudged>,
}

/// A measurement of a test, compared with the baseline.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JudgedSeries {
    /// The test or case.
    #[serde(flatten)]
    pub identity: TestIdentity,
    /// The name and the unit.
    #[serde(flatten)]
    pub series: SeriesName,
    /// Whether it is worse by more than the gate allows.
    pub regression: bool,
    /// The value in the run.
    pub value: f64,
    /// The median of the baseline.
    pub baseline: f64,
    /// Number of baseline runs.
    pub baseline_runs: usize,
    /// The change as a share of the baseline's median; `None` if that is 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub change: Option<f64>,
    /// Which change is worse.
    pub worse: Direction,
}

/// A measurement of a test that cannot be compared.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NotJudged {
    /// The test or case.
    #[serde(flatten)]
    pub identity: TestIdentity,
    /// The name and the unit.
    #[serde(flatten)]
    pub series: SeriesName,
    /// Why not.
    #[serde(flatten)]
    pub reason: NotJudgedReason,
}

/// Why a measurement cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "reason")]
pub enum NotJudgedReason {
    /// Too few runs of the baseline have it.
    FewRuns {
        /// How many runs.
        baseline_runs: usize,
    },
    /// The run has no finite value.
    NotFinite,
    /// The baseline has it, but not the run.
    NotMeasured,
}

impl Compared {
    pub(super) fn regressions(&self, limit: &RegressionLimit) -> RegressionGate {
        let (mut series, mut not_judged) = (Vec::new(), Vec::new());
        for test in &self.run {
            let baseline = self.baseline.get(&test.identity);
            let found: Vec<_> =
                test.series.iter().filter(|series| series.series.name == limit.name).collect();
            for one in &found {
                match judge(limit, test, one, baseline) {
                    Ok(judged) => series.push(judged),
                    Err(reason) => not_judged.push(NotJudged::new(test, one, reason)),
                }
            }
            let missing = baseline.iter().flat_map(|test| &test.series).filter(|series| {
                series.series.name == limit.name
                    && !found.iter().any(|one| one.series == series.series)
            });
            let reason = NotJudgedReason::NotMeasured;
            not_judged.extend(missing.map(|series| NotJudged::new(test, series, reason)));
        }
        series.sort_by_key(|series| !series.regression);
        let passed = series.iter().all(|series| !series.regression);
        RegressionGate { passed, name: limit.name.clone(), max: limit.max, series, not_judged }
    }
}

impl NotJudged {
    fn new(test: &TestHistory, series: &TestSeries, reason: NotJudgedReason) -> Self {
        Self { identity: test.identity.clone(), series: series.series.clone(), reason }
    }
}

fn judge(
    limit: &RegressionLimit,
    test: &TestHistory,
    series: &TestSeries,
    baseline: Option<&TestHistory>,
) -> Result<JudgedSeries, NotJudgedReason> {
    let point = series.points.last().ok_or(NotJudgedReason::NotMeasured)?;
    let value = point.value.ok_or(NotJudgedReason::NotFinite)?;
    let robot = test.results.last().map_or("", |result| &result.robot);
    let values = baseline.map_or_else(Vec::new, |test| green_values(test, &series.series, robot));
    let too_few = NotJudgedReason::FewRuns { baseline_runs: values.len() };
    let baseline = median(&values).filter(|_| values.len() >= MIN_BASELINE_RUNS).ok_or(too_few)?;
    let worse = limit.direction.unwrap_or_else(|| worse_direction(point.low, point.high));
    let allowed = limit.max * baseline.abs();
    let (rise, fall) = (value - baseline > allowed, baseline - value > allowed);
    Ok(JudgedSeries {
        identity: test.identity.clone(),
        series: series.series.clone(),
        regression: match worse {
            Direction::Higher => rise,
            Direction::Lower => fall,
            Direction::Any => rise || fall,
        },
        value,
        baseline,
        baseline_runs: values.len(),
        change: Some((value - baseline) / baseline.abs()).filter(|change| change.is_finite()),
        worse,
    })
}

/// With one limit, the direction towards it; otherwise any.
fn worse_direction(low: Option<f64>, high: Option<f64>) -> Direction {
    match (low, high) {
        (None, Some(_)) => Direction::Higher,
        (Some(_), None) => Direction::Lower,
        _ => Direction::Any,
    }
}

/// The values of a series in the runs in which its test passed on this robot.
fn green_values(test: &TestHistory, series: &SeriesName, robot: &str) -> Vec<f64> {
    let is_green = |verdict| verdict == Verdict::Passed;
    let green = test.results.iter().filter(|it| is_green(it.verdict) && it.robot == robot);
    let green: HashSet<&str> = green.map(|result| result.run.as_str()).collect();
    let points = test.series.iter().filter(|it| it.series == *series).flat_map(|it| &it.points);
    points.filter(|it| green.contains(it.run.as_str())).filter_map(|it| it.value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Option<(String, Option<Direction>, f64)> {
        let limit = text.parse::<RegressionLimit>().ok()?;
        Some((limit.name, limit.direction, limit.max))
    }

    #[test]
    fn worse_is_towards_the_only_limit() {
        assert_eq!(worse_direction(None, Some(1.0)), Direction::Higher);
        assert_eq!(worse_direction(Some(1.0), None), Direction::Lower);
        assert_eq!(worse_direction(Some(1.0), Some(2.0)), Direction::Any);
        assert_eq!(worse_direction(None, None), Direction::Any);
    }

    #[test]
    fn limits_of_changes() {
        let named = |name: &str, direction, max| Some((name.to_owned(), direction, max));
        assert_eq!(parsed("lag>10%"), named("lag", None, 0.1));
        assert_eq!(parsed("peak lag > +2.5 %"), named("peak lag", Some(Direction::Higher), 0.025));
        assert_eq!(parsed("a>b>-0%"), named("a>b", Some(Direction::Lower), 0.0));
        for wrong in
            ["lag", "lag>10", ">10%", "lag>%", "lag>nan%", "lag>inf%", "lag>--1%", "lag<1%"]
        {
            assert_eq!(parsed(wrong), None, "{wrong}");
        }
    }
}
