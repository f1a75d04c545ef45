//! Runs the cases of a test in one process after the other, until each selected case has
//! finished or the test is stopped.

mod fork_server;
mod process;
mod session_socket;
mod stack;
mod streams;
#[cfg(test)]
mod tests;

use std::cell::Cell;
use std::collections::VecDeque;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use rtf_host::Session;
use rtf_model::protocol::{CaseSelector, FixtureValue, Plugin};
use rtf_model::{ExitStatus, LeakedProcess, Outcome};
use rtf_process::tree::{self, Effort};
use rustix::process::{Pid, Signal, getpgid, kill_process_group};

use crate::case::{CaseResult, ListedCase, Repetition, Selection};
use crate::case_reporter::CaseReporter;
use crate::framework::{Framework, StackDump, TestProgram};
use crate::last_output::OutputStream;
use crate::wanted::WantedCases;
use fork_server::{ForkPoint, ForkServer};
use process::{ProcessEnd, Termination};
use streams::Source;

/// How long killed processes may take to end, and the time between polls.
const SWEEP_LIMIT: Duration = Duration::from_secs(5);
const SWEEP_INTERVAL: Duration = Duration::from_millis(1);

/// The process that runs cases at the moment, for other threads.
#[derive(Clone, Debug, Default)]
pub struct RunningProgram {
    pid: Arc<Mutex<Option<Pid>>>,
    /// Whether the runner had stacks dumped, which can end the program.
    was_dumped: Arc<AtomicBool>,
    /// Reads what its leftover processes print after a stop.
    rest: Arc<Mutex<Option<JoinHandle<()>>>>,
}

impl RunningProgram {
    fn set(&self, pid: Option<Pid>) {
        *self.pid.lock().unwrap_or_else(PoisonError::into_inner) = pid;
    }

    #[must_use]
    pub fn pid(&self) -> Option<Pid> {
        *self.pid.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether the runner had stacks dumped: it is about to stop the test.
    fn was_dumped(&self) -> bool {
        self.was_dumped.load(Ordering::Relaxed)
    }

    /// Reads the outputs of a stopped program until they are closed. Its report stays open so long.
    fn keep_reading(&self, outputs: Vec<(OutputStream, File)>, report: Option<Source>) {
        let read = move || {
            streams::pass_on(outputs);
            drop(report);
        };
        // Without a thread, the outputs are closed.
        let rest = std::thread::Builder::new().spawn(read).ok();
        *self.rest.lock().unwrap_or_else(PoisonError::into_inner) = rest;
    }

    /// Waits until nothing that a stopped program has started has its outputs.
    pub fn await_rest(&self) {
        let rest = self.rest.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(rest) = rest {
            drop(rest.join());
        }
    }

    /// Sends a signal to its process group.
    pub fn signal(&self, signal: Signal) {
        // The lock is held: the process is reaped only after it was removed here.
        let running = self.pid.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(pid) = *running {
            // Fails if all of them have ended.
            let _ = kill_process_group(pid, signal);
        }
    }
}

/// Dumps the stacks of the running program; `None` if there is none, or if they are in its
/// output.
#[must_use]
pub fn dump_stack(running: &RunningProgram, kind: StackDump, file: &Path) -> Option<String> {
    let Some(pid) = running.pid() else {
        let has_rest = running.rest.lock().unwrap_or_else(PoisonError::into_inner).is_some();
        return has_rest.then(|| "the program has ended, and left processes".to_owned());
    };
    running.was_dumped.store(true, Ordering::Relaxed);
    stack::dump(kind, pid, file)
}

fn group_of(pid: i32) -> Option<Pid> {
    getpgid(Some(Pid::from_raw(pid)?)).ok()
}

struct TestRun<'a> {
    framework: &'a dyn Framework,
    program: TestProgram,
    session: &'a Session,
    running: &'a RunningProgram,
    case_timeout: Option<Duration>,
    separate: bool,
    fork_point: ForkPoint,
    fixture_values: &'a [FixtureValue],
    /// The cases that the runner wants; all, if there is none.
    wanted: &'a [CaseSelector],
    /// For temporary files.
    scratch: &'a Path,
    /// Where the program writes its stacks on a signal.
    stack_file: PathBuf,
    /// Forks the processes of the program. Taken while a process starts.
    fork_server: Cell<Option<ForkServer>>,
}

