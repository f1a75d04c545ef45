//! A summary of a run in Markdown, for the page of a CI job: the outcome first, then what
//! made it red, then the questions and the measurements.
//!
//! Text of plug-ins is shown literally. The length is limited,
//! because code hosts refuse long summaries; each section states what it leaves out.

mod failed_tests;
mod inline;
mod measurements;
mod problems;
mod questions;

use std::io::{self, Write};
use std::path::Path;

use rtf_model::Record;

use crate::console::TestCommands;
use crate::finding::Roots;
use crate::{finding, outcome, words as phrases};
use inline::link;
pub use inline::{code, words};

/// Maximum number of damaged places that are listed.
const DAMAGES: usize = 10;

/// What the summary names besides the record.
pub struct MarkdownOptions<'a> {
    /// The directory to which file names are relative; `None`: the run's.
    pub repository: Option<&'a Path>,
    /// The run directory for display, which contains the logs.
    pub dir: Option<&'a Path>,
    /// The address of the run's results: an artefact, or a page.
    pub url: Option<&'a str>,
    pub commands: TestCommands,
}

/// Writes the summary of a record.
///
/// # Errors
/// `out` cannot be written.
pub fn write(
    out: &mut dyn Write,
    record: &Record,
    options: &MarkdownOptions<'_>,
) -> io::Result<()> {
    let mut page = String::new();
    head(&mut page, record, options);
    let roots = Roots::new(record, options.repository);
    problems::hooks(&mut page, record, options);
    problems::fixtures(&mut page, record);
    failed_tests::show(&mut page, record, &roots, options);
    problems::flaky(&mut page, record);
    problems::known(&mut page, record);
    problems::skipped(&mut page, record);
    problems::leaked(&mut page, record);
    questions::show(&mut page, record);
    measurements::show(&mut page, record);
    problems::hook_runs(&mut page, record);
    problems::warnings(&mut page, record);
    out.write_all(page.as_bytes())
}

/// The outcome, the totals, and where the results are.
fn head(page: &mut String, record: &Record, options: &MarkdownOptions<'_>) {
    let mark = if record.is_green() { "✅" } else { "❌" };
    *page += &format!("## {mark} {}\n\n", inline::words(&outcome::word(record)));
    if let Some(problem) = finding::run_problem(record) {
        *page += &format!("**This run is not green:** {}\n\n", code(&problem));
    }
    if record.damages.len() > 1 {
        let damages: Vec<_> = record.damages.iter().map(ToString::to_string).collect();
        list(page, &damages, DAMAGES, "damaged place", |damage| code(damage));
    }
    *page += &format!("{}\n", outcome::totals(record));
    let mut places = Vec::new();
    if let Some(run) = &record.run {
        places.push(format!("run {}", code(&run.run)));
    }
    places.extend(options.url.map(|url| link("results", url)));
    places.extend(options.dir.map(|dir| format!("directory {}", code(&dir.to_string_lossy()))));
    if !places.is_empty() {
        *page += &format!("\n{}\n", places.join(" · "));
    }
}

/// A heading below that of the page.
fn heading(page: &mut String, text: &str) {
    let gap = if page.ends_with("\n\n") { "" } else { "\n" };
    *page += &format!("{gap}### {text}\n\n");
}

/// A list with a limited number of items, and the number of omitted ones.
fn list<T>(
    page: &mut String,
    items: &[T],
    limit: usize,
    noun: &str,
    mut show: impl FnMut(&T) -> String,
) {
    for item in items.iter().take(limit) {
        *page += &format!("- {}\n", show(item));
    }
    if items.len() > limit {
        let more = (items.len() - limit) as u64;
        *page += &format!("- … and {more} more {}\n", phrases::plural(more, noun));
    }
    *page += "\n";
}

fn row(page: &mut String, cells: &[String]) {
    *page += &format!("| {} |\n", cells.join(" | "));
}
