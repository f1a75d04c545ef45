//! The command line of robot-testing-framework 2.x.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::{ArgAction, Parser, ValueEnum};
use rtf_plan::plan::InputPath;

/// The command line of robot-testing-framework 2.x, for existing scripts; `rtf run` has more options
#[derive(Debug, Parser)]
#[command(name = super::NAME, max_term_width = 100, args_override_self = true)]
#[command(disable_version_flag = true, disable_help_flag = true)]
#[command(override_usage = "robottestingframework-testrunner [OPTIONS] \
    (--test NAME | --tests DIR | --suite FILE | --suites DIR)...")]
pub struct Args {
    /// Run one plug-in
    #[arg(short, long, value_name = "NAME", allow_hyphen_values = true)]
    pub test: Option<PathBuf>,

    /// Run the plug-ins of a directory
    #[arg(long, value_name = "DIR", allow_hyphen_values = true)]
    pub tests: Option<PathBuf>,

    /// Run one suite
    // `--suit` and `--suits` in 1.x.
    #[arg(short, long, alias = "suit", value_name = "FILE", allow_hyphen_values = true)]
    pub suite: Option<PathBuf>,

    /// Run the suites of a directory
    #[arg(long, alias = "suits", value_name = "DIR", allow_hyphen_values = true)]
    pub suites: Option<PathBuf>,

    /// Write no result file and delete the results
    #[arg(long)]
    pub no_output: bool,

    /// Print no summary
    #[arg(long)]
    pub no_summary: bool,

    /// Result file [default: result.txt, or result.xml for junit]
    #[arg(short, long, value_name = "FILE", allow_hyphen_values = true)]
    pub output: Option<PathBuf>,

    /// Format of the result file: text or junit
    #[arg(long, value_name = "TYPE", default_value = "text", allow_hyphen_values = true)]
    #[arg(hide_possible_values = true)]
    pub output_type: OutputType,

    /// Parameter string of --test
    #[arg(short, long, value_name = "TEXT", default_value = "", allow_hyphen_values = true)]
    #[arg(hide_default_value = true)]
    pub param: String,

    /// Environment string of --test
    #[arg(short, long, value_name = "TEXT", default_value = "", allow_hyphen_values = true)]
    #[arg(hide_default_value = true)]
    pub environment: String,

    /// Run --test N times
    #[arg(long, value_name = "N", default_value = "0", allow_hyphen_values = true)]
    #[arg(hide_default_value = true)]
    pub repetition: u32,

    /// Show the run in a browser
    #[arg(short, long)]
    pub web_reporter: bool,

    /// Port of the web page
    #[arg(long, value_name = "PORT", default_value = "8080", allow_hyphen_values = true)]
    pub web_port: u16,

    /// Search directories recursively
    #[arg(short, long)]
    pub recursive: bool,

    /// Print the source location of each message
    #[arg(short, long)]
    pub detail: bool,

    /// Print all messages, not only failures and errors
    #[arg(short, long)]
    pub verbose: bool,

    /// Print the version
    #[arg(long)]
    pub version: bool,

    /// Print this help
    #[arg(short = '?', long, action = ArgAction::Help)]
    pub help: Option<bool>,

    /// Words that are not options
    #[arg(hide = true)]
    pub ignored: Vec<OsString>,
}

/// The format of the result file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum OutputType {
    /// Plain text
    Text,
    /// JUnit XML
    Junit,
}

impl Args {
    /// The suites and plug-ins. An empty value counts as not given.
    pub fn inputs(&self) -> Vec<InputPath> {
        let given =
            |path: &Option<PathBuf>| path.clone().filter(|path| !path.as_os_str().is_empty());
        let inputs = [
            given(&self.test).map(InputPath::Plugin),
            given(&self.tests).map(InputPath::Plugins),
            given(&self.suite).map(InputPath::Suite),
            given(&self.suites).map(InputPath::Suites),
        ];
        inputs.into_iter().flatten().collect()
    }

    /// The result file; `None` if no file is written.
    pub fn result_file(&self) -> Option<&Path> {
        if self.no_output {
            return None;
        }
        let given = self.output.as_deref().filter(|path| !path.as_os_str().is_empty());
        Some(given.unwrap_or_else(|| {
            Path::new(match self.output_type {
                OutputType::Text => "result.txt",
                OutputType::Junit => "result.xml",
            })
        }))
    }
}
