//! Decides the verdict of one attempt of a test. The first reported failure or error
//! decides; the host's own reason counts only if nothing was reported.

use rtf_model::protocol::{Answer, RpcError};
use rtf_model::{CaseId, ExitStatus, Finding, LeakedProcess, Outcome, Phase, StopCause, Verdict};

use rtf_plan::plan::Leaks;

/// A reported failure or error.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TestProblem {
    pub verdict: Verdict,
    pub reason: String,
    pub phase: Phase,
    /// The innermost case in which it was reported.
    pub case: Option<CaseId>,
}

/// The verdict of an attempt.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Judgement {
    pub verdict: Verdict,
    pub reason: Option<String>,
    /// The phase in which it was decided.
    pub phase: Phase,
    /// The case whose problem decided it, or in which the test ended.
    pub decided_by: Option<CaseId>,
}

impl Judgement {
    fn new(verdict: Verdict, reason: impl Into<Option<String>>, phase: Phase) -> Self {
        Self { verdict, reason: reason.into(), phase, decided_by: None }
    }

    /// The test ended in the open case.
    fn in_case(self, evidence: &Evidence) -> Self {
        Self { decided_by: evidence.open_case.as_ref().map(|(case, _)| *case), ..self }
    }
}

#[derive(Debug, Default)]
pub struct Evidence {
    pub stopped: Option<(StopCause, String, Phase)>,
    /// The first problem outside of cases.
    pub first_problem: Option<TestProblem>,
    /// The first of the worst problems in cases.
    pub case_problem: Option<TestProblem>,
    /// The innermost case that was open when the test was stopped or its process ended,
    /// and its path.
    pub open_case: Option<(CaseId, String)>,
    /// The host's answer to `run-test`.
    pub answer: Option<Result<Answer, RpcError>>,
    /// `None` if the process never started or is still alive.
    pub exit: Option<ExitStatus>,
    /// Whether its host stays alive for further tests.
    pub released: bool,
}

impl TestProblem {
    /// Keeps the worse of two problems, the first one if they are equally bad.
    pub fn keep_worse(kept: &mut Option<Self>, other: Self) {
        let severity = |problem: &Self| problem.verdict.severity();
        if kept.as_ref().is_none_or(|kept| severity(&other) > severity(kept)) {
            *kept = Some(other);
        }
    }
}

impl Evidence {
    /// Records a finding of a fixture. Its verdict holds in every phase: the fixture watches the
    /// robot, not what the plug-in does.
    pub fn record_finding(&mut self, finding: &Finding, phase: Phase) {
        let (verdict, reason) = (finding.severity.verdict(), finding.text.clone());
        self.first_problem.get_or_insert(TestProblem { verdict, reason, phase, case: None });
    }

    /// The worse of the problems inside and outside of cases.
    fn problem(&self) -> Option<TestProblem> {
        let mut problem = self.first_problem.clone();
        if let Some(in_case) = &self.case_problem {
            TestProblem::keep_worse(&mut problem, in_case.clone());
        }
        problem
    }
}

pub fn judge(evidence: &Evidence, last_phase: Phase) -> Judgement {
    if let Some((cause, reason, phase)) = &evidence.stopped {
        let verdict = match cause {
            StopCause::Timeout => Verdict::TimedOut,
            StopCause::Collapse => Verdict::Collapsed,
            StopCause::Interrupt => Verdict::Interrupted,
            StopCause::Protocol => Verdict::Error,
            StopCause::Finding => Verdict::Failed,
        };
        return Judgement::new(verdict, reason.clone(), *phase).in_case(evidence);
    }
    match &evidence.answer {
        None => judge_without_answer(evidence, last_phase),
        Some(Err(error)) => {
            let reason = format!("the host refused the test: {} ({})", error.message, error.code);
            Judgement::new(Verdict::Error, reason, last_phase)
        }
        Some(Ok(answer)) => judge_answer(evidence, answer, last_phase),
    }
}

fn judge_without_answer(evidence: &Evidence, phase: Phase) -> Judgement {
    if evidence.exit.is_none() {
        let problem = evidence.problem();
        let reason = problem.map_or("the host could not be started".to_owned(), |p| p.reason);
        return Judgement::new(Verdict::Error, reason, phase);
    }
    let status = status_of(evidence.exit);
    let place = match &evidence.open_case {
        Some((_, case)) => format!("case `{case}`"),
        None => phase.to_string(),
    };
    let mut reason =
        format!("the test's process ended in {place} with {status} before the test was over");
    if let Some(problem) = evidence.problem() {
        reason += &format!("; before that: {}", problem.reason);
    }
    Judgement::new(Verdict::Crashed, reason, phase).in_case(evidence)
}

fn judge_answer(evidence: &Evidence, answer: &Answer, last_phase: Phase) -> Judgement {
    let clean = evidence.released || evidence.exit == Some(ExitStatus::Code(0));
    let problem = evidence.problem().or_else(|| problem_of(answer, last_phase));
    match problem {
        None if clean && answer.outcome == Outcome::Skipped => {
            Judgement::new(Verdict::Skipped, answer.reason.clone(), last_phase)
        }
        None if clean => Judgement::new(Verdict::Passed, None, last_phase),
        None => {
            let status = status_of(evidence.exit);
            let reason = format!("the test's process ended with {status} after the test was over");
            Judgement::new(Verdict::Crashed, reason, Phase::Exit)
        }
        Some(mut problem) => {
            if !clean {
                let status = status_of(evidence.exit);
                problem.reason += &format!("; then the test's process ended with {status}");
            }
            let TestProblem { verdict, reason, phase, case } = problem;
            Judgement { verdict, reason: Some(reason), phase, decided_by: case }
        }
    }
}

