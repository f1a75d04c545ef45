//! `rtf campaign-task`: a worker as a task of a job array, in any of its attempts.

use std::collections::BTreeSet;
use std::process::ExitCode;
use std::time::Duration;

use rtf_campaign::EpisodeList;
use rtf_engine::signal::SignalListener;
use rtf_executor::ArrayTask;
use rtf_executor::EXIT_CODE;
use rtf_run::campaign::arrays::CampaignArray;
use rtf_run::campaign::directory::write;
use rtf_run::campaign::read_list;
use rtf_run::error::Failure;
use rtf_run::{VerbResult, exit, spawn_self};

use super::worker::{self, Answers};

/// SIGTERM.
const TERM: i32 = 15;

/// Runs the episodes of a task that have no result yet, and stores the exit code.
pub fn run(task: &ArrayTask, shutdown_timeout: Duration) -> VerbResult {
    let array = CampaignArray::open(&task.dir)?;
    let dir = array.campaign()?;
    let worker = array.worker(task.number);
    let mut list = read_list(&dir.worker_list(worker))?;
    let done: BTreeSet<u64> = dir.recorded_by(worker).iter().map(|line| line.episode).collect();
    list.episodes.retain(|episode| !done.contains(&episode.id));
    let attempt = task.attempt_dir();
    let code = match list.episodes.is_empty() {
        true => exit::PASSED,
        false if task.is_cancelled() => exit::of_signal(TERM),
        false => {
            let file = attempt.join("list.jsonl");
            write(&file, &EpisodeList::to_json_lines(&list))?;
            let command = worker::command_with_list(
                &dir,
                worker,
                &file,
                (shutdown_timeout, Answers::Nobody),
            )?;
            let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
            runtime.map_err(Failure::internal)?.block_on(wait(command.into()))?
        }
    };
    write(&attempt.join(EXIT_CODE), &format!("{code}\n"))?;
    Ok(ExitCode::from(code))
}

/// Runs the worker, and forwards signals to it. Returns its exit code.
async fn wait(mut command: tokio::process::Command) -> Result<u8, Failure> {
    let mut signals = SignalListener::install().map_err(Failure::internal)?;
    let mut child = command.spawn().map_err(Failure::internal)?;
    let process = child.id().and_then(spawn_self::pid);
    // Its run ends when this is closed, also if this process is killed.
    let _lifeline = child.stdin.take();
    loop {
        tokio::select! {
            status = child.wait() => {
                return status.map(spawn_self::exit_code).map_err(Failure::internal);
            }
            (number, _) = signals.next() => {
                if let Some(process) = process {
                    spawn_self::signal(process, number);
                }
            }
        }
    }
}
