//! The cases of a test: judges each one, and finishes those that the test leaves open.

use std::collections::HashMap;

use rtf_model::{
    CaseFinished, CaseId, CaseStart, CaseStarted, Diagnostic, EpisodeEnd, EventKind, Outcome,
    Phase, PlannedCases, Verdict,
};

use super::TestRun;
use super::carried_cases::{CarriedCases, CaseHistory};
use super::case_reruns::{CaseName, CaseReruns, unique};
use crate::run::machine::context::Context;
use crate::run::machine::judge::{Judgement, TestProblem, judge};
use rtf_plan::plan::{AfterCollapse, TestPlan};

/// The number of names that a problem lists.
const NAMES_SHOWN: usize = 3;

/// A case that has started and not finished.
#[derive(Debug)]
pub(super) struct OpenCase {
    id: CaseId,
    parent: Option<CaseId>,
    name: CaseName,
    /// Its name, after those of the cases that contain it.
    path: String,
    first_problem: Option<TestProblem>,
    /// The first of the worst problems in the cases that it contains.
    inner_problem: Option<TestProblem>,
    /// The processes that it left behind, if it does not pass with these.
    leak: Option<String>,
}

/// The open cases of an attempt.
#[derive(Debug, Default)]
pub(super) struct OpenCases {
    started: u32,
    /// The number of cases that were carried from an earlier attempt. Those of the host
    /// follow.
    carried: u32,
    /// Whether one of these passed.
    pub any_carried_passed: bool,
    /// For a test whose finished cases are not rerun after a collapse.
    pub history: Option<Box<CaseHistory>>,
    open: Vec<OpenCase>,
    /// How many cases with the same parent and name have started, by a hash of both.
    names: HashMap<u64, u32>,
    planned_names: HashMap<u64, u32>,
    planned: PlannedCases,
    announced: usize,
    /// The paths of selected cases that have not started.
    awaited: Vec<String>,
    reruns: CaseReruns,
}

/// The end of a case, as its host reports it.
#[derive(Debug)]
pub(super) struct FinishedCase {
    pub case: CaseId,
    pub outcome: Option<Outcome>,
    pub reason: Option<String>,
    pub duration_us: Option<u64>,
    pub rerun: bool,
    pub episode: Option<Box<EpisodeEnd>>,
}

/// The result of a case apart from its reported problems.
#[derive(Debug)]
enum CaseResult {
    /// As its host reports it.
    Case(Verdict, Option<String>),
    /// The same, and another attempt of it follows.
    Attempt(Verdict, Option<String>),
    /// The test was stopped or its process ended, which is no problem of the case alone.
    Test {
        verdict: Verdict,
        reason: Option<String>,
        /// The innermost case that was open in it.
        innermost: Option<CaseId>,
    },
}

impl OpenCase {
    fn new(id: CaseId, parent: Option<CaseId>, name: CaseName, path: String) -> Self {
        let (first_problem, inner_problem, leak) = (None, None, None);
        Self { id, parent, name, path, first_problem, inner_problem, leak }
    }

    /// Records the problem of processes that it left behind, which counts if it passes otherwise.
    pub fn record_leak(&mut self, problem: Option<String>) {
        self.leak = problem;
    }

    /// Records the first problem that is reported in the case.
    pub fn record(&mut self, problem: TestProblem) {
        self.first_problem.get_or_insert(problem);
    }

    /// Returns a problem as that of a case, unless it is that of an inner case already.
    fn describe(&self, problem: TestProblem) -> TestProblem {
        if problem.case.is_some() {
            return problem;
        }
        let reason = format!("case `{}`: {}", self.path, problem.reason);
        TestProblem { reason, case: Some(self.id), ..problem }
    }

    /// Returns its worst problem; `case` is set if it is that of an inner case.
    fn take_problem(&mut self) -> Option<TestProblem> {
        let mut problem = self.first_problem.take();
        if let Some(inner) = self.inner_problem.take() {
            TestProblem::keep_worse(&mut problem, inner);
        }
        problem
    }
}

