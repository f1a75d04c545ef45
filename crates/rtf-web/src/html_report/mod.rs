//! A run as one HTML file: the page without a server, with the run's data in it.
//!
//! The data is that of the API: [`write()`] reads the journal as the server does, and the
//! page reads the data in place of requests. See `spec/reports.md`.

mod attachments;
mod chunks;
mod collector;
mod details;
mod excerpt;
mod template;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

use rtf_report::console::TestCommands;
use serde::Serialize;

use crate::campaign_report::CampaignReport;
use crate::index::Index;
use crate::views::{Snapshot, TestDetail};
use attachments::AttachmentFiles;
use chunks::Chunks;
use collector::Collector;
use template::Template;

/// The version of the data's format.
const FORMAT: u32 = 1;

#[derive(Clone, Copy)]
pub struct ReportSource<'a> {
    /// The journal of the run, in the run directory.
    pub journal: &'a Path,
    /// The report's file, next to which large attachments are; `None`: standard output.
    pub output: Option<&'a Path>,
    pub commands: &'a TestCommands,
    /// The run directory for display.
    pub dir: Option<&'a Path>,
}

/// Everything that is needed to draw the run, without details.
#[derive(Serialize)]
struct Overview<'a> {
    format: u32,
    run: &'a str,
    snapshot: Snapshot,
    /// The chunk of each key.
    places: BTreeMap<String, u32>,
}

/// Whether this build contains the page.
#[must_use]
pub fn is_available() -> bool {
    Template::built().is_ok()
}

/// Writes the report of a run.
///
/// # Errors
/// The journal or an attachment cannot be read, the report or an attachment cannot be
/// written, or this build has no page.
pub fn write(out: &mut dyn Write, source: &ReportSource<'_>) -> io::Result<()> {
    fill(&Template::built()?, out, source)
}

/// Writes the report of a campaign.
///
/// # Errors
/// The report cannot be written, or this build has no page.
pub fn write_campaign(out: &mut dyn Write, campaign: &CampaignReport) -> io::Result<()> {
    let template = Template::built()?;
    out.write_all(template.head.as_bytes())?;
    chunks::write_block(out, "overview", &CampaignOverview { format: FORMAT, campaign })?;
    out.write_all(template.tail.as_bytes())
}

/// Everything that is needed to draw a campaign.
#[derive(Serialize)]
struct CampaignOverview<'a> {
    format: u32,
    campaign: &'a CampaignReport,
}

fn fill(template: &Template, out: &mut dyn Write, source: &ReportSource<'_>) -> io::Result<()> {
    let journal = File::open(source.journal)?;
    let mut index = Index::ended(journal.try_clone()?);
    index.advance()?;
    let record = &index.record;
    out.write_all(template.head.as_bytes())?;
    let mut chunks = Chunks::new(out);
    let files = AttachmentFiles::new(source.journal, source.output);
    Collector::new(record, files, &mut chunks).read(journal, index.offset)?;
    for test in &record.tests {
        let id = test.plan.test;
        let command = (source.commands.rerun)(record, id, None);
        let replay = &source.commands.replay;
        let replay = source.dir.and_then(|dir| index.replay_command(replay, test, dir));
        let is_over = index.state().is_over();
        let detail = TestDetail::of(test, record, is_over, (command, replay));
        chunks.add(format!("tests/{id}"), &detail)?;
    }
    let run = record.run.as_ref().map_or("run", |run| &*run.run);
    let snapshot = Snapshot::of(run, &index);
    let (out, places) = chunks.finish()?;
    chunks::write_block(out, "overview", &Overview { format: FORMAT, run, snapshot, places })?;
    out.write_all(template.tail.as_bytes())
}

#[cfg(test)]
mod tests;
