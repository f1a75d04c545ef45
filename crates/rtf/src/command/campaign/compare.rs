//! `rtf campaign compare`: two versions on the same episodes.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use rtf_campaign::comparison::{Comparison, EpisodeValues, MeasurementComparison, compare};
use rtf_campaign::{EpisodeList, EpisodeResult, Ledger};
use rtf_report::episode_results::EpisodeLine;
use rtf_report::escape;
use rtf_run::campaign::directory::CampaignDir;
use rtf_run::error::Failure;
use rtf_run::{exit, terminal};

use crate::cli::{CampaignCompareArgs, CampaignFormat};
use crate::command::VerbResult;

/// Compares the results of two directories.
pub fn run(args: &CampaignCompareArgs) -> VerbResult {
    let first = CampaignDir::open_judged(&args.first)?;
    let second = CampaignDir::open_judged(&args.second)?;
    let episodes = first.episodes()?;
    if episodes != second.episodes()? {
        let (first, second) = (args.first.display(), args.second.display());
        let error = format!("`{first}` and `{second}` have different episodes");
        let hint = "compare two runs of one campaign file, with the same seed";
        return Err(Failure::input(error).hint(hint));
    }
    let values = |dir: &CampaignDir| values(dir, &episodes);
    let comparison = compare(&values(&first)?, &values(&second)?, 0);
    if args.format == CampaignFormat::Json {
        let text = serde_json::to_string_pretty(&comparison).map_err(Failure::internal)?;
        terminal::stdout(|out| writeln!(out, "{text}"))?;
    } else {
        terminal::stdout(|out| print(out, &comparison, (&first.path, &second.path)))?;
    }
    let is_worse = comparison.is_worse(args.alpha);
    Ok(ExitCode::from(if is_worse { exit::FAILED } else { exit::PASSED }))
}

/// The results and values of all episodes, in their order.
fn values(dir: &CampaignDir, episodes: &EpisodeList) -> Result<Vec<EpisodeValues>, Failure> {
    let mut ledger = Ledger::new(episodes.episodes.len(), dir.description.repeats);
    let mut all = vec![EpisodeValues::default(); episodes.episodes.len()];
    for line in dir.recorded() {
        let Some(outcome) = line.outcome else { continue };
        ledger.record(line.episode, outcome, None);
        let index = usize::try_from(line.episode).ok().and_then(|id| id.checked_sub(1));
        if let Some(values) = index.and_then(|index| all.get_mut(index))
            && !outcome.is_of_bench()
            && values.values.is_empty()
        {
            values.values = measured(line);
        }
    }
    for (values, executions) in all.iter_mut().zip(ledger.episodes()) {
        values.passed = match executions.result {
            Some(EpisodeResult::Passed) => Some(true),
            Some(EpisodeResult::Failed) => Some(false),
            Some(EpisodeResult::None) | None => None,
        };
    }
    Ok(all)
}

fn measured(line: EpisodeLine) -> BTreeMap<(String, String, String), f64> {
    let mut values = BTreeMap::new();
    for it in line.measurements {
        if let Some(value) = it.value.filter(|value| value.is_finite()) {
            values.entry((it.test, it.name, it.unit)).or_insert(value);
        }
    }
    values
}

fn print(
    out: &mut dyn Write,
    comparison: &Comparison,
    (first, second): (&Path, &Path),
) -> io::Result<()> {
    let Comparison { pairs, both_passed, only_first, only_second, none_passed, .. } = comparison;
    writeln!(out, "first:  {}\nsecond: {}\n", first.display(), second.display())?;
    writeln!(out, "{pairs} episodes with a result in both")?;
    writeln!(out, "  passed in both        {both_passed}")?;
    writeln!(out, "  only in the first     {only_first}")?;
    writeln!(out, "  only in the second    {only_second}")?;
    writeln!(out, "  in neither            {none_passed}")?;
    if comparison.without_pair > 0 {
        writeln!(out, "  without a result in one of them: {}", comparison.without_pair)?;
    }
    writeln!(out, "  p = {:.4} (McNemar)", comparison.results.p_value)?;
    if !comparison.measurements.is_empty() {
        writeln!(out, "\nmeasurements, means of the pairs")?;
    }
    comparison.measurements.iter().try_for_each(|it| print_measurement(out, it))
}

fn print_measurement(out: &mut dyn Write, it: &MeasurementComparison) -> io::Result<()> {
    let name = escape::line(&format!("{} {}", it.test, it.name)).into_owned();
    let unit = escape::line(&it.unit);
    let (first, second, p) = (it.first, it.second, it.difference.p_value);
    let pairs = it.pairs;
    writeln!(out, "  {name}  {first:.6} → {second:.6} {unit}  p = {p:.4}  ({pairs} pairs)")
}