impl OpenCases {
    pub fn new(plan: &TestPlan) -> Self {
        let paths = plan.cases.iter().flat_map(|cases| cases.required_paths());
        let awaited = paths.map(str::to_owned).collect();
        let settings = &plan.settings;
        let has_history = plan.cases_in_programs.is_some()
            && settings.after_collapse == AfterCollapse::Rerun
            && !settings.shared;
        let history = has_history.then(Box::default);
        Self { awaited, history, ..Self::default() }
    }

    /// Adds cases of an earlier attempt.
    fn carry(&mut self, carried: CarriedCases) {
        (self.started, self.carried) = (carried.count(), carried.count());
        self.any_carried_passed = carried.any_passed();
        for name in carried.top_names() {
            unique(&mut self.names, None, name.to_owned());
        }
        if !self.awaited.is_empty() {
            let paths = carried.paths();
            self.awaited.retain(|awaited| !paths.contains(awaited));
        }
        self.history = Some(Box::new(carried.into_history()));
    }

    /// Names a case that starts, and returns whether another one has the same name.
    fn name(&mut self, start: &CaseStart) -> (CaseName, bool) {
        if let Some(due) = self.reruns.take(start) {
            return (due.next(), false);
        }
        let host_name = start.name.clone();
        let (name, is_repeated) = unique(&mut self.names, start.parent, start.name.clone());
        (CaseName { host_name, name, attempt: 1 }, is_repeated)
    }

    /// Returns the number in this attempt of a case that the host numbered.
    fn number(&self, case: CaseId) -> Option<CaseId> {
        case.0.checked_add(self.carried).map(CaseId)
    }

    /// Returns the case that the host numbered, if it is open.
    pub fn open(&self, case: Option<CaseId>) -> Option<CaseId> {
        let case = self.number(case?)?;
        self.open.iter().any(|open| open.id == case).then_some(case)
    }

    fn is_top(&self, case: CaseId) -> bool {
        self.open.iter().any(|open| open.id == case && open.parent.is_none())
    }

    pub fn get_mut(&mut self, case: CaseId) -> Option<&mut OpenCase> {
        self.open.iter_mut().rfind(|open| open.id == case)
    }

    /// Why a test that would pass does not: planned cases did not run.
    pub fn not_run_problem(&self) -> Option<String> {
        let missing = self.planned.len();
        if missing == 0 {
            return self.awaited.first().map(|path| format!("the test has no case `{path}`"));
        }
        let names: Vec<_> =
            self.planned.names().take(NAMES_SHOWN).map(|name| format!("`{name}`")).collect();
        let dots = if missing > NAMES_SHOWN { ", …" } else { "" };
        let (all, names) = (self.announced, names.join(", "));
        Some(format!("{missing} of {all} planned cases did not run: {names}{dots}"))
    }
}

/// Returns the innermost open case inside of `open`, and records it for the case around it.
fn open_inside(innermost: &mut HashMap<CaseId, CaseId>, open: &OpenCase) -> Option<CaseId> {
    let inside = innermost.get(&open.id).copied();
    if let Some(parent) = open.parent {
        innermost.entry(parent).or_insert(inside.unwrap_or(open.id));
    }
    inside
}