fn problem_of(answer: &Answer, phase: Phase) -> Option<TestProblem> {
    let (verdict, default) = match answer.outcome {
        Outcome::Passed | Outcome::Skipped => return None,
        Outcome::Failed => (Verdict::Failed, "the test failed without a reason"),
        Outcome::Error => (Verdict::Error, "the test ended in an error without a reason"),
        Outcome::Interrupted => (Verdict::Error, "the test stopped without a request"),
        Outcome::Crashed => (Verdict::Crashed, "the test's program died"),
        Outcome::TimedOut => (Verdict::TimedOut, "the test's program took too long"),
    };
    let reason = answer.reason.clone().unwrap_or_else(|| default.to_owned());
    Some(TestProblem { verdict, reason, phase, case: None })
}

fn status_of(exit: Option<ExitStatus>) -> String {
    exit.map_or_else(|| "an unknown status".to_owned(), |status| status.to_string())
}

/// Why leaked processes make a passed test or case an error, if the plan says so.
pub fn leak_problem(policy: Leaks, leaked: &[LeakedProcess]) -> Option<String> {
    describe_leak(leaked).filter(|_| policy == Leaks::Fail)
}

/// Describes leaked processes in one line.
pub fn describe_leak(leaked: &[LeakedProcess]) -> Option<String> {
    match leaked {
        [] => None,
        [one] => Some(format!("it left a process behind: {}", one.command)),
        [first, ..] => {
            Some(format!("it left {} processes behind, first: {}", leaked.len(), first.command))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answered(outcome: Outcome, exit: ExitStatus) -> Evidence {
        let answer = Answer { outcome, reason: None, subscriptions: Vec::new(), continues: false };
        Evidence { answer: Some(Ok(answer)), exit: Some(exit), ..Evidence::default() }
    }

    #[test]
    fn a_pass_needs_an_answer_and_a_clean_exit() {
        let passed = answered(Outcome::Passed, ExitStatus::Code(0));
        assert_eq!(judge(&passed, Phase::Exit).verdict, Verdict::Passed);
        let crashed = answered(Outcome::Passed, ExitStatus::Signal(11));
        assert_eq!(judge(&crashed, Phase::Exit).verdict, Verdict::Crashed);
        let silent = Evidence { exit: Some(ExitStatus::Code(0)), ..Evidence::default() };
        assert_eq!(judge(&silent, Phase::Run).verdict, Verdict::Crashed);
    }

    #[test]
    fn processes_that_a_test_leaves_are_a_problem_if_its_plan_says_so() {
        let left = |commands: &[&str]| -> Vec<_> {
            let process = |command: &&str| LeakedProcess {
                pid: 1,
                command: (*command).to_owned(),
                owner: None,
            };
            commands.iter().map(process).collect()
        };
        assert_eq!(leak_problem(Leaks::Report, &left(&["sleep"])), None);
        assert_eq!(leak_problem(Leaks::Fail, &[]), None);
        let reason = |commands| leak_problem(Leaks::Fail, &left(commands)).unwrap();
        assert_eq!(reason(&["sleep"]), "it left a process behind: sleep");
        assert_eq!(reason(&["a", "b"]), "it left 2 processes behind, first: a");
    }

    #[test]
    fn a_reported_failure_decides_even_if_the_host_answers_passed() {
        let mut evidence = answered(Outcome::Passed, ExitStatus::Code(0));
        let reason = "the gripper is open".to_owned();
        evidence.first_problem = Some(TestProblem {
            verdict: Verdict::Failed,
            reason: reason.clone(),
            phase: Phase::Run,
            case: None,
        });
        assert_eq!(
            judge(&evidence, Phase::Exit),
            Judgement::new(Verdict::Failed, reason, Phase::Run)
        );
    }

    #[test]
    fn a_stop_decides_before_the_answer() {
        let mut evidence = answered(Outcome::Passed, ExitStatus::Code(0));
        evidence.stopped = Some((StopCause::Collapse, "gone".to_owned(), Phase::Run));
        assert_eq!(judge(&evidence, Phase::Exit).verdict, Verdict::Collapsed);
    }

    #[test]
    fn the_first_reported_problem_decides_over_the_hosts_reason() {
        let mut evidence = answered(Outcome::Failed, ExitStatus::Code(0));
        let verdict = |evidence: &Evidence| judge(evidence, Phase::Exit);
        let reason = |text: &str| Some(text.to_owned());
        let none = reason("the test failed without a reason");
        assert_eq!(verdict(&evidence), Judgement::new(Verdict::Failed, none, Phase::Exit));
        if let Some(Ok(answer)) = &mut evidence.answer {
            answer.reason = reason("set-up returned false");
        }
        assert_eq!(verdict(&evidence).reason, reason("set-up returned false"));
        evidence.first_problem = Some(TestProblem {
            verdict: Verdict::Error,
            reason: "no connection".to_owned(),
            phase: Phase::Setup,
            case: None,
        });
        let first = Judgement::new(Verdict::Error, reason("no connection"), Phase::Setup);
        assert_eq!(verdict(&evidence), first);
    }
}
