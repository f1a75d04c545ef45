//! `rtf history campaigns` and `rtf history rates`.

use std::io::{self, Write};

use clap::ArgMatches;
use rtf_history::answers::CampaignSeries;
use rtf_history::entry::{CampaignEnd, CampaignInfo};
use rtf_history::{RunSelection, Store};
use rtf_report::{escape, format_count};
use rtf_run::error::Failure;
use rtf_run::history::time;
use rtf_statistics::Rate;

use super::{failure, open, print, select, text};
use crate::cli::HistoryCampaignsArgs;
use crate::command::VerbResult;

/// Lists campaigns.
pub fn list(mut args: HistoryCampaignsArgs, matches: &ArgMatches) -> VerbResult {
    let selection = select::runs(&args.runs)?;
    let store = open(&mut args.history, matches)?;
    let campaigns = store.campaigns(&selection, args.name.as_deref()).map_err(failure)?;
    check_name(&store, args.name.as_deref())?;
    print(args.history.format, "campaigns", &campaigns, |out| write(out, &campaigns))
}

/// Shows rates over commits.
pub fn rates(mut args: HistoryCampaignsArgs, matches: &ArgMatches) -> VerbResult {
    let selection = select::runs(&args.runs)?;
    let store = open(&mut args.history, matches)?;
    let series = store.campaign_rates(&selection, args.name.as_deref()).map_err(failure)?;
    check_name(&store, args.name.as_deref())?;
    print(args.history.format, "rates", &series, |out| {
        if series.is_empty() {
            return writeln!(out, "no campaigns");
        }
        series.iter().try_for_each(|series| write_series(out, series))
    })
}

/// Refuses a name that no campaign has.
fn check_name(store: &Store, name: Option<&str>) -> Result<(), Failure> {
    let Some(name) = name else { return Ok(()) };
    let all = store.campaigns(&RunSelection::default(), None).map_err(failure)?;
    if all.iter().any(|campaign| campaign.name == name) {
        return Ok(());
    }
    let mut names: Vec<_> = all.iter().map(|it| escape::line(&it.name)).collect();
    names.sort();
    names.dedup();
    let hint = match names.is_empty() {
        true => "the history has no campaigns".to_owned(),
        false => format!("campaigns of the history: {}", names.join(", ")),
    };
    Err(Failure::input(format!("the history has no campaign `{name}`")).hint(hint))
}

/// Writes a line for each campaign.
pub fn write(out: &mut dyn Write, campaigns: &[CampaignInfo]) -> io::Result<()> {
    if campaigns.is_empty() {
        return writeln!(out, "no campaigns");
    }
    campaigns.iter().try_for_each(|campaign| {
        let sources = [
            campaign.branch.as_deref().map(|branch| escape::line(branch).into_owned()),
            Some(text::commit(campaign.commit.as_deref(), campaign.dirty)),
            Some(escape::line(&campaign.host).into_owned()),
            campaign.profile.as_deref().map(|it| format!("profile {}", escape::line(it))),
        ];
        let sources: Vec<_> = sources.into_iter().flatten().filter(|it| !it.is_empty()).collect();
        let end = match campaign.end {
            CampaignEnd::Finished => String::new(),
            end => format!(", {}", end.as_str()),
        };
        writeln!(
            out,
            "{}  {}  {}  {}, claim rate >= {}  {}{end}  {}  {}",
            time::minute(campaign.started),
            verdict(&campaign.verdict, 9),
            escape::line(&campaign.name),
            rate(campaign.rate.as_ref()),
            campaign.claim,
            format_count(campaign.run, "episode"),
            sources.join(", "),
            escape::line(&campaign.directory),
        )
    })
}

fn verdict(word: &str, width: usize) -> String {
    let colour = match word {
        "passed" => "\u{1b}[32m",
        "failed" => "\u{1b}[31m",
        _ => "\u{1b}[33m",
    };
    format!("{colour}{word:<width$}\u{1b}[0m")
}

/// `95.2 % (91.0 to 97.5)`.
pub fn rate(rate: Option<&Rate>) -> String {
    let percent = |share: f64| format!("{:.1}", share * 100.0);
    match rate {
        None => "no rate".to_owned(),
        Some(Rate { value, low, high }) => {
            format!("{} % ({} to {})", percent(*value), percent(*low), percent(*high))
        }
    }
}

fn write_series(out: &mut dyn Write, series: &CampaignSeries) -> io::Result<()> {
    let (name, file) = (escape::line(&series.name), escape::line(&series.file));
    let profile = series.profile.as_ref().map(|it| format!(", profile {it}"));
    let set: Vec<_> = series.set.iter().map(|it| format!(", {it}")).collect();
    let settings = format!("{}{}", profile.unwrap_or_default(), set.concat());
    writeln!(out, "{name}  ({file}{})", escape::line(&settings))?;
    let values: Vec<_> = series.points.iter().map(|it| it.rate.map(|rate| rate.value)).collect();
    writeln!(out, "  {}", text::sparkline(&values))?;
    for point in &series.points {
        let commit = text::commit(point.commit.as_deref(), point.dirty);
        writeln!(
            out,
            "  {}  {commit:<9}  {:<24}  {} of {} passed  {}",
            time::minute(point.started),
            rate(point.rate.as_ref()),
            point.passed,
            point.passed + point.failed,
            verdict(&point.verdict, 0),
        )?;
    }
    Ok(())
}
