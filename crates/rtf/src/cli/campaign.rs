//! Options of `rtf campaign`.

use std::num::NonZeroU16;
use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Subcommand, ValueEnum};
use rtf_plan::suite::parse_duration;

use super::values::jobs_parser;
use super::{ClusterArgs, HistoryFileArgs, ProfileArgs, ResultsArgs};

/// The verb of `rtf campaign`.
#[derive(Debug, Subcommand)]
pub enum CampaignVerb {
    /// Run the episodes of a campaign
    Run(Box<CampaignRunArgs>),
    /// Show the results of a campaign, also while it runs: the claim, and where it fails
    Show(CampaignShowArgs),
    /// Find the smallest change from the nominal parameters with which an episode fails
    Shrink(CampaignShrinkArgs),
    /// Run episodes that another program asks for on standard input, such as an optimiser
    Search(CampaignSearchArgs),
    /// Compare versions with the first one: the rates, by condition, and measurements
    Compare(CampaignCompareArgs),
    /// Find out whether results depend on how the episodes are run
    Invariance(CampaignInvarianceArgs),
    /// Print how many episodes a comparison needs to find a difference
    Plan(CampaignPlanArgs),
    /// Print the list of episodes, as JSON lines
    Episodes {
        /// The campaign (.xml)
        #[arg(value_name = "FILE")]
        file: PathBuf,
    },
}

/// Options of `rtf campaign run`.
#[derive(Debug, Args)]
pub struct CampaignRunArgs {
    /// The campaign (.xml)
    #[arg(required_unless_present = "resume", value_name = "FILE")]
    pub file: Option<PathBuf>,

    /// Run episodes on N workers in parallel, each with separate fixtures [default: 1]
    #[arg(short, long, value_name = "N", value_parser = jobs_parser())]
    pub workers: Option<NonZeroU16>,

    /// Run N episodes at a time in each worker, instead of the `slots` of the test
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub slots: Option<u32>,

    #[command(flatten)]
    pub cluster: ClusterArgs,

    /// Continue an earlier campaign, whose results are in the directory DIR
    #[arg(long, value_name = "DIR", conflicts_with_all = ["file", "profile", "set", "slots"])]
    #[arg(conflicts_with_all = ["executor", "shards", "args", "licenses", "image", "claim", "patch"])]
    pub resume: Option<PathBuf>,

    /// Time limit for all tear-downs and hooks after a signal; then rtf kills all
    /// leftover processes
    #[arg(long, value_name = "DURATION", default_value = "60s", value_parser = parse_duration)]
    pub shutdown_timeout: Duration,

    /// Answer no questions of tests: they get their default answers, or are errors
    #[arg(long)]
    pub no_input: bool,

    /// Do not import the campaign into the history
    #[arg(long)]
    pub no_history: bool,

    #[command(flatten)]
    pub history: HistoryFileArgs,

    #[command(flatten)]
    pub profile: ProfileArgs,

    #[command(flatten)]
    pub results: ResultsArgs,
}

/// Options of `rtf campaign show`.
#[derive(Debug, Args)]
pub struct CampaignShowArgs {
    /// The directory of the results [default: of the newest campaign]
    #[arg(value_name = "DIR")]
    pub dir: Option<PathBuf>,

    /// Also print the rates by two parameters: `payload,friction`
    #[arg(long, value_name = "X,Y", value_delimiter = ',', num_args = 1)]
    pub map: Vec<String>,

    /// Show the versions of blinded trials before all have results; that is recorded
    #[arg(long)]
    pub unblind: bool,

    /// Output format
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    pub format: CampaignShowFormat,

    /// The file of the `html` report [default: standard output]
    #[arg(short, long, value_name = "PATH")]
    pub output: Option<PathBuf>,

    #[command(flatten)]
    pub results: ResultsArgs,
}

/// The format of `rtf campaign show`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CampaignShowFormat {
    /// Tables
    Text,
    /// One JSON document
    Json,
    /// A page with plots in one file
    Html,
}

/// The format of the results of a campaign.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CampaignFormat {
    /// Tables
    Text,
    /// One JSON document
    Json,
}

/// Options of `rtf campaign shrink`.
#[derive(Debug, Args)]
pub struct CampaignShrinkArgs {
    /// The number of an episode that failed
    #[arg(value_name = "EPISODE", value_parser = clap::value_parser!(u64).range(1..))]
    pub episode: u64,

    /// The campaign (.xml), or the directory of its results [default: of the newest campaign]
    #[arg(value_name = "INPUT")]
    pub input: Option<PathBuf>,

    /// Output format
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    pub format: CampaignFormat,

    /// Time limit for all tear-downs and hooks after a signal; then rtf kills all
    /// leftover processes
    #[arg(long, value_name = "DURATION", default_value = "60s", value_parser = parse_duration)]
    pub shutdown_timeout: Duration,

    #[command(flatten)]
    pub profile: ProfileArgs,

    #[command(flatten)]
    pub results: ResultsArgs,
}

