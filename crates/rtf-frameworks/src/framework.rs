//! The functions that each framework's adapter implements.

use std::collections::HashMap;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::Command;

use rtf_model::ExitStatus;
use rtf_model::protocol::CaseSelector;

use crate::case::{CaseResult, ListedCase, Repetition, Selection};
use crate::case_reporter::CaseReporter;
use crate::last_output::{LastOutput, OutputStream};

/// A test of a suite: a program of a framework, or files and directories with its tests.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TestProgram {
    /// The file or directory, absolute.
    pub file: PathBuf,
    /// Arguments from the suite.
    pub args: Vec<String>,
}

impl TestProgram {
    /// The command that starts it with its arguments.
    #[must_use]
    pub fn command(&self) -> Command {
        let mut command = Command::new(&self.file);
        command.args(&self.args);
        command
    }
}

/// Why a program is no test of its framework.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct ListError {
    /// What is wrong, and what would help.
    pub message: String,
    /// The line in the file, from 1.
    pub line: Option<u32>,
}

impl ListError {
    /// An error without a line.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), line: None }
    }
}

/// What an adapter needs to start a program.
#[derive(Clone, Debug)]
pub struct Launch<'a> {
    pub test: &'a TestProgram,
    pub cases: Selection<'a>,
    pub channel: OpenChannel,
    /// The selectors of the runner; all cases if there is none.
    pub wanted: &'a [CaseSelector],
    /// The cases that finished in earlier processes.
    pub finished: &'a HashMap<String, bool>,
    /// A directory for temporary files, which exists.
    pub scratch: &'a Path,
}

/// Where a program writes the report that a [`ReportReader`] reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReportChannel {
    /// Nowhere: reports arrive through `RTF_SESSION`, or there are none.
    None,
    /// To standard output. The reader passes on what is not part of the report with
    /// [`CaseReporter::output`].
    Stdout,
    /// To a descriptor that it inherits, which has a path.
    Descriptor,
    /// To a TCP connection to the loopback interface.
    Socket,
}

/// An open channel, for the command line of the program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OpenChannel {
    /// See [`ReportChannel::None`].
    None,
    /// See [`ReportChannel::Stdout`].
    Stdout,
    /// The path of the descriptor: `/dev/fd/7`.
    Descriptor(PathBuf),
    /// The address to which the program connects.
    Socket(SocketAddr),
}

/// How a hanging program is made to show its stacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StackDump {
    /// A debugger is attached.
    Debugger,
    /// It writes them to its output on this signal.
    SignalToOutput(rustix::process::Signal),
    /// It writes them on SIGUSR2 to the file in `RTF_STACK_FILE`.
    SignalToFile,
}

/// Part of a report that is not as the framework writes it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Garbage(pub String);

pub trait Framework {
    /// Lists the cases of a test; `None` if the framework cannot.
    ///
    /// # Errors
    /// The program cannot be started, or is no test of this framework.
    fn list(&self, _test: &TestProgram) -> Result<Option<Vec<ListedCase>>, ListError> {
        Ok(None)
    }

    /// Lists the cases for a run. Some frameworks announce them while they run.
    ///
    /// # Errors
    /// As for [`Self::list`].
    fn list_for_run(&self, test: &TestProgram) -> Result<Option<Vec<ListedCase>>, ListError> {
        self.list(test)
    }

    fn channel(&self) -> ReportChannel {
        ReportChannel::None
    }

    /// Whether [`ReportReader::output`] needs the program's output.
    fn watches_output(&self, _launch: &Launch<'_>) -> bool {
        false
    }

    /// Whether a process has one pipe for both outputs, which then are standard output. Only
    /// with [`Self::watches_output`].
    fn merges_output(&self, _launch: &Launch<'_>) -> bool {
        false
    }

    /// The command that runs cases. The supervisor adds its own environment variables, and
    /// sets streams and process group.
    ///
    /// # Errors
    /// The command cannot be made, with the reason.
    fn command(&self, launch: &Launch<'_>) -> Result<Command, String> {
        Ok(launch.test.command())
    }

    /// A reader for the report of one process. Called after [`Self::command`].
    fn reader(&self, _launch: &Launch<'_>) -> Box<dyn ReportReader> {
        Box::new(NoReport)
    }

    /// Whether a run of all cases neither runs nor reports the disabled ones.
    fn omits_disabled(&self) -> bool {
        false
    }

    /// Whether each case needs a process, in which the supervisor starts the case.
    fn needs_separate_processes(&self) -> bool {
        false
    }

    /// A command that starts the same program with the same environment as [`Self::command`],
    /// but would only list the cases; `None` if the program's processes must be executed.
    fn fork_server_command(&self, _test: &TestProgram) -> Option<Command> {
        None
    }

    /// Whether the program opens its report with functions of the C library, which `librtf-report.so`
    /// replaces to keep the report from descendants.
    fn has_own_report(&self) -> bool {
        false
    }

    /// The cases to run for these selected ones, in order: a framework may add cases on
    /// which others depend.
    fn execution_order(
        &self,
        _listed: &[ListedCase],
        selected: Vec<ListedCase>,
    ) -> Vec<ListedCase> {
        selected
    }

    /// The result of a case that need not run, given the results so far (true: without a
    /// problem).
    fn decide(&self, _case: &ListedCase, _results: &HashMap<String, bool>) -> Option<CaseResult> {
        None
    }

    /// How often each case runs, if each one has a process.
    fn repetition(&self, _test: &TestProgram) -> Repetition {
        Repetition::Once
    }

    /// The result of a test without cases.
    fn program_result(&self, _end: ExitStatus, _output: &LastOutput) -> Option<CaseResult> {
        None
    }

    /// Whether this exit code is right, given whether a case has a problem.
    fn accepts_exit(&self, code: i32, has_problem: bool) -> bool {
        code == 0 || has_problem
    }

    /// Whether a complete report ends with `finished`.
    fn announces_end(&self) -> bool {
        false
    }

    fn stack_dump(&self) -> StackDump {
        StackDump::Debugger
    }
}

/// Reads the report of one process.
pub trait ReportReader {
    /// Reads the next bytes of the report.
    ///
    /// # Errors
    /// They are not part of a report; no further ones are read.
    fn report(&mut self, _bytes: &[u8], _cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        Ok(())
    }

    /// Reads output that the program wrote, which is passed on in any case.
    fn output(&mut self, _stream: OutputStream, _bytes: &[u8], _cases: &mut CaseReporter<'_>) {}

    /// All output has been read that the program wrote before the report that was read.
    fn settle(&mut self, _cases: &mut CaseReporter<'_>) {}

    /// Whether there are cases that the reader has not reported yet.
    fn holds_back(&self) -> bool {
        false
    }

    /// Reports these cases: nothing has arrived for a moment.
    fn release(&mut self, _cases: &mut CaseReporter<'_>) {}

    /// Why the process died, if the report or the output says so. Called after
    /// [`Self::finish`].
    fn crash_reason(&self) -> Option<String> {
        None
    }

    /// The process has ended, and everything that it wrote was read.
    ///
    /// # Errors
    /// The report is incomplete although the program was not killed.
    fn finish(&mut self, end: ExitStatus, cases: &mut CaseReporter<'_>) -> Result<(), Garbage>;
}

/// The reader of a framework that reports through `RTF_SESSION`.
#[derive(Clone, Copy, Debug)]
pub struct NoReport;

impl ReportReader for NoReport {
    fn finish(&mut self, _end: ExitStatus, _cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        Ok(())
    }
}
