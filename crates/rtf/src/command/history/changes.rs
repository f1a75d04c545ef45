//! `rtf history changes`.

use std::io::{self, Write};

use clap::ArgMatches;
use rtf_history::TestAttributes;
use rtf_history::answers::SeriesChange;
use rtf_history::statistics::Basis;
use rtf_report::escape;

use super::{failure, open, print, select, text, time};
use crate::cli::HistoryChangesArgs;
use crate::command::VerbResult;

/// Lists changes of measurements, signals and durations.
pub fn run(mut args: HistoryChangesArgs, matches: &ArgMatches) -> VerbResult {
    let (runs, filter) = select::results(&args.select)?;
    let store = open(&mut args.history, matches)?;
    let is_meant = |test: &TestAttributes| {
        (args.cases || test.identity.case.is_empty()) && filter.matches(test)
    };
    let mut changes = store.changes(&runs, &is_meant).map_err(failure)?;
    let min_size = args.min_size / 100.0;
    changes.retain(|it| it.change.size.is_none_or(|size| size.fraction.abs() >= min_size));
    print(args.history.format, "changes", &changes, |out| {
        if changes.is_empty() {
            return writeln!(out, "no changes");
        }
        changes.iter().try_for_each(|change| write(out, change))
    })
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
    let commits = [&found.commit_before, &found.commit];
    let commits: Vec<_> =
        commits.into_iter().flatten().map(|commit| text::commit(Some(commit), None)).collect();
    let on = [Some(found.robot.as_str()), found.profile.as_deref()];
    let on: Vec<_> = on.into_iter().flatten().filter(|it| !it.is_empty()).collect();
    write!(out, "  since {}", escape::line(&found.run_name))?;
    if !commits.is_empty() {
        write!(out, ", commits {}", commits.join(".."))?;
    }
    if !on.is_empty() {
        write!(out, ", on {}", escape::line(&on.join(", ")))?;
    }
    writeln!(out)
}
