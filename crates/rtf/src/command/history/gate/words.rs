//! A judgement in words, for text and Markdown. Nothing is escaped yet.

use rtf_history::answers::gate::{
    Direction, FailureGate, FlakyGate, GateReport, JudgedSeries, MIN_BASELINE_RUNS, NotJudged,
    NotJudgedReason, RegressionGate,
};
use rtf_history::entry::RunEnd;
use rtf_model::format_rounded;
use rtf_report::format_count;

pub struct GateWords {
    pub passed: bool,
    pub title: String,
    pub lines: Vec<GateLine>,
    /// What was not judged, for example.
    pub notes: Vec<String>,
}

/// A test that is listed.
pub struct GateLine {
    pub test: String,
    pub details: String,
}

/// `run 2026-… is compared with 20 runs: 310 tests`.
pub fn head(report: &GateReport) -> String {
    let runs = format_count(report.baseline_runs as u64, "run");
    let tests = format_count(report.tests as u64, "test");
    format!("run {} with {tests}, compared with {runs}", report.run.name)
}

pub fn gates(report: &GateReport) -> Vec<GateWords> {
    let end = (report.run.end != RunEnd::Finished).then(|| unfinished(report.run.end));
    let failures = report.new_failures.iter().map(failures);
    let flaky = report.flaky.iter().map(|gate| flaky(gate, report.tests));
    end.into_iter()
        .chain(failures)
        .chain(flaky)
        .chain(report.no_regression.iter().map(regressions))
        .collect()
}

fn unfinished(end: RunEnd) -> GateWords {
    let how = match end {
        RunEnd::Died => "its runner died",
        RunEnd::Unfinished => "its journal has no end",
        RunEnd::Finished | RunEnd::Interrupted => "it was interrupted",
    };
    let title = format!("the run did not finish: {how}");
    GateWords { passed: false, title, lines: Vec::new(), notes: Vec::new() }
}

fn failures(gate: &FailureGate) -> GateWords {
    let line = |test: &rtf_history::answers::gate::NewFailure| {
        let reason = test.reason.as_deref().and_then(|reason| reason.lines().next());
        let reason = reason.map_or(String::new(), |reason| format!(": {reason}"));
        let details = format!("{}{reason} (passed in {})", test.verdict, test.passed_in);
        GateLine { test: test.identity.to_string(), details }
    };
    let found = format_count(gate.tests.len() as u64, "new failure");
    let names: Vec<_> = gate.not_judged.iter().map(ToString::to_string).collect();
    let note = format!("not judged, because the baseline has no result: {}", names.join(", "));
    GateWords {
        passed: gate.passed,
        title: format!("{found}, at most {} allowed", gate.max),
        lines: gate.tests.iter().map(line).collect(),
        notes: if names.is_empty() { Vec::new() } else { vec![note] },
    }
}

fn flaky(gate: &FlakyGate, tests: usize) -> GateWords {
    let line = |test: &rtf_history::TestIdentity| GateLine {
        test: test.to_string(),
        details: String::new(),
    };
    GateWords {
        passed: gate.passed,
        title: format!(
            "{} of {} flaky: {} %, at most {} % allowed",
            gate.tests.len(),
            format_count(tests as u64, "test"),
            percent(gate.share),
            percent(gate.max)
        ),
        lines: gate.tests.iter().map(line).collect(),
        notes: Vec::new(),
    }
}

fn regressions(gate: &RegressionGate) -> GateWords {
    let worse: Vec<_> = gate.series.iter().filter(|series| series.regression).collect();
    let allowed = percent(gate.max);
    GateWords {
        passed: gate.passed,
        title: format!(
            "{}: {} in {}, a change for the worse of {allowed} % allowed",
            gate.name,
            format_count(worse.len() as u64, "regression"),
            format_count(gate.series.len() as u64, "test"),
        ),
        lines: worse.into_iter().map(regression).collect(),
        notes: gate.not_judged.iter().map(not_judged).collect(),
    }
}

fn regression(series: &JudgedSeries) -> GateLine {
    let unit = &series.series.unit;
    let change = series.change.map_or(String::new(), |change| {
        let sign = if change < 0.0 { '-' } else { '+' };
        format!(" ({sign}{} %)", percent(change.abs()))
    });
    let worse = match series.worse {
        Direction::Higher => ", higher is worse",
        Direction::Lower => ", lower is worse",
        Direction::Any => "",
    };
    let runs = format_count(series.baseline_runs as u64, "run");
    let (before, now) = (number(series.baseline, unit), number(series.value, unit));
    GateLine {
        test: series.identity.to_string(),
        details: format!("{before} → {now}{change}, median of {runs}{worse}"),
    }
}

fn not_judged(series: &NotJudged) -> String {
    let reason = match series.reason {
        NotJudgedReason::FewRuns { baseline_runs } => {
            let runs = format_count(baseline_runs as u64, "green baseline run");
            format!("{runs} on the same robot, {MIN_BASELINE_RUNS} are needed")
        }
        NotJudgedReason::NotFinite => "the run has no finite value".to_owned(),
        NotJudgedReason::NotMeasured => "the run has no value".to_owned(),
    };
    format!("not judged: {}: {reason}", series.identity)
}

fn number(value: f64, unit: &str) -> String {
    let value = format_rounded(value);
    if unit.is_empty() { value } else { format!("{value} {unit}") }
}

/// A share in percent, without the sign.
fn percent(share: f64) -> String {
    let rounded = (share * 1000.0).round() / 10.0;
    format!("{rounded}")
}
