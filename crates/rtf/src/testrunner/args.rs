//! The command line of robot-testing-framework 2.x.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::{ArgAction, Parser, ValueEnum};
use rtf_plan::plan::InputPath;

/// The command line of robot-testing-framework 2.x, for the scripts that use it; `rtf run` does more
#[derive(Debug, Parser)]
#[command(name = super::NAME, max_term_width = 100, args_override_self = true)]
#[command(disable_version_flag = true, disable_help_flag = true)]
#[command(override_usage = "robottestingframework-testrunner [OPTIONS] \
    (--test NAME | --tests FOLDER | --suite FILE | --suites FOLDER)...")]
pub struct Args {
    /// Run one plug-in
    #[arg(short, long, value_name = "NAME", allow_hyphen_values = true)]
    pub test: Option<PathBuf>,

    /// Run the plug-ins of a folder
    #[arg(long, value_name = "FOLDER", allow_hyphen_values = true)]
    pub tests: Option<PathBuf>,

    /// Run one suite
    #[arg(short, long, value_name = "FILE", allow_hyphen_values = true)]
    pub suite: Option<PathBuf>,

    /// Run the suites of a folder
    #[arg(long, value_name = "FOLDER", allow_hyphen_values = true)]
    pub suites: Option<PathBuf>,

    /// Write no result file and keep nothing
    #[arg(long)]
    pub no_output: bool,

    /// Print no summary
    #[arg(long)]
    pub no_summary: bool,

    /// The result file [default: result.txt, or result.xml for junit]
    #[arg(short, long, value_name = "FILE", allow_hyphen_values = true)]
    pub output: Option<PathBuf>,

    /// The format of the result file: text or junit
    #[arg(long, value_name = "TYPE", default_value = "text", allow_hyphen_values = true)]
    #[arg(hide_possible_values = true)]
    pub output_type: OutputType,

    /// The parameter string of --test
    #[arg(short, long, value_name = "TEXT", default_value = "", allow_hyphen_values = true)]
    #[arg(hide_default_value = true)]
    pub param: String,

    /// The environment string of --test
    #[arg(short, long, value_name = "TEXT", default_value = "", allow_hyphen_values = true)]
    #[arg(hide_default_value = true)]
    pub environment: String,

    /// How often --test runs
    #[arg(long, value_name = "N", default_value = "0", allow_hyphen_values = true)]
    #[arg(hide_default_value = true)]
    pub repetition: u32,

    /// Show the run in a browser
    #[arg(short, long)]
    pub web_reporter: bool,

    /// The port of the page for the browser
    #[arg(long, value_name = "PORT", default_value = "8080", allow_hyphen_values = true)]
    pub web_port: u16,

    /// Search the folders inside of a folder too
    #[arg(short, long)]
    pub recursive: bool,

    /// Tell the place in the source of each message
    #[arg(short, long)]
    pub detail: bool,

    /// Show all messages, not only failures and errors
    #[arg(short, long)]
    pub verbose: bool,

    /// Print the version
    #[arg(long)]
    pub version: bool,

    /// Print this help
    #[arg(short = '?', long, action = ArgAction::Help)]
    pub help: Option<bool>,

    /// What has no meaning
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
    /// What is to be run. An empty value is none.
    pub fn requests(&self) -> Vec<InputPath> {
        let of = |path: &Option<PathBuf>, kind: fn(PathBuf) -> InputPath| {
            path.clone().filter(|path| !path.as_os_str().is_empty()).map(kind)
        };
        [
            of(&self.test, InputPath::Plugin),
            of(&self.tests, InputPath::Plugins),
            of(&self.suite, InputPath::Suite),
            of(&self.suites, InputPath::Suites),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// Where the results go; `None`: nowhere.
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
