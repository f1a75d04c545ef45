//! Makes one stream of events of several runs: of the parts of one run, or of
//! any runs that have no test in common. The workers of a campaign have the same tests, and
//! different episodes.
//!
//! The runs may have gone on at the same time, on different machines. Their
//! fixtures did, too, and one stream cannot say so of one fixture. So the
//! merged run reads as if one runner had done everything: one suite after the
//! other, and of each suite one part after the other, in the order in which the
//! runs are given. Within a part, times keep their distances.
//!
//! Each journal is read twice, one at a time. Memory holds the plan of the merged run and one
//! event, not the events of the runs:
//!
//! - [`first_pass`]: checks each journal, and finds out where each suite is in it.
//! - [`plan`]: which suites, fixtures, hooks and tests there are, and their ids.
//! - [`manifest`]: what was asked for, and whether a part is missing.
//! - [`kept_attachments`]: which attachments are kept.
//! - [`suite`] and [`piece`]: what happened in a suite, one part after the other, from the
//!   journals.
//! - [`lives`]: which fixtures, hooks and tests are open.
//! - [`episode_tests`]: the repetitions of tests that several parts have.
//!
//! `spec/events.md` says what the merged stream has of which run.

mod attached_file;
mod episode_tests;
mod first_pass;
mod kept_attachments;
mod lives;
mod manifest;
mod piece;
mod place;
mod plan;
mod problem;
mod suite;

use std::path::PathBuf;

use rtf_model::{EVENTS_VERSION, Event, EventKind, Micros, RunStarted, SuiteId};

pub use attached_file::{AttachedFile, attachment_path};
pub use kept_attachments::{Keep, UnknownKeep};
pub use problem::MergeProblem;

use crate::ReportError;
use crate::journal::JournalError;
use first_pass::FirstPass;
use piece::Parts;

/// One of the runs.
#[derive(Clone, Debug)]
pub struct MergeInput {
    /// What it is called, in words for people.
    pub name: String,
    /// Its journal, in its directory.
    pub journal: PathBuf,
}

/// The values of the merged run itself.
#[derive(Clone, Debug)]
pub struct Header {
    pub run: String,
    /// The version of the program.
    pub rtf: String,
    /// The command line that merges.
    pub command: Vec<String>,
}

/// Takes in an event of the merged run, and the file that it attaches.
pub type Visit<'a> = &'a mut dyn FnMut(&Event, Option<&AttachedFile>) -> Result<(), ReportError>;

/// Runs of which one can be made.
#[derive(Debug)]
pub struct Mergeable {
    runs: Vec<MergeInput>,
    pass: FirstPass,
}

#[derive(Clone, Copy, Debug, Default)]
pub struct MergeOptions {
    /// Whether parts of a division may be missing.
    pub partial: bool,
    pub keep: Keep,
}

/// Reads the runs and finds out whether one run can be made of them.
///
/// # Errors
/// Every reason why not. Whether tests or parts are missing or there twice is known only if all
/// runs can be read.
pub fn merge(runs: Vec<MergeInput>, options: MergeOptions) -> Result<Mergeable, Vec<MergeProblem>> {
    let mut pass = FirstPass::of(options.keep);
    let unusable: Vec<_> = runs.iter().filter_map(|run| pass.read(run).err()).collect();
    if !unusable.is_empty() {
        return Err(unusable);
    }
    let mut problems = pass.duplicates(&runs);
    if !options.partial {
        problems.extend(pass.manifests.missing());
    }
    if problems.is_empty() { Ok(Mergeable { runs, pass }) } else { Err(problems) }
}

impl Mergeable {
    /// Passes all events of the merged run to `visit`, as they are read.
    ///
    /// # Errors
    /// A journal cannot be read again; and the first error of `visit`.
    pub fn write(self, header: Header, visit: Visit<'_>) -> Result<(), JournalError> {
        let Self { runs, pass } = self;
        let FirstPass { plans, manifests, suites, warnings, kept, ends } = pass;
        let plan = plans.plan.numbered();
        let mut out = Merging { visit, seq: 0, now: Micros::default() };
        out.push(EventKind::RunStarted(RunStarted {
            version: EVENTS_VERSION,
            run: header.run,
            rtf: header.rtf,
            command: header.command,
            suites: count(plan.suites.len()),
            tests: count(plan.tests.len()),
            manifest: Box::new(manifests.manifest(plan.tests.len())),
            started_at: manifests.started_at,
            working_dir: manifests.working_dir,
        }))?;
        plan.events().try_for_each(|kind| out.push(kind))?;
        let warnings = warnings.into_iter().map(|diagnostic| EventKind::Warning { diagnostic });
        warnings.into_iter().try_for_each(|kind| out.push(kind))?;
        let parts = Parts { runs: &runs, plan: &plan, kept: &kept };
        for (id, suite) in (0..).map(SuiteId).zip(suites) {
            suite.write(id, &parts, &mut out)?;
        }
        out.push(ends.into_event())
    }
}

fn count(len: usize) -> u32 {
    u32::try_from(len).unwrap_or(u32::MAX)
}

/// The stream that is being made.
struct Merging<'a> {
    visit: Visit<'a>,
    /// The number of the next event.
    seq: u64,
    now: Micros,
}

impl Merging<'_> {
    fn push(&mut self, kind: EventKind) -> Result<(), JournalError> {
        self.push_with(kind, None)
    }

    /// Adds an event that attaches this file.
    fn push_with(
        &mut self,
        kind: EventKind,
        file: Option<&AttachedFile>,
    ) -> Result<(), JournalError> {
        let event = Event { seq: self.seq, at: self.now, kind };
        self.seq += 1;
        Ok((self.visit)(&event, file)?)
    }
}