/// Options of `rtf campaign search`.
#[derive(Debug, Args)]
pub struct CampaignSearchArgs {
    /// The campaign (.xml)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,

    /// Run up to N episodes in parallel, on workers with separate fixtures
    #[arg(short, long, value_name = "N", default_value = "1", value_parser = jobs_parser())]
    pub workers: NonZeroU16,

    /// Time limit for all tear-downs and hooks after a signal; then rtf kills all
    /// leftover processes
    #[arg(long, value_name = "DURATION", default_value = "60s", value_parser = parse_duration)]
    pub shutdown_timeout: Duration,

    #[command(flatten)]
    pub profile: ProfileArgs,

    #[command(flatten)]
    pub results: ResultsArgs,
}

/// Options of `rtf campaign invariance`.
#[derive(Debug, Args)]
pub struct CampaignInvarianceArgs {
    /// The campaign (.xml)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,

    /// Run at most the first N episodes, each several times
    #[arg(long, value_name = "N", default_value = "200")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..))]
    pub episodes: u32,

    /// Run N episodes at a time the first time, instead of the `slots` of the test
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub slots: Option<u32>,

    /// The probability of any wrong claim about results that are not the same twice
    #[arg(long, value_name = "P", default_value = "0.05", value_parser = parse_probability)]
    pub alpha: f64,

    /// Output format
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    pub format: CampaignFormat,

    /// Time limit for all tear-downs and hooks after a signal; then rtf kills all
    /// leftover processes
    #[arg(long, value_name = "DURATION", default_value = "60s", value_parser = parse_duration)]
    pub shutdown_timeout: Duration,

    #[command(flatten)]
    pub profile: ProfileArgs,

    #[command(flatten)]
    pub results: ResultsArgs,
}

/// Options of `rtf campaign compare`.
#[derive(Debug, Args)]
pub struct CampaignCompareArgs {
    /// The results of the first version: the directory of a campaign, a CSV file, or
    /// `eval_info.json` of LeRobot
    #[arg(value_name = "FIRST")]
    pub first: PathBuf,

    /// The results of the versions that are compared with it; none if FIRST is the directory of a
    /// campaign with `<versions>`
    #[arg(value_name = "NEXT")]
    pub next: Vec<PathBuf>,

    /// Also compare the versions for each value of a parameter
    #[arg(long, value_name = "PARAM")]
    pub by: Option<String>,

    /// The probability of any wrong claim if all versions are equal
    #[arg(long, value_name = "P", default_value = "0.05", value_parser = parse_probability)]
    pub alpha: f64,

    /// Output format
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    pub format: CampaignFormat,
}

/// Options of `rtf campaign plan`.
#[derive(Debug, Args)]
pub struct CampaignPlanArgs {
    /// Results with the rate of the first version, as for `rtf campaign compare`
    #[arg(value_name = "RESULTS", required_unless_present = "rate", conflicts_with = "rate")]
    pub results: Option<PathBuf>,

    /// The difference of the rates to be found, in percentage points: `5%`
    #[arg(long, value_name = "PERCENT", value_parser = parse_percent)]
    pub detect: f64,

    /// The rate of the first version: `0.9` or `90%`
    #[arg(long, value_name = "RATE", value_parser = parse_rate)]
    pub rate: Option<f64>,

    /// The probability that the difference is found
    #[arg(long, value_name = "P", default_value = "0.8", value_parser = parse_probability)]
    pub power: f64,

    /// The probability of any wrong claim if all versions are equal
    #[arg(long, value_name = "P", default_value = "0.05", value_parser = parse_probability)]
    pub alpha: f64,

    /// The share of episodes that only one of two versions passes: `10%` [default: unknown]
    #[arg(long, value_name = "PERCENT", value_parser = parse_percent)]
    pub discordant: Option<f64>,

    /// How many versions are compared, with the first one
    #[arg(long, value_name = "N", default_value = "2")]
    #[arg(value_parser = clap::value_parser!(u32).range(2..=1000))]
    pub versions: u32,

    /// Output format
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    pub format: CampaignFormat,
}

fn parse_probability(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if number > 0.0 && number < 1.0 => Ok(number),
        _ => Err("a number between 0 and 1 is expected".to_owned()),
    }
}

/// A share above 0 %, in percent.
fn parse_percent(text: &str) -> Result<f64, String> {
    let number = text.strip_suffix('%').and_then(|number| number.trim_end().parse::<f64>().ok());
    match number {
        Some(number) if number > 0.0 && number <= 100.0 => Ok(number / 100.0),
        _ => Err("a number of percent above 0 and up to 100 is expected: `5%`".to_owned()),
    }
}

/// A rate, as a number or in percent.
fn parse_rate(text: &str) -> Result<f64, String> {
    let number = match text.strip_suffix('%') {
        Some(percent) => percent.trim_end().parse().map(|number: f64| number / 100.0),
        None => text.parse(),
    };
    match number {
        Ok(number) if (0.0..=1.0).contains(&number) => Ok(number),
        _ => Err("a number from 0 to 1 is expected, or percent: `0.9` or `90%`".to_owned()),
    }
}