/// Runs a test, and reports its cases and problems to the session.
pub fn run(
    framework: &dyn Framework,
    plugin: &Plugin,
    session: &Session,
    running: &RunningProgram,
    scratch: &Path,
) {
    let program = TestProgram { file: plugin.file.clone().into(), args: plugin.args.clone() };
    let mut cases = CaseReporter::new(session);
    let separate = plugin.separate_cases || framework.needs_separate_processes();
    let listed = match separate {
        true => framework.list(&program),
        false => framework.list_for_run(&program),
    };
    let listed = match listed {
        Ok(listed) => listed,
        Err(error) => return cases.test_error(error.message),
    };
    let run = TestRun {
        framework,
        program,
        session,
        running,
        case_timeout: plugin.case_timeout_ms.map(Duration::from_millis),
        separate,
        fork_point: if plugin.fork_at_main { ForkPoint::Main } else { ForkPoint::Start },
        fixture_values: &plugin.fixture_values,
        wanted: &plugin.cases,
        scratch,
        stack_file: scratch.join("stacks"),
        fork_server: Cell::default(),
    };
    match listed {
        Some(listed) => run.listed(&listed, &plugin.cases, &mut cases),
        None => run.unlisted(&plugin.cases, &mut cases),
    }
    if let (Some(count), false) = (cases.all_skipped(), run.is_stopping()) {
        let reason = match count {
            1 => "its only case was skipped".to_owned(),
            count => format!("all {count} cases were skipped"),
        };
        session.record_result(Outcome::Skipped, &reason);
    }
}

