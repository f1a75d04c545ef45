//! `rtf run --debug`: changes the plan of the only test, and says where its process is
//! (`spec/debugging.md`).

use std::io::{IsTerminal, stdin};
use std::os::unix::process::parent_id;
use std::process::id;
use std::sync::Arc;
use std::time::Duration;

use rtf_engine::run::{DebugMode, DebugOptions};
use rtf_plan::plan::{Plan, TestLimits, TestPlan};

use crate::diagnostics::count;
use crate::error::Failure;
use crate::terminal;

/// Longer than a session.
const UNLIMITED: Duration = Duration::from_secs(365 * 24 * 60 * 60);
/// Maximum number of candidates in the error.
const CANDIDATES: usize = 20;

/// How a test is debugged.
#[derive(Clone, Debug)]
pub struct DebugRequest {
    mode: DebugMode,
    /// The words before the command of the test's host.
    debugger: Vec<String>,
}

impl DebugRequest {
    /// The test waits for a debugger.
    pub fn waiting() -> Self {
        Self { mode: DebugMode::Wait, debugger: Vec::new() }
    }

    /// The test gets the terminal, and the command of a debugger before that of its host.
    pub fn in_terminal(debugger: Option<&str>) -> Result<Self, Failure> {
        let debugger = debugger.map(split).transpose()?.unwrap_or_default();
        if !stdin().is_terminal() {
            let error = "standard input is no terminal that the test could get";
            return Err(Failure::input(error).hint("without a terminal, use `--debug-wait`"));
        }
        Ok(Self { mode: DebugMode::Terminal, debugger })
    }

    /// The options of the run.
    pub fn options(&self) -> DebugOptions {
        DebugOptions { mode: self.mode, notify }
    }

    /// Whether the test has the terminal.
    pub fn takes_terminal(&self) -> bool {
        self.mode == DebugMode::Terminal
    }

    /// Removes the limits of the only test, and gives it its own process.
    pub fn prepare(&self, plan: &mut Plan) -> Result<(), Failure> {
        if plan.tests != 1 {
            return Err(too_many(plan));
        }
        let Some(suite) = plan.suites.iter_mut().find(|suite| !suite.tests.is_empty()) else {
            return Ok(());
        };
        suite.settings.timeout = None;
        suite.tests.iter_mut().try_for_each(|test| self.prepare_test(test))
    }

    fn prepare_test(&self, test: &mut TestPlan) -> Result<(), Failure> {
        if test.cases_in_programs.is_some() {
            let kind = &test.plugin.plugin_type;
            let error = format!("a test of type `{kind}` runs in processes of its framework");
            return Err(Failure::input(error).hint("start its program with the debugger"));
        }
        let (grace, limit) = (test.limits.grace, UNLIMITED);
        let limits = TestLimits {
            load: limit,
            setup: limit,
            run: limit,
            teardown: limit,
            slow: limit,
            grace,
        };
        test.limits = Arc::new(limits);
        test.settings.repetitions = 1;
        test.settings.retries.count = 0;
        test.settings.shared = false;
        let host = Arc::make_mut(&mut test.plugin.host);
        host.forks = false;
        host.command.splice(..0, self.debugger.iter().cloned());
        Ok(())
    }
}

fn split(command: &str) -> Result<Vec<String>, Failure> {
    let words = shell_words::split(command).unwrap_or_default();
    if words.is_empty() {
        let error = format!("`{command}` is not a command");
        return Err(Failure::input(error).hint("for example `--debugger 'gdb --args'`"));
    }
    Ok(words)
}

fn too_many(plan: &Plan) -> Failure {
    let tests = plan.suites.iter().flat_map(|suite| {
        let file = if suite.file.is_empty() { &suite.name } else { &suite.file };
        suite.tests.iter().map(move |test| format!("{file}::{}", test.name))
    });
    let mut candidates: Vec<_> = tests.take(CANDIDATES).map(|name| format!("`{name}`")).collect();
    let all = plan.tests as usize;
    if all > candidates.len() {
        candidates.push(format!("{} more", all - candidates.len()));
    }
    let error = format!("one test can be debugged, but {} are selected", count(all, "test"));
    Failure::input(error).hint(format!("name one of {}", candidates.join(", ")))
}

/// Prints where the test's process is.
fn notify(mode: DebugMode, pid: i32) {
    match mode {
        DebugMode::Terminal => {
            // The guard, which the user started.
            let rtf = parent_id();
            // The console may be within a line.
            terminal::notice(format_args!(
                "\ndebug: process {pid} has the terminal; to end the run, send SIGINT to process \
                 {rtf}: kill -INT {rtf}"
            ));
        }
        DebugMode::Wait => {
            let runner = id();
            terminal::notice(format_args!(
                "debug: process {pid} waits for a debugger; to start the test without one: \
                 kill -USR1 {runner}"
            ));
        }
    }
}
