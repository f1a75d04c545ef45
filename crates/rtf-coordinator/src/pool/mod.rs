//! Where the workers of a campaign run: as processes of this machine ([`local`]), or as tasks of
//! jobs in a cluster ([`cluster`]).

mod cluster;
mod local;

use std::path::PathBuf;
use std::time::Duration;

use rtf_model::Episode;
use rtf_report::console::AskedHere;
use rtf_report::episode_results::EpisodeLine;
use rtf_run::error::Failure;
use rtf_run::operator::campaign::CampaignAnswer;

use super::assignment::Assignment;

pub use cluster::ClusterPool;
pub use local::LocalPool;

/// The workers of a campaign.
#[expect(async_fn_in_trait, reason = "a single thread runs all pools")]
pub trait Pool {
    /// How often [`Pool::collect`] should be called.
    const POLL: Duration;

    /// Whether [`Pool::start`] and [`Pool::collect`] print lines.
    const PRINTS: bool;

    /// How many workers may be started now.
    fn free(&self) -> usize;

    /// Whether no worker runs.
    fn is_empty(&self) -> bool;

    /// Starts a worker for each list of episodes.
    async fn start(&mut self, lists: Vec<Vec<Episode>>) -> Result<(), Failure>;

    /// What has happened since the last call. All results of a worker come before its end.
    async fn collect(&mut self) -> Result<Vec<WorkerEvent>, Failure>;

    /// The question of each worker that the operator can answer now, with the worker's number.
    fn questions(&mut self) -> Vec<(u32, AskedHere)> {
        Vec::new()
    }

    /// Passes an answer to a worker.
    fn answer(&mut self, _worker: u32, _answer: &CampaignAnswer) {}

    /// Stops all workers, as the signal does for `rtf run`.
    async fn stop(&mut self, signal: i32);
}

#[derive(Debug)]
pub enum WorkerEvent {
    Result(EpisodeLine),
    Ended(EndedWorker),
}

#[derive(Debug)]
pub struct EndedWorker {
    /// Its number, and its episodes without a result.
    pub assignment: Assignment,
    /// Its exit code, as shells report it, if that is known.
    pub code: Option<u8>,
    /// Whether it was stopped before this process followed it.
    pub is_cancelled: bool,
    /// The files with what it printed.
    pub outputs: Vec<PathBuf>,
}
