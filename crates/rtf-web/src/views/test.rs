//! Tests and their attempts.

use rtf_model::{
    AttemptRecord, ExitStatus, ExpectedFailure, FaultKind, FaultRecord, LeakedProcess, Parameter,
    Phase, Record, TestRecord, Verdict,
};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{Asked, CaseCounts, Significance, model};
use crate::address;

/// The state of a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TestState {
    /// It has not started, or waits for its next repetition.
    Pending,
    /// It runs.
    Running,
    /// Its verdict is final.
    Done,
}

/// A test.
#[derive(Debug, Serialize, ToSchema)]
pub struct Test {
    /// Its id.
    pub id: u32,
    /// Its suite.
    pub suite: u32,
    /// Its name, unique in the suite.
    pub name: String,
    /// The plug-in's type.
    pub plugin_type: String,
    /// The plug-in's file.
    pub plugin: String,
    /// The number of repetitions.
    pub repetitions: u32,
    /// Whether it is repeated for a given time; `repetitions` is then that of a round.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    #[schema(required = false)]
    pub timed: bool,
    /// The tags given in the suite.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub tags: Vec<String>,
    /// The values of its matrix.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(value_type = Vec<model::Parameter>, required = false)]
    pub parameters: Vec<Parameter>,
    /// Its known failure.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<model::ExpectedFailure>)]
    pub expected: Option<Box<ExpectedFailure>>,
    /// Its state.
    pub state: TestState,
    /// Its final verdict.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<model::Verdict>)]
    pub verdict: Option<Verdict>,
    /// What the final verdict means, if it does not count like any other.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub significance: Option<Significance>,
    /// Whether the final verdict leaves the run green.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub green: Option<bool>,
    /// Why it did not pass.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Its current phase, while it runs.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<model::Phase>)]
    pub phase: Option<Phase>,
    /// Its questions to an operator that wait for an answer.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub questions: Vec<Asked>,
    /// Microseconds in all attempts that ended.
    pub duration_us: u64,
    /// Whether an attempt took longer than its `slow` limit.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    #[schema(required = false)]
    pub slow: bool,
    /// Its attempts, in order.
    pub attempts: Vec<AttemptRow>,
    /// How much all of them reported.
    pub counts: Counts,
}

/// One attempt of a test, in short.
#[derive(Debug, Serialize, ToSchema)]
pub struct AttemptRow {
    /// Counts all attempts of the test, from 1.
    pub number: usize,
    /// The repetition, from 1.
    pub repetition: u32,
    /// The attempt at this repetition, from 1.
    pub attempt: u32,
    /// When it started.
    pub started: u64,
    /// When it ended.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub finished: Option<u64>,
    /// The verdict.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<model::Verdict>)]
    pub verdict: Option<Verdict>,
    /// Whether the same repetition is retried.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    #[schema(required = false)]
    pub rerun: bool,
    /// The faults that were injected while it ran.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub faults: Vec<Fault>,
}

/// A fault that was injected.
#[derive(Debug, Serialize, ToSchema)]
pub struct Fault {
    /// Its name.
    pub name: String,
    /// Its kind.
    #[schema(value_type = model::FaultKind)]
    pub kind: FaultKind,
    /// What was done.
    pub effect: String,
    /// When it was injected.
    pub injected: u64,
    /// When it was removed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub removed: Option<u64>,
}

impl Fault {
    fn of(record: &FaultRecord) -> Self {
        Self {
            name: record.fault.name.clone(),
            kind: record.fault.kind,
            effect: record.fault.effect.clone(),
            injected: record.injected.0,
            removed: record.removed.map(|at| at.0),
        }
    }
}

/// How much was reported.
#[derive(Clone, Copy, Debug, Default, Serialize, ToSchema)]
pub struct Counts {
    /// Messages of all kinds.
    pub messages: u64,
    /// Failures and errors among them.
    pub failures: u64,
    /// Measurements.
    pub measurements: u64,
    /// Measurements and samples outside their limits.
    pub violations: u64,
    /// Attached files.
    pub attachments: u64,
    /// Printed bytes.
    pub output_bytes: u64,
}

/// A page of the list of tests.
#[derive(Debug, Serialize, ToSchema)]
pub struct TestPage {
    /// The tests, by their ids.
    pub tests: Vec<Test>,
    /// Number of matching tests.
    pub total: usize,
    /// The `after` of the next page.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub next: Option<u32>,
}

/// A test with its attempts, without messages and output.
#[derive(Debug, Serialize, ToSchema)]
pub struct TestDetail {
    /// The test.
    pub test: Test,
    /// Its attempts, in order.
    pub attempts: Vec<Attempt>,
    /// The command that reruns it, in the working directory of its run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub command: Option<String>,
    /// The command that replays the recording of its decisive attempt, if it failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub replay: Option<String>,
}

impl TestDetail {
    /// A view of a test with its attempts; `over`: its run has ended. The commands rerun and
    /// replay it.
    #[must_use]
    pub fn of(
        test: &TestRecord,
        record: &Record,
        over: bool,
        commands: (Option<String>, Option<String>),
    ) -> Self {
        let (command, replay) = commands;
        let attempts = test.attempts.iter().zip(1..).map(|(a, number)| Attempt::of(a, number));
        Self { test: Test::of(test, record, over), attempts: attempts.collect(), command, replay }
    }
}

