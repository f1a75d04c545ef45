//! Options of `rtf history gate`.

use clap::{ArgGroup, Args, ValueEnum};
use rtf_history::answers::gate::RegressionLimit;

use super::{HistoryFileArgs, ResultsArgs};

/// Options of `rtf history gate`.
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("gates").required(true).multiple(true)
    .args(["max_new_failures", "max_flaky", "no_regression"]))]
pub struct HistoryGateArgs {
    /// The run to judge, by name or id
    #[arg(value_name = "RUN", default_value = "latest")]
    pub run: String,

    /// Fail if more than N tests failed that passed in the newest baseline run
    #[arg(long, value_name = "N")]
    pub max_new_failures: Option<u32>,

    /// Fail if more than this share of the tests are flaky: `2%`
    #[arg(long, value_name = "PERCENT", value_parser = parse_share)]
    pub max_flaky: Option<f64>,

    /// Fail if a measurement is worse than in the baseline by more than this: `lag>10%`,
    /// only if it rises `lag>+10%`, only if it falls `lag>-10%`
    #[arg(long, value_name = "MEASUREMENT>PERCENT", value_parser = parse_limit)]
    pub no_regression: Vec<RegressionLimit>,

    /// The runs to compare with: `branch:NAME`, `commit:HASH`, `host:NAME`, or a run
    /// [default: the default branch]
    #[arg(long, value_name = "RUNS")]
    pub baseline: Option<String>,

    /// Compare with the newest N runs of the baseline
    #[arg(long, value_name = "N", default_value = "20")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..))]
    pub last: u32,

    /// Judge only tests that match, as in `rtf run`: `tag(slow) & !type(lua)`
    #[arg(short = 'E', long = "filter", value_name = "FILTER")]
    pub filters: Vec<String>,

    #[command(flatten)]
    pub results: ResultsArgs,

    #[command(flatten)]
    pub file: HistoryFileArgs,

    /// Output format
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    pub format: GateFormat,
}

/// The format of a judgement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum GateFormat {
    /// Text for people
    Text,
    /// One JSON document
    Json,
    /// A summary for a pull request
    Markdown,
}

fn parse_limit(text: &str) -> Result<RegressionLimit, String> {
    text.parse()
}

/// Parses `2%` or `0.5 %`.
fn parse_share(text: &str) -> Result<f64, String> {
    let percent = text.strip_suffix('%').and_then(|text| text.trim_end().parse::<f64>().ok());
    let share = percent.filter(|percent| (0.0..=100.0).contains(percent));
    share.map(|percent| percent / 100.0).ok_or_else(|| "expected a share such as `2%`".to_owned())
}
