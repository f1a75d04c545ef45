//! `rtf locks`: who has what there is only once on this machine.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use rtf_engine::locks::{DEFAULT_DIR, DIR_VARIABLE, HeldLock, Locks};
use rtf_report::escape;

use super::Outcome;
use crate::cli::LocksArgs;
use crate::error::Failure;
use crate::exit;

/// How often is looked whether a lock is free.
const EVERY: Duration = Duration::from_millis(50);

/// Shows the locks, or waits for them. The exit code is 1 when the time was
/// over before they were free.
pub fn run(args: &LocksArgs) -> Outcome {
    let folder = folder();
    if !folder.exists() {
        return Ok(if args.wait { ExitCode::SUCCESS } else { free() });
    }
    let locks = Locks::open(&folder).map_err(Failure::own)?;
    let begun = Instant::now();
    loop {
        let mut held = locks.held().map_err(Failure::own)?;
        held.retain(|held| args.names.is_empty() || args.names.contains(&held.name));
        let over = args.timeout.is_some_and(|limit| begun.elapsed() >= limit);
        if held.is_empty() || !args.wait || over {
            Failure::unless_reader_left(show(&held))?;
            if held.is_empty() && !args.wait {
                return Ok(free());
            }
            let late = args.wait && !held.is_empty();
            return Ok(ExitCode::from(if late { exit::FAILED } else { 0 }));
        }
        std::thread::sleep(EVERY);
    }
}

/// Said to people; for programs, no lock is no line.
fn free() -> ExitCode {
    anstream::eprintln!("nobody has a lock");
    ExitCode::SUCCESS
}

/// The folder of this machine's locks.
pub fn folder() -> PathBuf {
    std::env::var_os(DIR_VARIABLE)
        .filter(|folder| !folder.is_empty())
        .map_or_else(|| PathBuf::from(DEFAULT_DIR), PathBuf::from)
}

fn show(held: &[HeldLock]) -> std::io::Result<()> {
    let mut out = anstream::stdout().lock();
    for held in held {
        let owner = held.owner.to_string();
        writeln!(out, "{} #{}  {}", escape::line(&held.name), held.slot, escape::line(&owner))?;
    }
    Ok(())
}
