//! Options of `rtf run` for debugging a test.

use clap::Args;

use super::{ExecutorArgs, RunArgs};

const DEBUGGING: &str = "Debugging";

/// Options of `rtf run`.
#[derive(Debug, Args)]
pub struct RunVerbArgs {
    #[command(flatten)]
    pub run: RunArgs,

    #[command(flatten)]
    pub debug: DebugArgs,

    #[command(flatten)]
    pub executor: ExecutorArgs,
}

/// How the selected test is debugged.
#[derive(Debug, Default, Args)]
pub struct DebugArgs {
    /// Give the terminal to the test, which must be the only one, and suspend its limits: for
    /// `breakpoint()`, `binding.irb`, `io.read`
    #[arg(help_heading = DEBUGGING, long, conflicts_with_all = CONFLICTS)]
    pub debug: bool,

    /// As `--debug`, and start the test's process with this debugger: `gdb --args`
    #[arg(help_heading = DEBUGGING, long, value_name = "COMMAND", conflicts_with_all = CONFLICTS)]
    pub debugger: Option<String>,

    /// Print the process of the test, which begins when a debugger is attached, and suspend its
    /// limits
    #[arg(help_heading = DEBUGGING, long, conflicts_with = "time")]
    pub debug_wait: bool,
}

const CONFLICTS: [&str; 3] = ["debug_wait", "end_with_stdin", "time"];
