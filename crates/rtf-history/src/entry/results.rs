//! The results of tests and cases in a record.

use std::collections::{BTreeMap, HashMap};
use std::time::Duration;

use rtf_model::{AttemptRecord, CaseId, Record, RunStarted, TestRecord, Verdict};

use super::number::{NumberCollector, NumberSummary, SeriesName};
use crate::statistics::Outcome;
use crate::statistics::robust::median;
use crate::{SuiteFileBase, TestIdentity};

/// The result of a test, or of a case, in a run.
#[derive(Clone, Debug, PartialEq)]
pub struct ResultEntry {
    pub identity: TestIdentity,
    pub plugin_type: String,
    pub tags: Vec<String>,
    /// Its values of a matrix, as name and value.
    pub parameters: Vec<(String, String)>,
    /// Its former name.
    pub was: Option<String>,
    /// The final verdict.
    pub verdict: Verdict,
    /// Whether it both passed and failed: on a retry, or in repetitions.
    pub is_flaky: bool,
    /// Number of attempts, of all repetitions.
    pub attempts: u32,
    /// Number of attempts that did not pass.
    pub problems: u32,
    /// The duration of a decisive attempt (the median over repetitions), in microseconds.
    pub duration_us: Option<i64>,
    pub reason: Option<String>,
    /// The exclusive resources of its suite, separated by spaces.
    pub robot: String,
    pub plugin_hash: Option<String>,
    pub source_hash: Option<String>,
    /// Its measurements and signals.
    pub numbers: Vec<(SeriesName, NumberSummary)>,
}

/// The results of all tests of a run, each followed by those of its cases.
pub(super) fn of_tests(record: &Record, started: &RunStarted) -> Vec<ResultEntry> {
    let base = SuiteFileBase::new(started);
    let suites = record.suites.iter().map(|suite| {
        (base.normalize(&suite.plan.file), suite.plan.name.clone(), suite.plan.requires.join(" "))
    });
    let suites: Vec<_> = suites.collect();
    let mut results = Vec::new();
    for test in &record.tests {
        let Some((suite_file, suite, robot)) = suites.get(test.plan.suite.index()) else {
            continue;
        };
        let identity = TestIdentity {
            suite_file: suite_file.clone(),
            suite: suite.clone(),
            test: test.plan.name.clone(),
            case: String::new(),
        };
        add_test(test, identity, robot, &mut results);
    }
    results
}

/// Names are identities in every database, and PostgreSQL stores no NUL.
pub(super) fn without_nul(mut results: Vec<ResultEntry>) -> Vec<ResultEntry> {
    for result in &mut results {
        let TestIdentity { suite_file, suite, test, case } = &mut result.identity;
        let series = result.numbers.iter_mut().flat_map(|(it, _)| [&mut it.name, &mut it.unit]);
        let names =
            [suite_file, suite, test, case].into_iter().chain(&mut result.was).chain(series);
        for name in names.filter(|name| name.contains('\0')) {
            *name = name.replace('\0', "\u{fffd}");
        }
    }
    results
}

