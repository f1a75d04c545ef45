//! Any program: its exit code is the verdict.

use rtf_model::{ExitStatus, Outcome};

use crate::case::CaseResult;
use crate::framework::{Framework, Launch};
use crate::last_output::LastOutput;

/// The exit code of a test that skips itself, as in Automake and Meson.
const SKIPPED: i32 = 77;

/// A shell's exit code for a program that cannot be executed.
const NOT_EXECUTABLE: i32 = 126;

/// A shell's exit code for a program that does not exist.
const NOT_FOUND: i32 = 127;

#[derive(Clone, Copy, Debug)]
pub struct Program;

impl Framework for Program {
    fn watches_output(&self, _launch: &Launch<'_>) -> bool {
        true
    }

    fn program_result(&self, end: ExitStatus, output: &LastOutput) -> Option<CaseResult> {
        let with_line = |reason: String| match output.failure_line() {
            None => reason,
            Some(line) => format!("{reason}: {line}"),
        };
        Some(match end {
            ExitStatus::Code(0) => CaseResult::default(),
            ExitStatus::Code(SKIPPED) => {
                let reason = output.last_error_line();
                CaseResult::new(Outcome::Skipped, reason.as_deref().unwrap_or("exit code 77"))
            }
            ExitStatus::Code(code @ (NOT_EXECUTABLE | NOT_FOUND)) => {
                let what = if code == NOT_FOUND { "was not found" } else { "cannot be executed" };
                let reason = format!("exit code {code}: a program {what}");
                CaseResult::new(Outcome::Error, with_line(reason))
            }
            ExitStatus::Code(_) => CaseResult::new(Outcome::Failed, with_line(end.to_string())),
            ExitStatus::Signal(_) => CaseResult::new(
                Outcome::Crashed,
                with_line(format!("the program ended with {end}")),
            ),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::last_output::OutputStream;

    fn result(end: ExitStatus, line: &str) -> (Option<Outcome>, Option<String>) {
        let mut output = LastOutput::default();
        output.add(OutputStream::Stderr, line.as_bytes());
        let result = Program.program_result(end, &output).unwrap();
        (result.outcome, result.reason)
    }

    #[test]
    fn exit_codes() {
        let with = |outcome, reason: &str| (Some(outcome), Some(reason.to_owned()));
        assert_eq!(result(ExitStatus::Code(0), "warning"), (None, None));
        assert_eq!(result(ExitStatus::Code(77), "no arm"), with(Outcome::Skipped, "no arm"));
        assert_eq!(result(ExitStatus::Code(77), ""), with(Outcome::Skipped, "exit code 77"));
        assert_eq!(
            result(ExitStatus::Code(3), "too slow"),
            with(Outcome::Failed, "exit code 3: too slow")
        );
        let missing = result(ExitStatus::Code(127), "sh: 1: x: not found");
        let text = "exit code 127: a program was not found: sh: 1: x: not found";
        assert_eq!(missing, with(Outcome::Error, text));
        let crash = result(ExitStatus::Signal(11), "");
        assert_eq!(crash, with(Outcome::Crashed, "the program ended with signal 11 (SIGSEGV)"));
    }
}
