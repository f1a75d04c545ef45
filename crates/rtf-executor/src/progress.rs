//! The progress of a job: its tasks, and the tests in their journals as they grow.

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use rtf_cluster::{Job, JobState};
use rtf_model::EventKind;
use rtf_report::journal;
use rtf_report::run_dir::JOURNAL;
use rtf_run::diagnostics::count;
use rtf_run::terminal;

use crate::submission::Submission;
use crate::task_progress::TaskProgress;

/// Prints the progress when it has changed.
pub struct Progress<'a> {
    job: &'a Job,
    submission: &'a Submission,
    journals: HashMap<PathBuf, GrowingJournal>,
    tasks: TaskProgress,
}

impl<'a> Progress<'a> {
    pub fn new(job: &'a Job, submission: &'a Submission) -> Self {
        let tasks = TaskProgress::new(job, submission.stored.tasks.len());
        Self { job, submission, journals: HashMap::new(), tasks }
    }

    /// Prints how to resume.
    pub fn print_start(&self) {
        let dir = self.submission.dir.to_string_lossy();
        let dir = shell_words::quote(&dir);
        let job = self.job;
        terminal::notice(format!("{job}: `rtf run --resume {dir}` resumes"));
    }

    /// Prints a line if something has changed.
    pub fn print(&mut self, state: &JobState) {
        let (finished, all) = (self.finished_tests(), self.submission.stored.tests as usize);
        self.tasks.print(state, &format!("; {finished} of {} finished", count(all, "test")));
    }

    fn finished_tests(&mut self) -> u32 {
        let tasks = self.submission.stored.tasks.iter();
        let runs = tasks.filter_map(|task| self.submission.last_run(*task));
        let journals = &mut self.journals;
        let counts = runs.map(|run| {
            let path = run.join(JOURNAL);
            let journal = journals.entry(path.clone()).or_default();
            // The next attempt to read it may succeed.
            let _ = journal.read_new(&path);
            journal.finished
        });
        counts.sum()
    }
}

/// A journal of which the beginning has been read.
#[derive(Default)]
struct GrowingJournal {
    /// The end of the last complete line that was read.
    offset: u64,
    finished: u32,
}

impl GrowingJournal {
    /// Counts the finished tests in complete new lines.
    fn read_new(&mut self, path: &Path) -> io::Result<()> {
        let mut file = File::open(path)?;
        file.seek(SeekFrom::Start(self.offset))?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes)?;
        let Some(end) = bytes.iter().rposition(|byte| *byte == b'\n') else { return Ok(()) };
        for line in bytes[..end].split(|byte| *byte == b'\n') {
            let event = journal::parse_event(line).ok();
            if event.is_some_and(|event| matches!(event.kind, EventKind::TestFinished { .. })) {
                self.finished += 1;
            }
        }
        self.offset += end as u64 + 1;
        Ok(())
    }
}
