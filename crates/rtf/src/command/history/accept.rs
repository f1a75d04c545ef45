//! `rtf history accept`: limits are learned again, from the runs after a change.
//!
//! The suite file says since when, so that the decision is reviewed and kept with the suite.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::ExitCode;

use clap::ArgMatches;
use rtf_plan::suite::Span;
use rtf_report::{escape, format_count, output_file};
use rtf_run::error::Failure;
use rtf_run::history::{self, OpenChange};
use rtf_run::{plan, terminal};

use super::failure;
use crate::cli::HistoryAcceptArgs;
use crate::command::VerbResult;
use crate::request::{self, config};

const TAG: &str = "<learn";

const BYTE_ORDER_MARK: char = '\u{feff}';

/// Accepts changes.
pub fn run(mut args: HistoryAcceptArgs, matches: &ArgMatches) -> VerbResult {
    config::fill_results(&mut args.input, matches)?;
    let request = request::tests(&args.input)?;
    let planned = plan::plan(&request)?;
    refuse_unknown_names(&planned.plan, &args.measurements)?;
    let history = args.input.history.history.as_deref();
    let database = history::resolve(history, &args.input.results.results)?;
    let dir = &request.options.runner.current_dir;
    let mut changes =
        history::open_changes(&planned.plan, &database, &request.manifest, dir).map_err(failure)?;
    if !args.measurements.is_empty() {
        changes.retain(|change| args.measurements.contains(&change.measurement));
    }
    if !args.dry_run {
        accept(&changes)?;
    }
    terminal::stdout(|out| {
        for change in &changes {
            let OpenChange { file, test, measurement, change, .. } = change;
            let line = format!("{file}: {test}: `{measurement}` since {}", change.run);
            writeln!(out, "{}", escape::line(&line))?;
        }
        let verb = if args.dry_run { "would be accepted" } else { "accepted" };
        writeln!(out, "{} {verb}", format_count(changes.len() as u64, "change"))
    })?;
    Ok(ExitCode::SUCCESS)
}

fn refuse_unknown_names(plan: &rtf_plan::plan::Plan, names: &[String]) -> Result<(), Failure> {
    let tests = plan.suites.iter().flat_map(|suite| &suite.tests);
    let learnt: Vec<_> = tests.flat_map(|test| &test.learn).map(|it| &it.measurement).collect();
    let unknown = names.iter().find(|name| !learnt.contains(name));
    unknown.map_or(Ok(()), |name| {
        let error = format!("no selected test has `<learn measurement=\"{name}\"/>`");
        Err(Failure::input(error).hint("`rtf history accept --dry-run` lists the changes"))
    })
}

/// Writes the changes into the suite files. Tests of a matrix share an element: the newest of
/// their changes counts.
fn accept(changes: &[OpenChange]) -> Result<(), Failure> {
    let mut files: BTreeMap<&str, BTreeMap<u32, &OpenChange>> = BTreeMap::new();
    for change in changes {
        let elements = files.entry(&change.file).or_default();
        let element = elements.entry(change.span.start).or_insert(change);
        if change.change.started > element.change.started {
            *element = change;
        }
    }
    for (file, elements) in files {
        let read = fs::read_to_string(file).map_err(Failure::internal)?;
        // Positions are counted without the mark.
        let mark = if read.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len_utf8() } else { 0 };
        let mut text = read[mark..].to_owned();
        // From the end, so that the other positions stay valid.
        for change in elements.values().rev() {
            let since = change.change.started.to_string();
            text = with_since(&text, change.span, &since).ok_or_else(|| {
                Failure::internal(format!("`{file}` was changed while it was read"))
            })?;
        }
        output_file::write("the suite", Path::new(file), |out| {
            out.write_all(&read.as_bytes()[..mark])?;
            out.write_all(text.as_bytes())
        })
        .map_err(Failure::internal)?;
    }
    Ok(())
}

/// Sets the attribute `since` of a `<learn>` element. `None` if there is no such element.
fn with_since(text: &str, span: Span, since: &str) -> Option<String> {
    let start = usize::try_from(span.start).ok()?;
    let (before, rest) = text.split_at_checked(start)?;
    let attributes = rest.strip_prefix(TAG)?;
    let tag = TagEnd::find(attributes)?;
    let edited = match tag.since {
        Some(value) => {
            format!("{}{since}{}", &attributes[..value.start], &attributes[value.end..])
        }
        None => {
            let (inside, after) = attributes.split_at(tag.end);
            format!("{} since=\"{since}\"{after}", inside.trim_end())
        }
    };
    Some(format!("{before}{TAG}{edited}"))
}

/// Where the attributes of a start tag end, and where the value of `since` is.
#[derive(Default)]
struct TagEnd {
    end: usize,
    since: Option<std::ops::Range<usize>>,
}

impl TagEnd {
    fn find(attributes: &str) -> Option<Self> {
        let mut found = Self::default();
        let mut position = 0;
        loop {
            let rest = &attributes[position..];
            let next = rest.find(['"', '\'', '/', '>'])?;
            let at = position + next;
            let sign = rest[next..].chars().next()?;
            if matches!(sign, '/' | '>') {
                return Some(Self { end: at, ..found });
            }
            let value = at + 1..at + 1 + attributes[at + 1..].find(sign)?;
            let name = rest[..next].trim().trim_end_matches('=').trim_end();
            if name == "since" {
                found.since = Some(value.clone());
            }
            position = value.end + 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_attribute_is_added_or_replaced() {
        let edit = |text: &str, expected: &str| {
            let start = text.find(TAG).expect("an element");
            let edited = with_since(text, Span::new(start..start + TAG.len()), "T");
            assert_eq!(edited.as_deref(), Some(expected));
        };
        edit("<t><learn measurement='a>b'/></t>", "<t><learn measurement='a>b' since=\"T\"/></t>");
        edit("<learn measurement=\"a\" />", "<learn measurement=\"a\" since=\"T\"/>");
        edit(
            "<learn measurement='since'></learn>",
            "<learn measurement='since' since=\"T\"></learn>",
        );
        edit(
            "<learn since = '2026-01-01'\n  sigma='3'/><learn since='x'/>",
            "<learn since = 'T'\n  sigma='3'/><learn since='x'/>",
        );
        assert_eq!(with_since("<test/>", Span::new(0..6), "T"), None);
    }
}
