//! The state of one test and of each of its attempts.

use std::time::Duration;

use super::case::{AttemptCases, CaseRecord};
use super::counts::{AttemptCounts, is_detail};
use super::question::QuestionRecord;
use super::signal::SignalSummary;
use crate::{
    Attachment, CaseId, EventKind, FaultRecord, LeakedProcess, Measurement, Message, MessageKind,
    Micros, Phase, Significance, TestFinished, TestPlanned, Verdict,
};

/// The state of one test.
#[derive(Clone, Debug)]
pub struct TestRecord {
    /// How it was planned.
    pub plan: TestPlanned,
    /// Its attempts, the oldest first.
    pub attempts: Vec<AttemptRecord>,
    /// Why it (or the rest of its repetitions) was not started.
    pub skipped: Option<String>,
    /// Whether more repetitions may follow: their number is not known yet.
    is_open_ended: bool,
}

/// The state of one attempt of a test.
#[derive(Clone, Debug, Default)]
pub struct AttemptRecord {
    /// The repetition, from 1.
    pub repetition: u32,
    /// The attempt at this repetition, from 1.
    pub attempt: u32,
    /// When it started.
    pub started: Micros,
    /// The phases that it entered, with their times.
    pub phases: Vec<(Phase, Micros)>,
    /// When it finished, and its result.
    pub finished: Option<(Micros, TestFinished)>,
    /// Its messages, up to [`AttemptRecord::MESSAGES_KEPT`] of each kind.
    pub messages: Vec<Message>,
    /// Number of messages that were counted and not kept; the journal has them.
    pub messages_omitted: u64,
    /// How much it reported, kept or not.
    pub counts: AttemptCounts,
    /// Its cases.
    pub cases: AttemptCases,
    /// Its measurements.
    pub measurements: Vec<Measurement>,
    /// The signals that it sampled.
    pub series: Vec<SignalSummary>,
    /// Its questions to an operator, up to [`QuestionRecord::KEPT`]. A lean record keeps those that
    /// wait for an answer.
    pub questions: Vec<QuestionRecord>,
    /// The faults that were injected while it ran.
    pub faults: Vec<FaultRecord>,
    /// Its attachments.
    pub attachments: Vec<Attachment>,
    /// Its output; dropped when it passed, the journal has it.
    pub output: String,
    /// Stack dumps from before it was killed.
    pub stacks: Vec<String>,
    /// Its processes that had to be killed.
    pub leaked: Vec<LeakedProcess>,
    /// Whether it took longer than its `slow` limit.
    pub slow: bool,
    /// Whether it was asked to stop.
    pub stopped: bool,
    kept: [u32; 4],
    lean: bool,
}

impl TestRecord {
    pub(super) fn new(plan: TestPlanned) -> Self {
        Self { is_open_ended: plan.timed, plan, attempts: Vec::new(), skipped: None }
    }

    /// The record of a test that has only the attempts from the one with index `first` on: its
    /// result in one episode.
    pub(super) fn since(&self, first: usize) -> Self {
        let attempts = self.attempts.get(first..).unwrap_or_default().to_vec();
        let mut plan = self.plan.clone();
        // The repetitions of earlier episodes count, too.
        plan.repetitions += attempts.first().map_or(0, |first| first.repetition.saturating_sub(1));
        Self { plan, attempts, skipped: None, is_open_ended: false }
    }

    /// Whether the last repetition of an episode was run.
    pub(super) fn is_complete_round(&self) -> bool {
        self.attempts.last().is_some_and(|last| last.repetition >= self.plan.repetitions)
    }

    /// `lean`: see [`super::Record::lean`].
    pub(super) fn apply(
        &mut self,
        at: Micros,
        kind: &EventKind,
        lean: bool,
        passed_cases_kept: &mut u64,
    ) {
        match kind {
            EventKind::TestStarted { repetition, attempt, .. } => {
                self.attempts.push(AttemptRecord {
                    repetition: *repetition,
                    attempt: *attempt,
                    started: at,
                    lean,
                    ..AttemptRecord::default()
                });
            }
            EventKind::TestSkipped { reason, .. } => self.skipped = Some(reason.clone()),
            EventKind::TestRepeated { repetitions, .. } => {
                self.plan.repetitions = *repetitions;
                self.is_open_ended = false;
            }
            kind => {
                if let Some(attempt) = self.attempts.last_mut() {
                    match kind {
                        EventKind::CaseFinished(end) => {
                            let forgotten = attempt.cases.finish(at, end, passed_cases_kept);
                            attempt.forget(&forgotten);
                        }
                        kind => attempt.apply(at, kind),
                    }
                }
            }
        }
    }

    /// The number of repetitions; `None` while it is not known.
    #[must_use]
    pub fn repetitions(&self) -> Option<u32> {
        (!self.is_open_ended).then_some(self.plan.repetitions)
    }