impl TestRun<'_> {
    /// Whether the runner stops the test, or is about to.
    fn is_stopping(&self) -> bool {
        self.session.interrupted() || self.running.was_dumped()
    }

    /// Runs a test whose cases are known.
    fn listed(&self, listed: &[ListedCase], wanted: &[CaseSelector], cases: &mut CaseReporter<'_>) {
        let wanted = WantedCases::new(wanted, listed.iter().map(|case| case.name.as_str()));
        let selected = listed.iter().filter(|case| wanted.includes(&case.name));
        let selected: Vec<ListedCase> = selected.cloned().collect();
        let is_all = selected.len() == listed.len();
        let selected = self.framework.execution_order(listed, selected);
        if selected.is_empty() {
            let text = match wanted.is_all() {
                true => "the program has no case",
                false => "the program has none of the selected cases",
            };
            return cases.test_error(text.to_owned());
        }
        cases.plan(selected.iter().map(|case| case.name.clone()));
        let mut queue = VecDeque::with_capacity(selected.len());
        let mut all_run = is_all;
        for case in selected {
            if case.disabled {
                let reason = case.disabled_reason.as_deref().unwrap_or("disabled");
                cases.add(case.start(), CaseResult::new(Outcome::Skipped, reason));
                all_run &= self.framework.omits_disabled();
            } else {
                queue.push_back(case);
            }
        }
        if self.separate && queue.len() > 1 {
            self.fork_server.set(self.start_fork_server());
        }
        while !queue.is_empty() && !self.is_stopping() {
            let goes_on = if self.separate {
                queue.pop_front().is_some_and(|case| self.separate_case(&case, cases))
            } else {
                let selection = Selection { cases: queue.make_contiguous(), is_all: all_run };
                let goes_on = self.process(selection, cases);
                queue.retain(|case| !cases.results().contains_key(&case.name));
                all_run = false;
                goes_on
            };
            if !goes_on {
                break;
            }
        }
        if let (Some(missing), false) = (cases.missing(), self.is_stopping()) {
            cases.test_error(missing);
        }
    }

    fn start_fork_server(&self) -> Option<ForkServer> {
        let command = self.framework.fork_server_command(&self.program)?;
        ForkServer::start(command, self.fork_point, self.scratch, || self.is_stopping())
    }

    /// Runs a test whose cases are not known, or are announced by the program.
    fn unlisted(&self, wanted: &[CaseSelector], cases: &mut CaseReporter<'_>) {
        cases.want(wanted);
        loop {
            let before = cases.results().len();
            let goes_on = self.process(Selection { cases: &[], is_all: true }, cases);
            let has_rest = cases.missing().is_some();
            let made_progress = cases.results().len() > before;
            if !(goes_on && has_rest && made_progress) || self.is_stopping() {
                break;
            }
        }
        if let (Some(missing), false) = (cases.missing(), self.is_stopping()) {
            cases.test_error(missing);
        }
    }

    /// Runs one case in a process. Returns whether to continue.
    fn separate_case(&self, case: &ListedCase, cases: &mut CaseReporter<'_>) -> bool {
        if let Some(result) = self.framework.decide(case, cases.results()) {
            cases.add(case.start(), result);
            return true;
        }
        let repetition = self.framework.repetition(&self.program);
        for run in 1..=repetition.times() {
            cases.retry(repetition.retry().filter(|_| run < repetition.times()));
            if self.framework.needs_separate_processes() {
                cases.start(case.start());
            }
            let cases_of_process = std::slice::from_ref(case);
            self.process(Selection { cases: cases_of_process, is_all: false }, cases);
            let has_passed = cases.results().get(&case.name).copied();
            let goes_on = match repetition {
                Repetition::UntilFail(_) => has_passed == Some(true),
                _ => has_passed.is_none(),
            };
            if !goes_on || self.is_stopping() {
                break;
            }
        }
        cases.retry(None);
        // The next case does not depend on how this process ended.
        true
    }

    /// Runs cases in a new process. Returns whether to continue with the remaining ones.
    fn process(&self, selection: Selection<'_>, cases: &mut CaseReporter<'_>) -> bool {
        cases.begin_process(&selection);
        let limit = match selection.cases {
            [case] => self.case_timeout.into_iter().chain(case.timeout).min(),
            _ => self.case_timeout,
        };
        let goes_on = match process::run(self, selection, limit, cases) {
            Ok(end) => self.conclude(&end, selection, cases),
            Err(reason) => {
                cases.end_open(&CaseResult::new(Outcome::Error, reason.clone()));
                cases.test_error(reason);
                false
            }
        };
        cases.end_process();
        goes_on
    }

    /// Kills what a process of the program left behind, which this process has adopted. Returns
    /// the killed processes, without those of `killed_group`, when all have ended.
    fn sweep(&self, killed_group: Option<Pid>) -> Vec<LeakedProcess> {
        let server = self.fork_server.take();
        let server_group = server.as_ref().map(ForkServer::pid);
        self.fork_server.set(server);
        // The process that is forked ahead is in the group of the server.
        let is_ahead = |orphan: i32| group_of(orphan).is_some_and(|it| Some(it) == server_group);
        let was_killed = |orphan: i32| group_of(orphan).is_some_and(|it| Some(it) == killed_group);
        let belongs = |orphan| !is_ahead(orphan) && !was_killed(orphan);
        tree::await_ending(belongs);
        let deadline = Instant::now() + SWEEP_LIMIT;
        let mut left = Vec::new();
        loop {
            tree::add_new(&mut left, tree::sweep_if(Effort::Once, belongs));
            if tree::orphans().all(is_ahead) || Instant::now() >= deadline {
                return left;
            }
            std::thread::sleep(SWEEP_INTERVAL);
        }
    }

    /// Judges the end of a process. Returns whether to continue with the remaining cases.
    fn conclude(
        &self,
        end: &ProcessEnd,
        selection: Selection<'_>,
        cases: &mut CaseReporter<'_>,
    ) -> bool {
        let status = end.status;
        match &end.termination {
            Termination::Stopped => return false,
            Termination::Garbage(garbage) => {
                let text = format!("the report of the program is damaged: {garbage}");
                cases.end_open(&CaseResult::new(Outcome::Error, text.clone()));
                cases.test_error(text);
                return false;
            }
            Termination::CaseTimeout(limit) => {
                let reason = format!("the case took longer than {limit:?}");
                cases.end_open(&CaseResult::new(Outcome::TimedOut, reason));
                return true;
            }
            Termination::Exited => {}
        }
        if let Some(result) = self.framework.program_result(status, &end.last_output) {
            let reason = result.reason.unwrap_or_default();
            self.session.record_result(result.outcome.unwrap_or(Outcome::Passed), &reason);
            return false;
        }
        if cases.innermost().is_some() {
            let ended = || format!("the program ended in the case with {status}");
            let reason = end.crash_reason.clone().unwrap_or_else(ended);
            cases.end_open(&CaseResult::new(Outcome::Crashed, reason));
            return true;
        }
        self.conclude_idle(status, selection, cases)
    }

    /// Judges the end of a process in which no case was running.
    fn conclude_idle(
        &self,
        status: ExitStatus,
        selection: Selection<'_>,
        cases: &mut CaseReporter<'_>,
    ) -> bool {
        let awaited = |case: &&ListedCase| cases.is_awaited(&case.name);
        let has_rest = match selection.cases {
            [] => cases.missing().is_some(),
            selected => selected.iter().any(|case| awaited(&case)),
        };
        match status {
            ExitStatus::Signal(_) => {
                let place = match cases.last_finished() {
                    Some(case) if has_rest => format!("after the case `{case}`"),
                    Some(_) => "after its last case".to_owned(),
                    None => "before its first case".to_owned(),
                };
                let reason = format!("the program ended {place} with {status}");
                self.session.record_result(Outcome::Crashed, &reason);
                has_rest && cases.finished() > 0
            }
            ExitStatus::Code(code) => {
                if !self.framework.accepts_exit(code, cases.has_problem()) {
                    cases.test_error(match cases.finished() {
                        0 => format!("the program ended with {status} and reported no case"),
                        _ => format!(
                            "the program ended with {status} although no case has a problem"
                        ),
                    });
                } else if self.framework.announces_end() && !cases.is_complete() {
                    cases.test_error(format!(
                        "the program ended with {status} before its report was complete"
                    ));
                } else if cases.has_no_result() && !has_rest {
                    cases.test_error(format!(
                        "the program ended with {status} and reported no case"
                    ));
                }
                false
            }
        }
    }
}
