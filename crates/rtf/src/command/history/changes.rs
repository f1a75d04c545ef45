//! `rtf history changes`.

use std::io::{self, Write};

use clap::ArgMatches;
use rtf_history::TestAttributes;
use rtf_history::answers::{CampaignChange, RateSegment, SeriesChange};
use rtf_history::statistics::Basis;
use rtf_report::{escape, format_count, format_p_value};
use rtf_run::history::time;

use super::{campaigns, failure, open, print_both, select, text};
use crate::cli::HistoryChangesArgs;
use crate::command::VerbResult;

/// Lists changes of measurements, signals, durations and rates of campaigns.
pub fn run(mut args: HistoryChangesArgs, matches: &ArgMatches) -> VerbResult {
    let (runs, filter) = select::results(&args.select)?;
    let store = open(&mut args.history, matches)?;
    let is_meant = |test: &TestAttributes| {
        (args.cases || test.identity.case.is_empty()) && filter.matches(test)
    };
    let mut changes = store.changes(&runs, &is_meant).map_err(failure)?;
    let min_size = args.min_size / 100.0;
    changes.retain(|it| it.change.size.is_none_or(|size| size.fraction.abs() >= min_size));
    // Campaigns have no tests and no robot.
    let is_of_tests = !args.select.filters.is_empty() || args.select.robot.is_some();
    let mut rates = match is_of_tests {
        true => Vec::new(),
        false => store.campaign_changes(&runs).map_err(failure)?,
    };
    rates.retain(|it| (it.after.rate.value - it.before.rate.value).abs() >= min_size);
    let both = (("changes", &changes), ("campaign_changes", &rates));
    print_both(args.history.format, both.0, both.1, |out| {
        if changes.is_empty() && rates.is_empty() {
            return writeln!(out, "no changes");
        }
        rates.iter().try_for_each(|change| write_rate(out, change))?;
        changes.iter().try_for_each(|change| write(out, change))
    })
}

fn write_rate(out: &mut dyn Write, found: &CampaignChange) -> io::Result<()> {
    let rate = |segment: &RateSegment| campaigns::rate(Some(&segment.rate));
    let episodes = |segment: &RateSegment| {
        let campaigns = format_count(segment.campaigns as u64, "campaign");
        format!("{} in {campaigns}", segment.passed + segment.failed)
    };
    writeln!(
        out,
        "{}  campaign {}  rate  {} → {}",
        time::minute(found.started),
        escape::line(&found.name),
        rate(&found.before),
        rate(&found.after),
    )?;
    write!(out, "  since {}", escape::line(&found.directory))?;
    write_commits(out, [&found.commit_before, &found.commit])?;
    writeln!(
        out,
        ", {}, episodes: {} before, {} since",
        format_p_value(found.p_value),
        episodes(&found.before),
        episodes(&found.after)
    )
}

/// `, commits 0123..4567`, as far as they are known.
fn write_commits(out: &mut dyn Write, commits: [&Option<String>; 2]) -> io::Result<()> {
    let commits: Vec<_> =
        commits.into_iter().flatten().map(|commit| text::commit(Some(commit), None)).collect();
    if commits.is_empty() {
        return Ok(());
    }
    write!(out, ", commits {}", commits.join(".."))
}

fn write(out: &mut dyn Write, found: &SeriesChange) -> io::Result<()> {
    let (before, after) = (found.change.before.mean, found.change.after.mean);
    let (name, before, after) = match &found.series {
        None => ("duration", text::seconds(before), text::seconds(after)),
        Some(series) => {
            let number = |value| text::number(value, &series.unit);
            (series.name.as_str(), number(before), number(after))
        }
    };
    let size = found.change.size.map_or(String::new(), |size| {
        let basis = match size.basis {
            Basis::LimitsSpan => " of the limits' span",
            Basis::MeanBefore => "",
        };
        format!(" ({:+.0} %{basis})", size.fraction * 100.0)
    });
    let (test, name) = (text::name(&found.identity), escape::line(name));
    writeln!(out, "{}  {test}  {name}  {before} → {after}{size}", time::minute(found.started))?;
    let on = [Some(found.robot.as_str()), found.profile.as_deref()];
    let on: Vec<_> = on.into_iter().flatten().filter(|it| !it.is_empty()).collect();
    write!(out, "  since {}", escape::line(&found.run_name))?;
    write_commits(out, [&found.commit_before, &found.commit])?;
    if !on.is_empty() {
        write!(out, ", on {}", escape::line(&on.join(", ")))?;
    }
    match found.sources_changed {
        Some(true) => write!(out, ", with other sources of the test")?,
        Some(false) => write!(out, ", with equal sources of the test")?,
        None => {}
    }
    writeln!(out)
}
