//! `rtf history trend`.

use std::io::{self, Write};

use clap::ArgMatches;
use rtf_history::answers::TestSeries;
use rtf_history::entry::NumberKind;
use rtf_report::{escape, format_count};
use rtf_run::error::Failure;
use rtf_run::history::time;

use super::{failure, open, print, select, text};
use crate::cli::HistoryTrendArgs;
use crate::command::VerbResult;

/// How many names a hint lists.
const NAMES: usize = 10;

/// Shows a measurement or signal over runs.
pub fn run(mut args: HistoryTrendArgs, matches: &ArgMatches) -> VerbResult {
    let (runs, filter) = select::results(&args.select)?;
    let store = open(&mut args.history, matches)?;
    let series =
        store.trend(&args.name, None, &runs, &|test| filter.matches(test)).map_err(failure)?;
    if series.is_empty() {
        let names = store.series_names().map_err(failure)?;
        let error = format!("no selected test has a measurement or signal `{}`", args.name);
        let listed: Vec<_> = names.iter().take(NAMES).map(|name| escape::line(name)).collect();
        let hint = match listed.is_empty() {
            true => "the history has no measurements and no signals".to_owned(),
            false => format!("measurements and signals of the history: {}", listed.join(", ")),
        };
        return Err(Failure::input(error).hint(hint));
    }
    print(args.history.format, "series", &series, |out| {
        series.iter().try_for_each(|series| write(out, series))
    })
}

fn write(out: &mut dyn Write, series: &TestSeries) -> io::Result<()> {
    let values: Vec<_> = series.points.iter().map(|point| point.value).collect();
    let kind = if series.series.kind == NumberKind::Signal { "signal " } else { "" };
    let name = escape::line(&series.series.name);
    writeln!(out, "{}  {kind}{name}", text::name(&series.identity))?;
    writeln!(out, "  {}", text::sparkline(&values))?;
    let runs = format_count(series.points.len() as u64, "run");
    writeln!(
        out,
        "  {}, {runs}{}",
        text::series(&series.points, &series.series.unit),
        since(series)
    )?;
    if !series.other_units.is_empty() {
        let units: Vec<_> = series.other_units.iter().map(|unit| unit_name(unit)).collect();
        writeln!(out, "  another unit is another series: also in {}", units.join(", "))?;
    }
    Ok(())
}

fn since(series: &TestSeries) -> String {
    series
        .points
        .first()
        .map_or(String::new(), |point| format!(" since {}", time::minute(point.started)))
}

fn unit_name(unit: &str) -> String {
    if unit.is_empty() { "no unit".to_owned() } else { format!("`{}`", escape::line(unit)) }
}
