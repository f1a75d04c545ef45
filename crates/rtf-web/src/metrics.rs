//! `/metrics`: the history as metrics for Prometheus, in the text format of OpenMetrics.
//! Their number does not depend on the number of tests.

use std::sync::atomic::AtomicU64;

use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use prometheus_client::encoding::EncodeLabelSet;
use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::registry::{Registry, Unit};
use rtf_history::answers::RunInfo;
use rtf_history::statistics::robust::median;
use rtf_history::{RunSelection, Store, StoreError};
use rtf_model::Verdict;

use crate::app::{App, blocking};
use crate::problem::Problem;

/// The rates are those of this number of newest runs.
const RECENT: usize = 100;

const CONTENT_TYPE: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";

type Number = Gauge<f64, AtomicU64>;

#[derive(Clone, Debug, PartialEq, Eq, Hash, EncodeLabelSet)]
struct VerdictLabel {
    verdict: &'static str,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash, EncodeLabelSet)]
struct ResultLabel {
    result: &'static str,
}

/// The metrics of the history, if the server was started with `--web-metrics`.
pub async fn metrics(State(app): State<App>) -> Result<Response, Problem> {
    if !app.metrics {
        let hint = "start the server with `--web-metrics`";
        return Err(Problem::not_found("this server has no metrics").hint(hint));
    }
    let text = blocking(move || {
        let read = |store: Store| HistoryNumbers::read(&store);
        // A history that cannot be read is a number, too: a scrape that fails would not say why.
        let numbers = app.history.open().and_then(read).ok();
        let mut text = String::new();
        encode(&mut text, &registry(numbers.as_ref())).map_err(|error| {
            Problem::new(axum::http::StatusCode::INTERNAL_SERVER_ERROR, error.to_string())
        })?;
        Ok(text)
    });
    Ok(([(header::CONTENT_TYPE, CONTENT_TYPE)], text.await?).into_response())
}

struct HistoryNumbers {
    /// The newest first.
    runs: Vec<RunInfo>,
    flaky: usize,
    tests: usize,
}

impl HistoryNumbers {
    fn read(store: &Store) -> Result<Self, StoreError> {
        let recent = RunSelection { last: Some(RECENT), ..RunSelection::default() };
        Ok(Self {
            runs: store.runs(&RunSelection::default())?,
            flaky: store.flaky(&recent, &|test| test.identity.case.is_empty())?.tests.len(),
            tests: store.identities()?.iter().filter(|test| test.case.is_empty()).count(),
        })
    }
}

fn registry(numbers: Option<&HistoryNumbers>) -> Registry {
    let mut registry = Registry::with_prefix("rtf");
    let readable = number(&mut registry, "history_readable", "Whether the history can be read");
    readable.set(f64::from(u8::from(numbers.is_some())));
    if let Some(numbers) = numbers {
        add_totals(&mut registry, &numbers.runs);
        add_recent(&mut registry, numbers);
        if let Some(last) = numbers.runs.first() {
            add_last_run(&mut registry, last);
        }
    }
    registry
}

fn number(registry: &mut Registry, name: &str, help: &str) -> Number {
    let gauge = Number::default();
    registry.register(name, help, gauge.clone());
    gauge
}

fn seconds(registry: &mut Registry, name: &str, help: &str) -> Number {
    let gauge = Number::default();
    registry.register_with_unit(name, help, Unit::Seconds, gauge.clone());
    gauge
}

fn add_totals(registry: &mut Registry, runs: &[RunInfo]) {
    let by_result = Family::<ResultLabel, Number>::default();
    registry.register("runs", "Runs in the history", by_result.clone());
    for (result, is_green) in [("green", true), ("red", false)] {
        let count = runs.iter().filter(|run| run.green == is_green).count();
        by_result.get_or_create(&ResultLabel { result }).set(count as f64);
    }
    let all = runs.iter().map(|run| run.counts);
    add_verdicts(registry, ("results", "Results of tests in the history"), |verdict| {
        all.clone().map(|counts| u64::from(counts.of(verdict))).sum()
    });
}

fn add_verdicts(
    registry: &mut Registry,
    (name, help): (&str, &str),
    count: impl Fn(Verdict) -> u64,
) {
    let by_verdict = Family::<VerdictLabel, Number>::default();
    registry.register(name, help, by_verdict.clone());
    for verdict in Verdict::ALL {
        let label = VerdictLabel { verdict: verdict.as_str() };
        by_verdict.get_or_create(&label).set(count(verdict) as f64);
    }
}

fn add_recent(registry: &mut Registry, HistoryNumbers { runs, flaky, tests }: &HistoryNumbers) {
    let recent = &runs[..runs.len().min(RECENT)];
    number(registry, "recent_runs", "Number of newest runs of the recent_ metrics")
        .set(recent.len() as f64);
    let durations: Vec<f64> = recent.iter().map(|run| run.duration).collect();
    if let Some(median) = median(&durations) {
        let help = "Median duration of the newest runs";
        seconds(registry, "recent_run_duration", help).set(median);
    }
    let help = "Tests that both passed and failed on one commit, or in one run, of the newest runs";
    number(registry, "recent_flaky_tests", help).set(*flaky as f64);
    let ratio = if *tests == 0 { 0.0 } else { *flaky as f64 / *tests as f64 };
    let help = "Flaky tests of the newest runs among all tests of the history";
    number(registry, "recent_flaky_ratio", help).set(ratio);
}

fn add_last_run(registry: &mut Registry, run: &RunInfo) {
    let help = "When the newest run started, as seconds since 1970";
    seconds(registry, "last_run_start_time", help).set(run.started.as_microsecond() as f64 / 1e6);
    seconds(registry, "last_run_duration", "Duration of the newest run").set(run.duration);
    number(registry, "last_run_green", "Whether the newest run is green")
        .set(f64::from(u8::from(run.green)));
    add_verdicts(registry, ("last_run_tests", "Tests of the newest run"), |verdict| {
        run.counts.of(verdict).into()
    });
}