fn add_test(test: &TestRecord, identity: TestIdentity, robot: &str, to: &mut Vec<ResultEntry>) {
    let verdicts = || test.attempts.iter().filter_map(AttemptRecord::verdict);
    let durations = test.deciding_attempts().filter_map(AttemptRecord::duration);
    let parameters = test.plan.parameters.iter().map(|it| (it.name.clone(), it.value.clone()));
    let mut numbers = numbers_by_case(test);
    let result = ResultEntry {
        identity,
        plugin_type: test.plan.plugin_type.clone(),
        tags: test.plan.tags.clone(),
        parameters: parameters.collect(),
        was: test.plan.was.clone(),
        verdict: test.final_verdict(),
        is_flaky: test.is_flaky() || is_mixed(verdicts()),
        attempts: count(test.attempts.len()),
        problems: count(verdicts().filter(|verdict| verdict.is_problem()).count()),
        duration_us: median_us(durations),
        reason: test.reason().map(str::to_owned),
        robot: robot.to_owned(),
        plugin_hash: test.plan.plugin_hash.clone(),
        source_hash: test.plan.source_hash.clone(),
        numbers: numbers.remove("").map(NumberCollector::finish).unwrap_or_default(),
    };
    let cases = cases(test);
    to.reserve(cases.len() + 1);
    to.push(result.clone());
    for (path, case) in cases {
        let numbers = numbers.remove(&path).map(NumberCollector::finish).unwrap_or_default();
        let identity = TestIdentity { case: path, ..result.identity.clone() };
        to.push(ResultEntry {
            identity,
            was: None,
            verdict: case.verdict,
            is_flaky: case.is_flaky || is_mixed(case.verdicts.into_iter()),
            attempts: count(case.durations.len()),
            problems: case.problems,
            duration_us: median_us(case.durations.into_iter()),
            reason: case.reason,
            numbers,
            ..result.clone()
        });
    }
}

/// A case in all decisive attempts. The first problem decides.
struct CaseSummary {
    verdict: Verdict,
    reason: Option<String>,
    is_flaky: bool,
    problems: u32,
    /// Of each attempt that decides.
    verdicts: Vec<Verdict>,
    durations: Vec<Duration>,
}

/// Whether there are passes and failures. A problem of the bench is neither.
fn is_mixed(verdicts: impl Iterator<Item = Verdict> + Clone) -> bool {
    let has = |wanted| verdicts.clone().any(|verdict| Outcome::of(verdict) == Some(wanted));
    has(Outcome::Passed) && has(Outcome::Failed)
}

/// The finished cases by path.
fn cases(test: &TestRecord) -> BTreeMap<String, CaseSummary> {
    let mut cases = BTreeMap::<String, CaseSummary>::new();
    for case in test.deciding_attempts().flat_map(|attempt| attempt.cases.decisive()) {
        let Some(verdict) = case.verdict() else { continue };
        let reason = || case.reason().map(str::to_owned);
        let known = cases.entry(case.path.clone()).or_insert_with(|| CaseSummary {
            verdict,
            reason: reason(),
            is_flaky: false,
            problems: 0,
            verdicts: Vec::new(),
            durations: Vec::new(),
        });
        if verdict.is_problem() && !known.verdict.is_problem() {
            (known.verdict, known.reason) = (verdict, reason());
        }
        known.is_flaky |= case.is_flaky();
        known.problems += u32::from(verdict.is_problem());
        known.verdicts.push(verdict);
        known.durations.extend(case.duration());
    }
    cases
}

/// The numbers that decisive attempts reported, by the path of the case; those outside of
/// cases have an empty path.
fn numbers_by_case(test: &TestRecord) -> HashMap<String, NumberCollector> {
    let mut numbers = HashMap::<String, NumberCollector>::new();
    for attempt in test.deciding_attempts() {
        let path = |case: Option<CaseId>| {
            let case = case.and_then(|case| attempt.cases.get(case));
            case.filter(|case| case.finished.is_some()).map_or("", |case| &case.path)
        };
        for measurement in &attempt.measurements {
            let path = path(measurement.case);
            if !numbers.contains_key(path) {
                numbers.insert(path.to_owned(), NumberCollector::default());
            }
            if let Some(numbers) = numbers.get_mut(path) {
                numbers.add_measurement(measurement);
            }
        }
        for signal in &attempt.series {
            numbers.entry(String::new()).or_default().add_signal(signal);
        }
    }
    numbers
}

fn median_us(durations: impl Iterator<Item = Duration>) -> Option<i64> {
    let micros: Vec<_> = durations.map(|duration| duration.as_micros() as f64).collect();
    median(&micros).map(|micros| micros.round() as i64)
}

fn count(number: usize) -> u32 {
    u32::try_from(number).unwrap_or(u32::MAX)
}
