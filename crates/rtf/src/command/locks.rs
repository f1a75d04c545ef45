//! `rtf locks`: lists the locks that are held on this machine, or waits for locks.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use rtf_engine::locks::{HeldLock, Locks};
use rtf_report::escape;
use rtf_run::error::Failure;
use rtf_run::{exit, terminal};

use super::VerbResult;
use crate::cli::LocksArgs;
use crate::request;

/// How often the locks are polled.
const INTERVAL: Duration = Duration::from_millis(50);

/// Lists locks or waits for them; the exit code is 1 if they were not free in time.
pub fn run(args: &LocksArgs) -> VerbResult {
    let mut held = poll(args)?;
    let start = Instant::now();
    while args.wait && !held.is_empty() && args.timeout.is_none_or(|limit| start.elapsed() < limit)
    {
        std::thread::sleep(INTERVAL);
        held = poll(args)?;
    }
    terminal::stdout(|out| {
        held.iter().try_for_each(|HeldLock { name, slot, owner, .. }| {
            let (name, owner) = (escape::line(name), owner.to_string());
            writeln!(out, "{name} #{slot}  {}", escape::line(&owner))
        })
    })?;
    if held.is_empty() && !args.wait {
        // For programs, standard output stays empty.
        terminal::notice("no locks are held");
    }
    Ok(ExitCode::from(if args.wait && !held.is_empty() { exit::FAILED } else { exit::PASSED }))
}

fn poll(args: &LocksArgs) -> Result<Vec<HeldLock>, Failure> {
    let dir = request::locks_dir();
    if !dir.exists() {
        return Ok(Vec::new());
    }
    let locks = Locks::open(&dir).map_err(Failure::internal)?;
    let mut held = locks.held().map_err(Failure::internal)?;
    held.retain(|held| args.names.is_empty() || args.names.contains(&held.name));
    Ok(held)
}