    /// Whether an attempt is running.
    #[must_use]
    pub fn is_running(&self) -> bool {
        self.attempts.last().is_some_and(|attempt| attempt.finished.is_none())
    }

    /// The attempts that count: the last one of each repetition.
    pub fn deciding_attempts(&self) -> impl Iterator<Item = &AttemptRecord> {
        deciding(&self.attempts)
    }

    /// The attempt that explains the verdict: the first deciding attempt that did
    /// not pass, or the last attempt.
    #[must_use]
    pub fn decisive_attempt(&self) -> Option<&AttemptRecord> {
        let first = |wanted: fn(Verdict) -> bool| {
            self.deciding_attempts().find(|attempt| attempt.verdict().is_some_and(wanted))
        };
        first(Verdict::is_problem)
            .or_else(|| first(|verdict| verdict == Verdict::Skipped))
            .or(self.attempts.last())
    }

    /// The final verdict, `None` until it is known.
    #[must_use]
    pub fn verdict(&self) -> Option<Verdict> {
        let decisive = || self.decisive_attempt().and_then(AttemptRecord::verdict);
        if self.skipped.is_some() {
            return Some(decisive().filter(|v| v.is_problem()).unwrap_or(Verdict::Skipped));
        }
        let last = self.attempts.last()?;
        let (_, finished) = last.finished.as_ref()?;
        if finished.rerun || self.is_open_ended || last.repetition < self.plan.repetitions {
            return None;
        }
        decisive()
    }

    /// The final verdict in a run that has ended, see [`super::Record::final_verdict`].
    #[must_use]
    pub fn final_verdict(&self) -> Verdict {
        self.verdict().unwrap_or(if self.attempts.is_empty() {
            Verdict::Skipped
        } else {
            Verdict::Interrupted
        })
    }

    /// What its final verdict means for a run that has ended.
    #[must_use]
    pub fn significance(&self) -> Significance {
        let verdict = self.final_verdict();
        // The runner skips a test, or an attempt during which a fixture collapsed.
        let skipped_itself = |attempt: &AttemptRecord| self.skipped.is_none() && !attempt.stopped;
        if verdict == Verdict::Skipped && self.decisive_attempt().is_some_and(skipped_itself) {
            return Significance::SkippedItself;
        }
        let expected = self.plan.expected.as_deref();
        expected.map_or(Significance::Counts, |expected| expected.significance(verdict))
    }

    /// Whether a case of a deciding attempt skipped itself.
    #[must_use]
    pub fn has_skipped_cases(&self) -> bool {
        self.deciding_attempts().any(|attempt| attempt.cases.of(Verdict::Skipped) > 0)
    }

    /// Whether it passed after an earlier attempt of it, or of one of its cases, had failed. (An
    /// attempt that ended with a collapse is no evidence against the test.)
    #[must_use]
    pub fn is_flaky(&self) -> bool {
        use Verdict::{Crashed, Error, Failed, TimedOut};
        let fails = |v: Verdict| matches!(v, Failed | Error | Crashed | TimedOut);
        let any_failed = || self.attempts.iter().filter_map(AttemptRecord::verdict).any(fails);
        let any_flaky_case = || self.deciding_attempts().any(|it| it.cases.flaky() > 0);
        self.verdict() == Some(Verdict::Passed) && (any_failed() || any_flaky_case())
    }

    /// Why it did not pass.
    #[must_use]
    pub fn reason(&self) -> Option<&str> {
        let finished = self.decisive_attempt().and_then(|a| a.finished.as_ref());
        let failed = finished.filter(|(_, finished)| !finished.verdict.is_green());
        failed.and_then(|(_, finished)| finished.reason.as_deref()).or(self.skipped.as_deref())
    }

    /// The total duration of all judged attempts.
    #[must_use]
    pub fn duration(&self) -> Duration {
        self.attempts.iter().filter_map(AttemptRecord::duration).sum()
    }
}

/// The last attempt of each repetition.
pub(super) fn deciding(attempts: &[AttemptRecord]) -> impl Iterator<Item = &AttemptRecord> {
    let repetitions = attempts.chunk_by(|one, next| one.repetition == next.repetition);
    repetitions.filter_map(<[_]>::last)
}

impl AttemptRecord {
    /// Maximum number of messages of each kind that are kept in memory.
    pub const MESSAGES_KEPT: u32 = 1000;

    /// Maximum number of faults that are kept in memory.
    pub const FAULTS_KEPT: usize = 1000;