/// One attempt of a test.
#[derive(Debug, Serialize, ToSchema)]
pub struct Attempt {
    /// In short.
    #[serde(flatten)]
    pub row: AttemptRow,
    /// The phases that it entered.
    pub phases: Vec<PhaseAt>,
    /// Why it did not pass.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The phase that decided the verdict.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<model::Phase>)]
    pub phase: Option<Phase>,
    /// How its process ended.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<model::ExitStatus>)]
    pub exit: Option<ExitStatus>,
    /// Whether it took longer than its `slow` limit.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    #[schema(required = false)]
    pub slow: bool,
    /// How much it reported.
    pub counts: Counts,
    /// Its cases, if it has any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cases: Option<CaseCounts>,
    /// Its processes that had to be killed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(value_type = Vec<model::LeakedProcess>, required = false)]
    pub leaked: Vec<LeakedProcess>,
}

/// When a phase began.
#[derive(Debug, Serialize, ToSchema)]
pub struct PhaseAt {
    /// The phase.
    #[schema(value_type = model::Phase)]
    pub phase: Phase,
    /// When.
    pub at: u64,
}

/// The questions of an attempt that wait for an answer.
fn open_questions(record: &Record, attempt: &AttemptRecord) -> Vec<Asked> {
    let run = record.run.as_ref().map_or("", |run| &run.run);
    let url = |path: &str| address::file(run, path);
    attempt.questions.iter().filter(|it| it.is_open()).map(|it| Asked::open(it, url)).collect()
}

impl Test {
    /// A view of a test; `over`: its run has ended.
    #[must_use]
    pub fn of(test: &TestRecord, record: &Record, over: bool) -> Self {
        let plan = &test.plan;
        let verdict = if over { Some(test.final_verdict()) } else { test.verdict() };
        let running = test.attempts.last().filter(|_| verdict.is_none() && test.is_running());
        let mut counts = rtf_model::AttemptCounts::default();
        test.attempts.iter().for_each(|attempt| counts += attempt.counts);
        Self {
            id: plan.test.0,
            suite: plan.suite.0,
            name: plan.name.clone(),
            plugin_type: plan.plugin_type.clone(),
            plugin: plan.plugin.clone(),
            repetitions: plan.repetitions,
            timed: test.repetitions().is_none(),
            tags: plan.tags.clone(),
            parameters: plan.parameters.clone(),
            expected: plan.expected.clone(),
            state: match (verdict, running) {
                (Some(_), _) => TestState::Done,
                (None, Some(_)) => TestState::Running,
                (None, None) => TestState::Pending,
            },
            verdict,
            significance: verdict.and_then(|_| Significance::of(test.significance())),
            green: verdict.map(|_| record.is_test_green(test)),
            reason: test.reason().map(str::to_owned),
            phase: running.and_then(|attempt| attempt.phases.last()).map(|(phase, _)| *phase),
            questions: running.map_or_else(Vec::new, |attempt| open_questions(record, attempt)),
            duration_us: u64::try_from(test.duration().as_micros()).unwrap_or(u64::MAX),
            slow: test.attempts.iter().any(|attempt| attempt.slow),
            attempts: test.attempts.iter().zip(1..).map(|(a, n)| AttemptRow::of(a, n)).collect(),
            counts: counts.into(),
        }
    }
}

impl AttemptRow {
    fn of(attempt: &AttemptRecord, number: usize) -> Self {
        let finished = attempt.finished.as_ref();
        Self {
            number,
            repetition: attempt.repetition,
            attempt: attempt.attempt,
            started: attempt.started.0,
            finished: finished.map(|(at, _)| at.0),
            verdict: attempt.verdict(),
            rerun: finished.is_some_and(|(_, finished)| finished.rerun),
            faults: attempt.faults.iter().map(Fault::of).collect(),
        }
    }
}

impl Attempt {
    /// A view of an attempt.
    #[must_use]
    pub fn of(attempt: &AttemptRecord, number: usize) -> Self {
        let finished = attempt.finished.as_ref().map(|(_, finished)| finished);
        let phase = |(phase, at): &(Phase, rtf_model::Micros)| PhaseAt { phase: *phase, at: at.0 };
        Self {
            row: AttemptRow::of(attempt, number),
            phases: attempt.phases.iter().map(phase).collect(),
            reason: finished.and_then(|finished| finished.reason.clone()),
            phase: finished.map(|finished| finished.phase),
            exit: finished.and_then(|finished| finished.exit),
            slow: attempt.slow,
            counts: attempt.counts.into(),
            cases: CaseCounts::of(&attempt.cases),
            leaked: attempt.leaked.clone(),
        }
    }
}

impl From<rtf_model::AttemptCounts> for Counts {
    fn from(counts: rtf_model::AttemptCounts) -> Self {
        Self {
            messages: counts.messages,
            failures: counts.failures,
            measurements: counts.measurements,
            violations: counts.violations,
            attachments: counts.attachments,
            output_bytes: counts.output_bytes,
        }
    }
}
