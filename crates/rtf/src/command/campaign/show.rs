//! `rtf campaign show`: the claim, and where a campaign fails.

use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use clap::ArgMatches;
use rtf_campaign::analysis::{self, ByParameter, Cell, FailureMap, Sample};
use rtf_campaign::{EpisodeResult, Judge};
use rtf_coordinator::summary;
use rtf_report::{escape, output_file};
use rtf_run::campaign::directory::CampaignDir;
use rtf_run::campaign::trials::ComparedTrials;
use rtf_run::error::Failure;
use rtf_run::formats::ReportFormat;
use rtf_run::{campaign, reports, terminal};
use rtf_web::html_report;
use serde_json::json;

use super::trials;
use crate::cli::{CampaignShowArgs, CampaignShowFormat};
use crate::command::VerbResult;
use crate::request::config;

/// Prints the results of a campaign.
pub fn run(args: &CampaignShowArgs, matches: &ArgMatches) -> VerbResult {
    let mut results = crate::cli::ResultsArgs { results: args.results.results.clone() };
    config::fill_past_results(&mut results, matches)?;
    let newest = || results.results.join("campaigns").join("latest");
    let path = args.dir.clone().unwrap_or_else(newest);
    if args.unblind {
        let dir = CampaignDir::open_judged(&path)?;
        dir.unblind(&campaign::stored_ledger(&dir, dir.episodes()?.episodes.len()))?;
    }
    if args.format == CampaignShowFormat::Html {
        return write_page(&CampaignDir::open(&path)?, args.output.as_deref());
    }
    if args.output.is_some() {
        return Err(Failure::input("`--output` is for `--format html`"));
    }
    let (loaded, dir, ledger) = campaign::read_results(&path)?;
    let is_hidden = dir.hides_versions(&ledger);
    let episodes = &dir.shown_episodes(loaded.episodes.episodes.clone(), is_hidden);
    let judge = Judge::new(&loaded.campaign, episodes.len());
    let judge = judge.ok_or_else(|| Failure::internal("the claim cannot be judged"))?;
    let mut judgement = judge.judge(&ledger.results());
    let compared = ComparedTrials::judge(&dir, &ledger, &mut judgement)?;
    let samples = analysis::samples(episodes, &ledger);
    let parameters = analysis::by_parameters(&samples, loaded.campaign.seed);
    let map = map(args, &samples, &parameters)?;
    if args.format == CampaignShowFormat::Json {
        let count = |result| ledger.count(result);
        let document = json!({
            "name": loaded.name,
            "claim": loaded.campaign.claim().map(|claim| claim.rate),
            "versions": compared.as_ref().map(|it| &it.comparison),
            "episodes": episodes.len(),
            "passed": count(EpisodeResult::Passed),
            "failed": count(EpisodeResult::Failed),
            "without_result": count(EpisodeResult::None),
            "judgement": judgement,
            "more_episodes": loaded.campaign.claim().and_then(|_| judge.more_episodes(&judgement)),
            "parameters": parameters,
            "map": map,
        });
        let text = serde_json::to_string_pretty(&document).map_err(Failure::internal)?;
        terminal::stdout(|out| writeln!(out, "{text}"))?;
        return Ok(ExitCode::SUCCESS);
    }
    summary::print(&loaded.campaign, (&ledger, &judgement), None, &dir.path)?;
    trials::print(&dir, compared.as_ref(), judgement.verdict)?;
    terminal::stdout(|out| {
        parameters.iter().try_for_each(|parameter| print_parameter(out, parameter))?;
        map.iter().try_for_each(|map| print_map(out, map, &args.map))
    })?;
    Ok(ExitCode::SUCCESS)
}

/// Writes the page with plots.
fn write_page(dir: &CampaignDir, output: Option<&Path>) -> VerbResult {
    let report = campaign::report::report(dir)?;
    reports::check_build(ReportFormat::Html)?;
    match output {
        None => terminal::raw_stdout(|out| html_report::write_campaign(out, &report))?,
        Some(path) => {
            let title = "the page";
            output_file::probe(title, path).map_err(|error| {
                Failure::input(error).hint("choose another path with `--output PATH`")
            })?;
            output_file::write(title, path, |out| html_report::write_campaign(out, &report))
                .map_err(Failure::internal)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// The map that `--map` asks for.
fn map(
    args: &CampaignShowArgs,
    samples: &[Sample<'_>],
    parameters: &[ByParameter],
) -> Result<Option<FailureMap>, Failure> {
    let [x, y] = args.map.as_slice() else {
        return match args.map.len() {
            0 => Ok(None),
            _ => Err(Failure::input("`--map` takes two parameters: `--map payload,friction`")),
        };
    };
    match analysis::failure_map(samples, x, y) {
        None if !samples.is_empty() => {
            let names: Vec<_> = parameters.iter().map(|it| format!("`{}`", it.name)).collect();
            let error = format!("the campaign has no parameters `{x}` and `{y}`");
            Err(Failure::input(error).hint(format!("its parameters are {}", names.join(", "))))
        }
        map => Ok(map),
    }
}

fn print_parameter(out: &mut dyn Write, parameter: &ByParameter) -> io::Result<()> {
    let name = escape::line(&parameter.name);
    let ByParameter { chi_square, p_value, .. } = parameter;
    writeln!(out, "\n{name}  (X² {chi_square:.1}, p = {p_value:.3})")?;
    let width = widest(parameter.cells.iter().map(|cell| cell.values.as_str()));
    for cell in &parameter.cells {
        let values = escape::line(&cell.values);
        let pad = " ".repeat(width - values.chars().count().min(width));
        let (passed, episodes) = (cell.passed, cell.episodes);
        let Some(rate) = &cell.rate else {
            writeln!(out, "  {values}{pad}  no episode")?;
            continue;
        };
        let (value, low, high) = (percent(rate.value), percent(rate.low), percent(rate.high));
        let bar = "█".repeat(blocks(rate.value));
        let interval = format!("{low:>5} to {high:>5}");
        let line = format!(
            "  {values}{pad}  {value:>5} %  {interval}  {passed:>5} of {episodes:<5} {bar}"
        );
        writeln!(out, "{}", line.trim_end())?;
    }
    Ok(())
}

/// Percentages: a row for each value of the second parameter, the largest one first.
fn print_map(out: &mut dyn Write, map: &FailureMap, names: &[String]) -> io::Result<()> {
    let [x, y] = names else { return Ok(()) };
    writeln!(out, "\n{} by {}: percent passed", escape::line(y), escape::line(x))?;
    let width = widest(map.rows.iter().map(|(label, _)| label.as_str()));
    let column = widest(map.columns.iter().map(String::as_str)).max(5);
    for (label, cells) in map.rows.iter().rev() {
        write!(out, "  {:<width$}", escape::line(label))?;
        for Cell { rate, .. } in cells {
            let text = rate.as_ref().map_or_else(|| "-".to_owned(), |rate| percent(rate.value));
            write!(out, "  {text:>column$}")?;
        }
        writeln!(out)?;
    }
    write!(out, "  {:<width$}", "")?;
    for label in &map.columns {
        write!(out, "  {:>column$}", escape::line(label))?;
    }
    writeln!(out)
}

fn widest<'a>(texts: impl Iterator<Item = &'a str>) -> usize {
    texts.map(|text| escape::line(text).chars().count()).max().unwrap_or_default()
}

fn percent(rate: f64) -> String {
    format!("{:.1}", rate * 100.0)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 20")]
fn blocks(rate: f64) -> usize {
    (rate * 20.0).round() as usize
}