    fn apply(&mut self, at: Micros, kind: &EventKind) {
        self.counts.count(kind);
        match kind {
            _ if self.lean && is_detail(kind) => {}
            EventKind::TestPhase { phase, .. } => self.phases.push((*phase, at)),
            EventKind::Message { message, .. } => self.keep_message(message),
            EventKind::Measured { measurement, .. } => self.measurements.push(measurement.clone()),
            EventKind::Sampled { samples, .. } => {
                SignalSummary::extend_one_of(&mut self.series, samples);
            }
            EventKind::FaultInjected(fault) if self.faults.len() < Self::FAULTS_KEPT => {
                let (fault, removed) = (fault.clone(), None);
                self.faults.push(FaultRecord { fault, injected: at, removed });
            }
            EventKind::FaultRemoved { name, .. } => {
                let mut faults = self.faults.iter_mut().rev();
                let lasting = faults.find(|it| it.fault.name == *name && it.removed.is_none());
                lasting.into_iter().for_each(|it| it.removed = Some(at));
            }
            EventKind::Attached { attachment, .. } => self.attachments.push(attachment.clone()),
            EventKind::Output(output) => output.append_to(&mut self.output),
            EventKind::CasesPlanned { names, .. } => self.cases.plan(names),
            EventKind::CaseStarted(started) => self.cases.start(at, &started.start),
            EventKind::QuestionAsked(asked) => {
                QuestionRecord::ask(&mut self.questions, at, &asked.question);
            }
            EventKind::QuestionClosed(closed) => {
                QuestionRecord::close(&mut self.questions, at, closed, !self.lean);
            }
            EventKind::TestSlow { .. } => self.slow = true,
            EventKind::TestStopping { .. } => self.stopped = true,
            EventKind::StackDumped { text, .. } => self.stacks.push(text.clone()),
            EventKind::ProcessesLeaked { processes, .. } => {
                self.leaked.extend_from_slice(processes)
            }
            EventKind::TestFinished(finished) => self.finish(at, finished),
            _ => {}
        }
    }

    /// Forgets what was reported in these cases; the journal has it.
    fn forget(&mut self, cases: &[CaseId]) {
        if cases.is_empty() {
            return;
        }
        let is_kept = |case: Option<CaseId>| !case.is_some_and(|case| cases.contains(&case));
        self.measurements.retain(|measurement| is_kept(measurement.case));
        self.messages.retain(|message| is_kept(message.case));
        self.attachments.retain(|attachment| is_kept(attachment.case));
    }

    fn keep_message(&mut self, message: &Message) {
        let kept = &mut self.kept[match message.kind {
            MessageKind::Report => 0,
            MessageKind::Check => 1,
            MessageKind::Failure => 2,
            MessageKind::Error => 3,
        }];
        if *kept < Self::MESSAGES_KEPT {
            *kept += 1;
            self.messages.push(message.clone());
        } else {
            self.messages_omitted += 1;
        }
    }

    fn finish(&mut self, at: Micros, finished: &TestFinished) {
        if finished.verdict.is_green() {
            self.output = String::new();
        }
        self.messages.shrink_to_fit();
        self.phases.shrink_to_fit();
        self.finished = Some((at, finished.clone()));
    }

    /// The verdict, `None` while it runs.
    #[must_use]
    pub fn verdict(&self) -> Option<Verdict> {
        self.finished.as_ref().map(|(_, finished)| finished.verdict)
    }

    /// Its duration until it was judged, `None` while it runs.
    #[must_use]
    pub fn duration(&self) -> Option<Duration> {
        let notified = self.phases.iter().find(|(phase, _)| *phase == Phase::Notify);
        let judged = notified.map(|(_, at)| *at).or(self.finished.as_ref().map(|(at, _)| *at));
        judged.map(|at| at.since(self.started))
    }

    /// The failures and errors that were kept.
    pub fn failures(&self) -> impl Iterator<Item = &Message> {
        let fails = |m: &&Message| matches!(m.kind, MessageKind::Failure | MessageKind::Error);
        self.messages.iter().filter(fails)
    }

    /// Whether a failure or a violated limit was reported in this case; `None` is outside of cases.
    #[must_use]
    pub fn has_reported_problem(&self, case: Option<CaseId>) -> bool {
        self.failures().any(|failure| failure.case == case)
            || self.violations().any(|violation| violation.case == case)
    }

    /// Whether a case did not pass for a reason that is not only that of a case it contains.
    #[must_use]
    pub fn has_own_problem(&self, case: &CaseRecord) -> bool {
        let id = Some(case.start.case);
        let is_open_inside =
            |inner: &CaseRecord| inner.start.parent == id && inner.finished.is_none();
        match &case.finished {
            _ if case.is_superseded => false,
            None => !self.cases.kept().iter().any(is_open_inside),
            Some((_, finished)) => {
                finished.verdict.is_problem()
                    && (finished.decided_by.is_none() || self.has_reported_problem(id))
            }
        }
    }

    /// The measurements outside their limits.
    pub fn violations(&self) -> impl Iterator<Item = &Measurement> {
        self.measurements.iter().filter(|measurement| !measurement.is_within_limits())
    }
}
