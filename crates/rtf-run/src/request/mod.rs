//! What is to be run, as plain data.

mod failed_cases;
pub mod past_run;
mod past_tests;
pub mod rerun;

use std::num::NonZeroU16;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use rtf_engine::locks::LockOptions;
use rtf_history::Location;
use rtf_model::{Diagnostic, Episode, Manifest, Parameter};
use rtf_plan::plan::{InputPath, Options};
use rtf_plan::select::{Shard, TestOrder};
use rtf_plan::suite::episode_reference;
use rtf_process::fork_server::ForkMode;
use rtf_web::Settings;

use crate::campaign::EpisodeStream;
use crate::debug::DebugRequest;
use crate::formats::{Annotations, OutputFormat, ReportFormat};
use crate::history::PastTests;
use crate::operator::Attendance;
use crate::revision::RevisionQuery;
pub use past_tests::PastQuery;

pub struct RunRequest {
    pub tests: TestsRequest,
    pub results: PathBuf,
    /// How to choose another results directory, for hints.
    pub results_option: &'static str,
    /// A further symbolic link to the directory of the run.
    pub symlink: Option<PathBuf>,
    pub web: Option<WebRequest>,
    pub fork_mode: ForkMode,
    /// The number of failed tests after which the remaining tests are skipped.
    pub max_fail: Option<u32>,
    pub locks: LockOptions,
    pub jobs: NonZeroU16,
    /// How long the run may take to end after a signal or a request to stop.
    pub shutdown_timeout: Duration,
    /// How the only test is debugged.
    pub debug: Option<DebugRequest>,
    /// Who can answer questions of tests.
    pub attendance: Attendance,
    /// The history, from which limits are learned and which the page shows.
    pub database: Location,
    /// The revision of the sources, which Git finds out during the planning.
    pub revision: RevisionQuery,
}

/// What `rtf run` prints, and the reports that it writes.
pub struct OutputRequest {
    pub format: OutputFormat,
    pub verbose: bool,
    pub annotations: Annotations,
    pub reports: Vec<(ReportFormat, PathBuf)>,
    /// The results directory.
    pub results: PathBuf,
    /// Whether a progress bar may be shown.
    pub progress: bool,
}

/// The web server of a run.
pub struct WebRequest {
    pub settings: Settings,
    /// How to choose another address, for hints.
    pub hint: Option<&'static str>,
    pub linger: Option<Duration>,
}

/// The tests of a run.
pub struct TestsRequest {
    pub inputs: Vec<InputPath>,
    /// The options of planning, with the directory that the inputs are relative to.
    pub options: Options,
    /// The request as the run's first event records it; it also has the filters, the
    /// order and the repetitions.
    pub manifest: Manifest,
    /// The order by past results.
    pub order: Option<(TestOrder, Arc<PastTests>)>,
    /// The part of the selected tests to run, and the past results from which it is computed.
    pub shard: Option<(Shard, Option<Arc<PastTests>>)>,
    /// The episodes of a campaign to run; empty without a campaign.
    pub episodes: Vec<Episode>,
    /// Further episodes, which arrive while the suite runs.
    pub episode_stream: Option<EpisodeStream>,
    /// The number of slots of a test that runs many episodes, instead of that in its suite.
    pub slots: Option<u32>,
    /// Whether the plug-ins were checked on this machine just before.
    pub is_checked: bool,
    /// Problems that prevent nothing.
    pub warnings: Vec<Diagnostic>,
}

impl TestsRequest {
    /// All tests of these inputs. The manifest is that of the run's first event.
    pub fn new(inputs: Vec<InputPath>, options: Options, manifest: Manifest) -> Self {
        Self {
            inputs,
            options,
            manifest,
            order: None,
            shard: None,
            episodes: Vec::new(),
            episode_stream: None,
            slots: None,
            is_checked: false,
            warnings: Vec::new(),
        }
    }

    /// Runs a suite once for each episode. Its parameters are references, which are replaced when
    /// a process starts.
    pub fn set_episodes(&mut self, suite: PathBuf, episodes: Vec<Episode>) {
        let parameters = episodes.first().map_or(&[][..], |first| &first.parameters);
        for Parameter { name, value } in parameters {
            let reference = episode_reference::to(name);
            self.options.config_request.params.push((name.clone(), reference));
            // `--rerun` repeats a single episode as an ordinary run.
            if episodes.len() == 1 && self.episode_stream.is_none() {
                let value = episodes.first().map_or_else(String::new, |it| it.mask(value));
                self.manifest.set.push(format!("{name}={value}"));
            }
        }
        self.manifest.inputs = vec![suite.to_string_lossy().into_owned()];
        self.inputs = vec![InputPath::Suite(suite)];
        self.episodes = episodes;
    }
}