impl TestRun<'_> {
    pub(super) fn plan_cases(&mut self, names: Vec<String>, cx: &mut Context<'_>) {
        if self.evidence.answer.is_some() {
            return self.on_protocol_error("planned cases after the test's end".to_owned(), cx);
        }
        let cases = &mut self.cases;
        let counts = &mut cases.planned_names;
        let names = names.into_iter().map(|name| unique(counts, None, name));
        let (names, repeated): (Vec<_>, Vec<_>) = names.unzip();
        cases.announced += names.len();
        cases.planned.announce(names.iter().cloned());
        if let Some(history) = &mut cases.history {
            history.plan(&names);
            if repeated.contains(&true) {
                history.on_repeated_name();
            }
        }
        cx.emit(EventKind::CasesPlanned { test: self.plan.id, names });
    }

    pub(super) fn start_case(&mut self, mut start: CaseStart, cx: &mut Context<'_>) {
        if self.phase != Phase::Run || self.evidence.answer.is_some() {
            let what = format!("started the case `{}` in {}", start.name, self.phase);
            return self.on_protocol_error(what, cx);
        }
        let cases = &mut self.cases;
        let last = cases.started - cases.carried;
        if start.case.0 != last + 1 {
            let what = format!("started case {} after case {last}", start.case);
            return self.on_protocol_error(what, cx);
        }
        let is_episode = match self.start_episode(&mut start, cx.now()) {
            Ok(is_episode) => is_episode,
            Err(what) => return self.on_protocol_error(what, cx),
        };
        let cases = &mut self.cases;
        cases.started += 1;
        start.case = CaseId(cases.started);
        start.parent = cases.open(start.parent);
        if start.name.trim().is_empty() {
            start.name = format!("case {}", start.case);
        }
        let (name, is_repeated) = match is_episode {
            // Its name is its id.
            true => {
                (CaseName { host_name: String::new(), name: start.name.clone(), attempt: 1 }, false)
            }
            false => cases.name(&start),
        };
        (start.name, start.earlier_attempts) = (name.name.clone(), name.attempt - 1);
        let parent = start.parent.and_then(|id| cases.get_mut(id));
        let path = parent.map_or(start.name.clone(), |it| format!("{}/{}", it.path, start.name));
        if start.parent.is_none() && name.attempt == 1 {
            cases.planned.start(&start.name);
        }
        cases.awaited.retain(|awaited| *awaited != path);
        // The framework of a program may run a case several times.
        if is_repeated && self.plan.cases_in_programs.is_none() {
            let message =
                format!("two cases of `{}` have one name; one is `{path}`", self.plan.name);
            cx.emit(EventKind::Warning {
                diagnostic: Diagnostic::warning("repeated-case", message),
            });
        }
        let parent = start.parent;
        cases.open.push(OpenCase::new(start.case, parent, name, path));
        let started = CaseStarted { test: self.plan.id, start };
        if let Some(history) = &mut cases.history {
            history.start(&started.start, cx.now());
            if is_repeated && parent.is_none() {
                history.on_repeated_name();
            }
        }
        cx.emit(EventKind::CaseStarted(Box::new(started)));
    }

    pub(super) fn finish_case(&mut self, finished: FinishedCase, cx: &mut Context<'_>) {
        let FinishedCase { case, outcome, reason, duration_us, rerun, episode } = finished;
        let Some(number) = self.cases.open(Some(case)) else {
            return self.on_protocol_error(format!("finished case {case}, which is not open"), cx);
        };
        if self.cases.open.iter().any(|open| open.parent == Some(number)) {
            let what = format!("finished case {case} before a case that it contains");
            return self.on_protocol_error(what, cx);
        }
        let verdict = match outcome {
            None | Some(Outcome::Passed) => Verdict::Passed,
            Some(Outcome::Failed) => Verdict::Failed,
            Some(Outcome::Error) => Verdict::Error,
            Some(Outcome::Interrupted) => Verdict::Interrupted,
            Some(Outcome::Skipped) => Verdict::Skipped,
            Some(Outcome::Crashed) => Verdict::Crashed,
            Some(Outcome::TimedOut) => Verdict::TimedOut,
        };
        let result = match rerun && self.cases.is_top(number) {
            true => CaseResult::Attempt(verdict, reason),
            false => CaseResult::Case(verdict, reason),
        };
        self.end_case(number, result, (duration_us, episode), cx);
    }

    /// Adds the finished cases of an earlier attempt.
    pub fn carry(&mut self, carried: CarriedCases, cx: &mut Context<'_>) {
        self.selects_cases = true;
        carried.report(self.plan.id, cx);
        for problem in carried.problems() {
            TestProblem::keep_worse(&mut self.evidence.case_problem, problem.clone());
        }
        self.cases.carry(carried);
    }

    /// Finishes the cases that the test left open, the innermost first.
    pub(super) fn close_cases(&mut self, cx: &mut Context<'_>) {
        self.evidence.open_case = self.cases.open.last().map(|open| (open.id, open.path.clone()));
        let Judgement { verdict, reason, .. } = judge(&self.evidence, self.phase);
        let ended = self.evidence.stopped.is_some() || verdict == Verdict::Crashed;
        // Of several episodes, it is unknown which one ended the test: none has a result.
        let is_lost = self.slots.as_ref().is_some_and(|slots| slots.are_several_open());
        let verdict = if ended && is_lost { Verdict::Interrupted } else { verdict };
        let mut innermost = HashMap::new();
        while let Some(open) = self.cases.open.last() {
            let has_problem = open.first_problem.is_some() || open.inner_problem.is_some();
            let result = match (ended, has_problem) {
                (true, _) => {
                    let innermost = open_inside(&mut innermost, open);
                    CaseResult::Test { verdict, reason: reason.clone(), innermost }
                }
                (false, true) => CaseResult::Case(Verdict::Passed, None),
                (false, false) => {
                    let reason = "the test ended before the case".to_owned();
                    CaseResult::Case(Verdict::Error, Some(reason))
                }
            };
            self.end_case(open.id, result, (None, None), cx);
        }
        let result = ended.then_some((verdict, reason));
        self.close_reruns(result.as_ref(), cx);
    }

    /// Ends the cases whose next attempts did not start, as the test if that was ended.
    fn close_reruns(&mut self, ended: Option<&(Verdict, Option<String>)>, cx: &mut Context<'_>) {
        while let Some(due) = self.cases.reruns.pop() {
            self.cases.started += 1;
            let case = CaseId(self.cases.started);
            let CaseName { name, attempt, .. } = due.next();
            let start = CaseStart { earlier_attempts: attempt - 1, ..CaseStart::new(case, name) };
            let started = CaseStarted { test: self.plan.id, start };
            if let Some(history) = &mut self.cases.history {
                history.start(&started.start, cx.now());
            }
            let path = started.start.name.clone();
            cx.emit(EventKind::CaseStarted(Box::new(started)));
            self.cases.open.push(OpenCase::new(case, None, due.next(), path));
            let result = match ended {
                Some((verdict, reason)) => {
                    let (verdict, reason, innermost) = (*verdict, reason.clone(), None);
                    CaseResult::Test { verdict, reason, innermost }
                }
                None => CaseResult::Case(Verdict::Error, Some(due.not_started())),
            };
            self.end_case(case, result, (None, None), cx);
        }
    }

    /// Judges a case: by its first problem, an inner problem, or `result` if that is worse.
    fn end_case(
        &mut self,
        case: CaseId,
        result: CaseResult,
        (duration_us, episode): (Option<u64>, Option<Box<EpisodeEnd>>),
        cx: &mut Context<'_>,
    ) {
        let Some(index) = self.cases.open.iter().rposition(|open| open.id == case) else { return };
        let mut open = self.cases.open.remove(index);
        self.slots.iter_mut().for_each(|slots| slots.end(case, cx.now()));
        let (test, phase) = (self.plan.id, self.phase);
        let mut problem = open.take_problem();
        let rerun = matches!(result, CaseResult::Attempt(..));
        let (is_of_test, mut verdict, mut reason, mut decided_by) = match result {
            CaseResult::Case(verdict, reason) | CaseResult::Attempt(verdict, reason) => {
                (false, verdict, reason, None)
            }
            CaseResult::Test { verdict, reason, innermost } => (true, verdict, reason, innermost),
        };
        if let (Verdict::Passed, None, Some(leak)) = (verdict, &problem, open.leak.take()) {
            (verdict, reason) = (Verdict::Error, Some(leak));
        }
        match &problem {
            Some(problem) if problem.verdict.severity() >= verdict.severity() => {
                (verdict, reason) = (problem.verdict, Some(problem.reason.clone()));
                decided_by = problem.case;
            }
            _ if !is_of_test && verdict.is_problem() => {
                let reason = reason.clone().unwrap_or_else(|| format!("it is {verdict}"));
                problem = Some(TestProblem { verdict, reason, phase, case: None });
            }
            _ => {}
        }
        let outer = problem.map(|problem| open.describe(problem));
        let carried = false;
        let end = CaseFinished {
            test,
            case,
            verdict,
            reason,
            decided_by,
            duration_us,
            carried,
            rerun,
            episode,
        };
        if let Some(history) = &mut self.cases.history {
            history.finish(&end, outer.as_ref(), cx.now());
        }
        cx.emit(EventKind::CaseFinished(end));
        if rerun {
            return self.cases.reruns.add(open.name, outer);
        }
        if let Some(problem) = outer {
            let kept = match open.parent.and_then(|parent| self.cases.get_mut(parent)) {
                Some(parent) => &mut parent.inner_problem,
                None => &mut self.evidence.case_problem,
            };
            TestProblem::keep_worse(kept, problem);
        }
    }
}
