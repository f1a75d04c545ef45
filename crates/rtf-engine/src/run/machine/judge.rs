//! The verdict over one attempt of a test, from all that was seen of it.

use rtf_model::protocol::{Answer, RpcError};
use rtf_model::{ExitStatus, LeakedProcess, Outcome, Phase, StopCause, Verdict};

use rtf_plan::plan::Leaks;

/// A first failure or error, which decides.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    pub verdict: Verdict,
    pub reason: String,
    pub phase: Phase,
}

/// What was seen of an attempt that is over.
#[derive(Debug, Default)]
pub struct Evidence {
    /// Why it was asked to stop, if it was.
    pub stopped: Option<(StopCause, String, Phase)>,
    /// Its first failure or error.
    pub first_problem: Option<Problem>,
    /// What the host answered to `run-test`.
    pub answer: Option<Result<Answer, RpcError>>,
    /// How the process ended; `None` when it never started, or lives.
    pub exit: Option<ExitStatus>,
    /// Whether its host has gone on to the next test, or waits for one.
    pub released: bool,
}

/// The judgement.
pub fn judge(evidence: &Evidence, last_phase: Phase) -> (Verdict, Option<String>, Phase) {
    if let Some((cause, reason, phase)) = &evidence.stopped {
        let verdict = match cause {
            StopCause::Timeout => Verdict::TimedOut,
            StopCause::Collapse => Verdict::Collapsed,
            StopCause::Interrupt => Verdict::Interrupted,
            StopCause::Protocol => Verdict::Error,
        };
        return (verdict, Some(reason.clone()), *phase);
    }
    match &evidence.answer {
        None => judge_without_answer(evidence, last_phase),
        Some(Err(error)) => {
            let reason = format!("the host refused the test: {} ({})", error.message, error.code);
            (Verdict::Error, Some(reason), last_phase)
        }
        Some(Ok(answer)) => judge_answer(evidence, answer, last_phase),
    }
}

fn judge_without_answer(evidence: &Evidence, phase: Phase) -> (Verdict, Option<String>, Phase) {
    if evidence.exit.is_none() {
        let problem = evidence.first_problem.as_ref();
        let reason = problem.map_or("the host could not be started", |p| &p.reason);
        return (Verdict::Error, Some(reason.to_owned()), phase);
    }
    let how = ended(evidence.exit);
    let mut reason =
        format!("the test's process ended in {phase} with {how} before the test was over");
    if let Some(problem) = &evidence.first_problem {
        reason += &format!("; before that: {}", problem.reason);
    }
    (Verdict::Crashed, Some(reason), phase)
}

fn judge_answer(
    evidence: &Evidence,
    answer: &Answer,
    last_phase: Phase,
) -> (Verdict, Option<String>, Phase) {
    let clean = evidence.released || evidence.exit == Some(ExitStatus::Code(0));
    let problem = evidence.first_problem.clone().or_else(|| from_answer(answer, last_phase));
    match problem {
        None if clean => (Verdict::Passed, None, last_phase),
        None => {
            let how = ended(evidence.exit);
            let reason = format!("the test's process ended with {how} after the test was over");
            (Verdict::Crashed, Some(reason), Phase::Exit)
        }
        Some(mut problem) => {
            if !clean {
                let how = ended(evidence.exit);
                problem.reason += &format!("; then the test's process ended with {how}");
            }
            (problem.verdict, Some(problem.reason), problem.phase)
        }
    }
}

/// The host's own word, when no message told of a problem.
fn from_answer(answer: &Answer, phase: Phase) -> Option<Problem> {
    let (verdict, default) = match answer.outcome {
        Outcome::Passed => return None,
        Outcome::Failed => (Verdict::Failed, "the host says that the test failed"),
        Outcome::Error => (Verdict::Error, "the host says that the test went wrong"),
        Outcome::Interrupted => (Verdict::Error, "the test stopped although it was not asked to"),
    };
    let reason = answer.reason.clone().unwrap_or_else(|| default.to_owned());
    Some(Problem { verdict, reason, phase })
}

fn ended(exit: Option<ExitStatus>) -> String {
    exit.map_or_else(|| "an unknown status".to_owned(), |status| status.to_string())
}

/// What is said of a test that passed and left processes behind, if that counts.
pub fn leak_of(leaks: Leaks, left: &[LeakedProcess]) -> Option<String> {
    match (leaks, left) {
        (Leaks::Report, _) | (_, []) => None,
        (Leaks::Fail, [one]) => Some(format!("it left a process behind: {}", one.command)),
        (Leaks::Fail, [first, ..]) => {
            Some(format!("it left {} processes behind, first: {}", left.len(), first.command))
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
    fn only_an_answer_and_a_clean_end_pass() {
        let passed = answered(Outcome::Passed, ExitStatus::Code(0));
        assert_eq!(judge(&passed, Phase::Exit).0, Verdict::Passed);
        let crashed = answered(Outcome::Passed, ExitStatus::Signal(11));
        assert_eq!(judge(&crashed, Phase::Exit).0, Verdict::Crashed);
        let silent = Evidence { exit: Some(ExitStatus::Code(0)), ..Evidence::default() };
        assert_eq!(judge(&silent, Phase::Run).0, Verdict::Crashed);
    }

    #[test]
    fn a_host_that_hides_a_failure_is_not_believed() {
        let mut evidence = answered(Outcome::Passed, ExitStatus::Code(0));
        let reason = "the gripper is open".to_owned();
        evidence.first_problem =
            Some(Problem { verdict: Verdict::Failed, reason: reason.clone(), phase: Phase::Run });
        assert_eq!(judge(&evidence, Phase::Exit), (Verdict::Failed, Some(reason), Phase::Run));
    }

    #[test]
    fn a_stop_decides_whatever_the_host_answers() {
        let mut evidence = answered(Outcome::Passed, ExitStatus::Code(0));
        evidence.stopped = Some((StopCause::Collapse, "gone".to_owned(), Phase::Run));
        assert_eq!(judge(&evidence, Phase::Exit).0, Verdict::Collapsed);
    }
}
