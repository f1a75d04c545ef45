//! The command line.

use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};

/// Tests of robots: plug-ins in any language, on top of fixtures that are
/// watched while the tests run
#[derive(Debug, Parser)]
#[command(name = "rtf", version, propagate_version = true, max_term_width = 100)]
#[command(after_long_help = AFTER_HELP)]
pub struct Cli {
    /// When to use colours
    #[arg(long, value_name = "WHEN", default_value = "auto", global = true)]
    pub color: Color,

    #[command(subcommand)]
    pub command: Command,
}

const AFTER_HELP: &str = "\
Exit codes:
  0    everything passed
  1    a test did not pass, or a fixture collapsed or broke
  2    bad input, or no tests: nothing was started
  3    rtf could not do its own work, for example write a report
  4    a hook failed: the robot may not be in a safe state, whatever else happened
  5    the runner died (SIGKILL, out of memory, a defect): its guard stopped everything
  128+N  the run was ended by signal N (130 for Ctrl-C)";

/// When to use colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Color {
    /// On a terminal, unless `NO_COLOR` is set
    #[default]
    Auto,
    /// Always
    Always,
    /// Never
    Never,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run suites, plug-ins and folders
    Run(RunArgs),
    /// Find every problem of suites and plug-ins, start nothing
    Check(InputArgs),
    /// List the tests that `run` would run
    List(InputArgs),
    /// Show a past run, or what is there of one that was killed
    Show(ShowArgs),
    /// Write a report of a past run
    Report(ReportArgs),
    /// Print a shell's completions
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Write the manual pages into a folder
    #[command(hide = true)]
    Man {
        /// The folder
        folder: PathBuf,
    },
}

/// What to run.
#[derive(Debug, Args)]
pub struct InputArgs {
    /// Suites (.xml), plug-ins, and folders of either
    #[arg(required = true, value_name = "FILE")]
    pub inputs: Vec<PathBuf>,

    /// Descend into folders
    #[arg(short, long)]
    pub recursive: bool,

    /// The parameter string of plug-ins that are given by name
    #[arg(long, value_name = "TEXT", allow_hyphen_values = true)]
    pub param: Option<String>,

    /// The environment string of plug-ins that are given by name
    #[arg(long, value_name = "TEXT", allow_hyphen_values = true)]
    pub environment: Option<String>,

    /// How often plug-ins that are given by name are run
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub repetition: Option<u32>,
}

/// How to run it.
#[derive(Debug, Args)]
pub struct RunArgs {
    #[command(flatten)]
    pub input: InputArgs,

    #[command(flatten)]
    pub results: ResultsArgs,

    /// Also write a report: `junit=PATH` or `text=PATH`
    #[arg(long = "report", value_name = "FORMAT=PATH", value_parser = parse_report)]
    pub reports: Vec<(Format, PathBuf)>,

    /// Show every message, measurement and output as it comes
    #[arg(short, long)]
    pub verbose: bool,
}

/// Where runs are kept.
#[derive(Debug, Args)]
pub struct ResultsArgs {
    /// The folder of the runs' folders
    #[arg(long, value_name = "DIR", default_value = "rtf-results", env = "RTF_RESULTS")]
    pub results: PathBuf,
}

/// Which run to show.
#[derive(Debug, Args)]
pub struct ShowArgs {
    /// The run: `latest`, its name, its folder, or its journal
    #[arg(default_value = "latest", value_name = "RUN")]
    pub run: String,

    #[command(flatten)]
    pub results: ResultsArgs,

    /// Show every message, measurement and output
    #[arg(short, long)]
    pub verbose: bool,
}

/// Which report to write.
#[derive(Debug, Args)]
pub struct ReportArgs {
    /// The run: `latest`, its name, its folder, or its journal
    #[arg(default_value = "latest", value_name = "RUN")]
    pub run: String,

    #[command(flatten)]
    pub results: ResultsArgs,

    /// The report's format
    #[arg(long, value_parser = format_parser())]
    pub format: Format,

    /// Where to write it; standard output when it is left out
    #[arg(short, long, value_name = "PATH")]
    pub output: Option<PathBuf>,
}

/// A report's format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Plain text.
    Text,
    /// JUnit XML.
    Junit,
}

impl Format {
    const NAMES: [&'static str; 2] = ["text", "junit"];

    fn from_name(name: &str) -> Option<Self> {
        match name {
            "text" => Some(Self::Text),
            "junit" => Some(Self::Junit),
            _ => None,
        }
    }
}

fn format_parser() -> impl TypedValueParser<Value = Format> {
    PossibleValuesParser::new(Format::NAMES)
        .map(|name| Format::from_name(&name).unwrap_or(Format::Text))
}

fn parse_report(value: &str) -> Result<(Format, PathBuf), String> {
    let expected = "expected `junit=PATH` or `text=PATH`";
    let (name, path) = value.split_once('=').ok_or(expected)?;
    let format =
        Format::from_name(name).ok_or_else(|| format!("unknown format `{name}`, {expected}"))?;
    if path.is_empty() {
        return Err(format!("the path is missing, {expected}"));
    }
    Ok((format, PathBuf::from(path)))
}
