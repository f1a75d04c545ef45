//! Limits of measurements that are learned from earlier runs.

use std::collections::HashMap;

use jiff::Timestamp;
use rtf_model::Verdict;

use super::{SeriesPoint, TestHistory, TestResult, TestSeries};
use crate::entry::NumberKind;
use crate::statistics::change_points::{Options, find_change_points};
use crate::statistics::learn_limits;
use crate::{RunSelection, Store, StoreError, TestIdentity};

/// The relative width of limits around values that do not vary at all: rounding errors.
const ROUNDING: f64 = 1e-9;

/// A measurement whose limits are learned.
#[derive(Clone, Debug)]
pub struct LearnQuery {
    /// The test.
    pub test: TestIdentity,
    /// The test under its former name, which it may still have in the history.
    pub former: Option<TestIdentity>,
    /// The exclusive resources of its suite, separated by spaces.
    pub robot: String,
    /// The name of the measurement.
    pub measurement: String,
    /// The fewest runs.
    pub min_runs: usize,
    /// The distance of the limits from the median, in robust standard deviations.
    pub sigma: f64,
    /// Runs before this time do not count.
    pub since: Option<Timestamp>,
}

/// What is learned about a measurement.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Learned {
    /// The unit of its newest value.
    pub unit: String,
    /// The smallest and the largest accepted value; `None` if there are too few runs.
    pub limits: Option<(f64, f64)>,
    /// Number of green runs from which they are learned.
    pub runs: usize,
    /// The first change after these runs that is not accepted.
    pub changed: Option<LearnedChange>,
}

/// A change of a measurement, after which its limits are no longer learned.
#[derive(Clone, Debug, PartialEq)]
pub struct LearnedChange {
    /// The name of the first run after it.
    pub run: String,
    /// When that run started.
    pub started: Timestamp,
}

impl Store {
    /// Learns the limits of measurements from the selected runs; returns what is learned in
    /// the order of the questions.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn learn(
        &self,
        runs: &RunSelection,
        queries: &[LearnQuery],
    ) -> Result<Vec<Learned>, StoreError> {
        let is_meant = |test: &crate::TestAttributes| {
            let names = |query: &LearnQuery| {
                query.test == test.identity || query.former.as_ref() == Some(&test.identity)
            };
            queries.iter().any(names)
        };
        let tests = self.test_histories(runs, &is_meant)?;
        let find = |name: &TestIdentity| tests.iter().find(|test| test.identity == *name);
        let learn = |query: &LearnQuery| {
            let test = find(&query.test).or_else(|| find(query.former.as_ref()?));
            test.and_then(|test| Learned::new(test, query)).unwrap_or_default()
        };
        Ok(queries.iter().map(learn).collect())
    }
}

impl Learned {
    fn new(test: &TestHistory, query: &LearnQuery) -> Option<Self> {
        let series = newest_series(test, &query.measurement)?;
        let points = judged_points(test, series, query);
        let values: Vec<f64> = points.iter().map(|point| point.value).collect();
        let change = find_change_points(&values, &Options::default()).points.into_iter().next();
        let (until, changed) = match &change {
            None => (values.len(), None),
            Some(change) => {
                let first = points[change.index].result;
                let (run, started) = (first.name.clone(), first.started);
                (change.index, Some(LearnedChange { run, started }))
            }
        };
        let before = points[..until].iter();
        let green = before.filter(|point| point.result.verdict == Verdict::Passed);
        let values: Vec<f64> = green.map(|point| point.value).collect();
        Some(Self {
            unit: series.series.unit.clone(),
            limits: limits(&values, query.sigma, query.min_runs),
            runs: values.len(),
            changed,
        })
    }
}

/// The series of a measurement in the unit of its newest value.
fn newest_series<'a>(test: &'a TestHistory, name: &str) -> Option<&'a TestSeries> {
    let is_meant = |series: &&TestSeries| {
        series.series.kind == NumberKind::Measurement && series.series.name == name
    };
    let newest = |series: &&TestSeries| series.points.last().map(|point| point.started);
    test.series.iter().filter(is_meant).max_by_key(newest)
}

/// A value, and the result of the test in its run.
struct JudgedPoint<'a> {
    value: f64,
    result: &'a TestResult,
}

/// The values of runs in which the test passed or failed on the robot. Failures are needed to
/// see a change: after it, the measurement fails the test.
fn judged_points<'a>(
    test: &'a TestHistory,
    series: &TestSeries,
    query: &LearnQuery,
) -> Vec<JudgedPoint<'a>> {
    let is_meant = |result: &&TestResult| {
        matches!(result.verdict, Verdict::Passed | Verdict::Failed)
            && result.robot == query.robot
            && query.since.is_none_or(|since| result.started >= since)
    };
    let results = test.results.iter().filter(is_meant);
    let results: HashMap<&str, &TestResult> =
        results.map(|result| (result.run.as_str(), result)).collect();
    let judged = |point: &SeriesPoint| {
        let result = results.get(point.run.as_str())?;
        Some(JudgedPoint { value: point.value?, result })
    };
    series.points.iter().filter_map(judged).collect()
}

/// Median ± `sigma` robust standard deviations. If most values are equal, their deviation is 0:
/// then the limits are as far from the median as the two nearest different values are from
/// each other, and at least so far that rounding errors do not matter.
fn limits(values: &[f64], sigma: f64, min_runs: usize) -> Option<(f64, f64)> {
    let learned = learn_limits(values, sigma, min_runs).ok()?;
    let mut width = sigma * learned.deviation;
    if width <= 0.0 {
        width = resolution(values);
    }
    let width = width.max(ROUNDING * learned.median.abs());
    Some((learned.median - width, learned.median + width))
        .filter(|(low, high)| low.is_finite() && high.is_finite())
}

/// The smallest distance between different values; 0 if all are equal.
fn resolution(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let distances = sorted.windows(2).map(|pair| pair[1] - pair[0]);
    distances.filter(|distance| *distance > 0.0).reduce(f64::min).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_median_and_deviation() {
        // scipy.stats.median_abs_deviation(x, scale="normal") of SciPy 1.17.1 is 5.930408874022408.
        let (low, high) = limits(&[1.0, 2.0, 4.0, 7.0, 11.0, 100.0], 4.0, 3).expect("enough");
        assert!((low - (5.5 - 4.0 * 5.930_408_874_022_408)).abs() < 1e-9, "{low}");
        assert!((high - (5.5 + 4.0 * 5.930_408_874_022_408)).abs() < 1e-9, "{high}");
        assert_eq!(limits(&[1.0, 2.0], 4.0, 3), None);
    }

    #[test]
    fn values_that_do_not_vary_have_narrow_limits() {
        assert_eq!(limits(&[2.0; 10], 4.0, 3), Some((2.0 - 2e-9, 2.0 + 2e-9)));
        assert_eq!(limits(&[0.0; 10], 4.0, 3), Some((0.0, 0.0)));
        let counts = [10.0, 10.0, 10.0, 10.0, 11.0, 13.0];
        assert_eq!(limits(&counts, 4.0, 3), Some((9.0, 11.0)), "a count may differ by one");
    }
}
