//! A worker: `rtf run` with a list of episodes, in a separate process with a guard and a journal.

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::time::Duration;

use rtf_model::Episode;
use rtf_report::episode_results::{EPISODE_RESULTS, EpisodeLine};

use crate::campaign::directory::CampaignDir;
use crate::error::Failure;
use crate::spawn_self;

/// The file with what a worker printed.
pub const OUTPUT: &str = "output.txt";

/// A running worker.
#[derive(Debug)]
pub struct Worker {
    pub number: u32,
    child: Child,
    /// The run ends when this is closed, also if this process is killed.
    _lifeline: Option<ChildStdin>,
    results: ResultFollower,
    /// Its episodes without a result.
    pub left: Vec<u64>,
    /// The episode that has started and not finished.
    pub running: Option<u64>,
    /// Whether an episode has finished.
    pub has_results: bool,
}

impl Worker {
    /// Starts a worker.
    pub fn start(
        dir: &CampaignDir,
        number: u32,
        episodes: &[Episode],
        shutdown_timeout: Duration,
    ) -> Result<Self, Failure> {
        let list = dir.create_worker(number, episodes)?;
        let (results, description) = (dir.worker(number), &dir.description);
        let output = File::create(results.join(OUTPUT)).map_err(Failure::internal)?;
        let mut args: Vec<std::ffi::OsString> = vec!["run".into()];
        args.extend(["--color", "never", "--no-history"].map(Into::into));
        args.push(spawn_self::END_WITH_STDIN.into());
        args.push(format!("--shutdown-timeout={}ms", shutdown_timeout.as_millis()).into());
        args.extend(["--results".into(), results.clone().into()]);
        args.extend(["--episodes".into(), list.into()]);
        args.extend(description.options.iter().map(Into::into));
        args.extend(["--".into(), description.suite.clone().into()]);
        let mut command: Command = spawn_self::command(args).map_err(Failure::internal)?;
        command.current_dir(&description.working_dir);
        command.stdout(output.try_clone().map_err(Failure::internal)?).stderr(Stdio::from(output));
        let mut child = command.spawn().map_err(Failure::internal)?;
        Ok(Self {
            number,
            _lifeline: child.stdin.take(),
            child,
            results: ResultFollower::new(results.join("latest").join(EPISODE_RESULTS)),
            left: episodes.iter().map(|episode| episode.id).collect(),
            running: None,
            has_results: false,
        })
    }

    /// The results that have arrived since the last call.
    pub fn new_results(&mut self) -> Vec<EpisodeLine> {
        let lines = self.results.read();
        for line in &lines {
            self.running = line.outcome.is_none().then_some(line.episode);
            if line.outcome.is_some() {
                self.has_results = true;
                self.left.retain(|episode| *episode != line.episode);
            }
        }
        lines.into_iter().filter(|line| line.outcome.is_some()).collect()
    }

    /// Its exit code, as shells report it, if it has ended.
    pub fn exit_code(&mut self) -> Option<u8> {
        let status = self.child.try_wait().ok()??;
        Some(crate::command::watch::exit_code(status))
    }

    /// Sends a signal.
    pub fn signal(&self, number: i32) {
        if let Some(pid) = spawn_self::pid(self.child.id()) {
            spawn_self::signal(pid, number);
        }
    }
}

/// The last lines that a worker printed.
pub fn last_output(dir: &Path) -> String {
    let text = std::fs::read_to_string(dir.join(OUTPUT)).unwrap_or_default();
    let lines: Vec<&str> = text.trim_end().lines().collect();
    lines[lines.len().saturating_sub(20)..].join("\n")
}

/// Reads a growing file of results.
#[derive(Debug)]
struct ResultFollower {
    path: PathBuf,
    file: Option<File>,
    /// A line that is not complete.
    rest: String,
}

impl ResultFollower {
    fn new(path: PathBuf) -> Self {
        Self { path, file: None, rest: String::new() }
    }

    /// The complete lines that were added since the last call.
    fn read(&mut self) -> Vec<EpisodeLine> {
        if self.file.is_none() {
            self.file = File::open(&self.path).ok();
        }
        let Some(file) = &mut self.file else { return Vec::new() };
        let mut bytes = Vec::new();
        // After an error, the next call continues where this one has stopped.
        let _ = file.read_to_end(&mut bytes);
        self.rest += &String::from_utf8_lossy(&bytes);
        let end = self.rest.rfind('\n').map_or(0, |end| end + 1);
        let complete: String = self.rest.drain(..end).collect();
        complete.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
    }
}
