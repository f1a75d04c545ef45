//! The effect of a fault, from its injection to its removal.

use std::fmt::Debug;
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use rtf_statistics::RandomStream;
use rustix::process::Signal;

use crate::fill;
use crate::impairment::Impairment;
use crate::network;
use crate::pauses::{self, Pauses};
use crate::proxy;
use crate::settings::EffectSettings;
use crate::targets::{Target, Targets};

/// The time in which a slowed process is stopped once.
const PERIOD: Duration = Duration::from_millis(20);
/// How often new processes are looked for.
const SEARCH_INTERVAL: Duration = Duration::from_millis(250);

/// The effect of a fault that lasts.
#[derive(Debug)]
pub(crate) enum Effect {
    /// Of a fault that does not last.
    None,
    Paused(PausedProcesses),
    Held {
        /// The effect ends when it is dropped.
        _value: Box<dyn Debug + Send>,
    },
}

/// Begins the effect of a fault; returns it, and what was done.
///
/// # Errors
/// Why that is not possible.
pub(crate) fn begin(
    settings: &EffectSettings,
    pauses: &Mutex<Pauses>,
    is_cancelled: &AtomicBool,
) -> Result<(Effect, String), String> {
    match settings {
        EffectSettings::Kill(targets) => Ok((Effect::None, kill(targets)?)),
        EffectSettings::Stop(targets) => {
            let mut paused = PausedProcesses::new(targets, None);
            let stopped = paused.stop_all(&mut lock(pauses))?;
            Ok((Effect::Paused(paused), targets.describe("stopped", &stopped)))
        }
        EffectSettings::Slow { targets, percent } => {
            let mut paused = PausedProcesses::new(targets, Some(*percent));
            let stopped = paused.stop_all(&mut lock(pauses))?;
            let done = format!("slowed to {percent} %:");
            Ok((Effect::Paused(paused), targets.describe(&done, &stopped)))
        }
        EffectSettings::Memory(amount) => {
            let pieces = fill::memory(*amount, is_cancelled)?;
            let size = pieces.iter().map(|piece| piece.len() as u64).sum();
            let done = format!("filled {} of memory", fill::text_of(size));
            Ok((Effect::held(pieces), done))
        }
        EffectSettings::Network { fault, port, seed } => {
            let random = RandomStream::new(u64::from(*seed), "fault", "network");
            let impaired = network::impair(Impairment::new(*fault, *port, random))?;
            let port = port.map_or(String::new(), |port| format!(" of port {port}"));
            let done = format!("impaired the packets{port}: {fault}");
            Ok((Effect::held(impaired), done))
        }
        EffectSettings::Values { fixture, socket, fault } => {
            let changed = proxy::change(socket, fault)?;
            let field = fault.field.as_ref().map_or("messages".to_owned(), |it| format!("`{it}`"));
            let done = format!("changed {field} of `{fixture}`: {fault}");
            Ok((Effect::held(changed), done))
        }
        EffectSettings::Disk { dir, amount } => {
            let file = fill::disk(dir, *amount, is_cancelled)?;
            let size = file.metadata().map_or(0, |metadata| metadata.len());
            let done = format!("filled {} of `{}`", fill::text_of(size), dir.display());
            Ok((Effect::held(file), done))
        }
    }
}

impl Effect {
    fn held(value: impl Debug + Send + 'static) -> Self {
        Self::Held { _value: Box::new(value) }
    }

    /// What is due now; returns when it has to be called again.
    pub fn advance(&mut self, now: Instant, pauses: &mut Pauses) -> Option<Instant> {
        match self {
            Self::Paused(paused) => Some(paused.advance(now, pauses)),
            Self::None | Self::Held { .. } => None,
        }
    }

    /// Undoes it.
    pub fn end(self, pauses: &mut Pauses) {
        if let Self::Paused(mut paused) = self {
            paused.resume(pauses);
        }
    }
}

fn lock(pauses: &Mutex<Pauses>) -> std::sync::MutexGuard<'_, Pauses> {
    pauses.lock().unwrap_or_else(PoisonError::into_inner)
}

fn kill(targets: &Targets) -> Result<String, String> {
    let found = targets.find();
    let mut killed = Vec::new();
    for target in found {
        let done = pauses::signal(target.pid, targets, Signal::KILL);
        if done.map_err(|error| not_permitted("kill", &target, &error))? {
            killed.push(target);
        }
    }
    if killed.is_empty() {
        return Err(targets.missing());
    }
    Ok(targets.describe("killed", &killed))
}

fn not_permitted(what: &str, target: &Target, error: &std::io::Error) -> String {
    format!("cannot {what} `{}` (process {}): {error}", target.name, target.pid)
}

/// Processes that are stopped, always or for a part of the time.
#[derive(Debug)]
pub(crate) struct PausedProcesses {
    targets: Targets,
    /// The share of the time in which they may run.
    percent: Option<u32>,
    /// Those that are affected.
    known: Vec<u32>,
    is_stopped: bool,
    next_switch: Instant,
    next_search: Instant,
}

impl PausedProcesses {
    fn new(targets: &Targets, percent: Option<u32>) -> Self {
        let now = Instant::now();
        let (targets, known) = (targets.clone(), Vec::new());
        Self { targets, percent, known, is_stopped: true, next_switch: now, next_search: now }
    }

    /// Stops the processes that run, and those that they start during this time.
    fn stop_all(&mut self, pauses: &mut Pauses) -> Result<Vec<Target>, String> {
        let mut stopped = Vec::new();
        loop {
            let found = self.targets.find();
            let new = found.into_iter().filter(|it| !self.known.contains(&it.pid));
            let new: Vec<_> = new.collect();
            let mut any = false;
            for target in new {
                match pauses.stop(target.pid, &self.targets) {
                    Ok(false) => {}
                    Ok(true) => {
                        any = true;
                        self.known.push(target.pid);
                        stopped.push(target);
                    }
                    Err(error) => {
                        self.resume(pauses);
                        return Err(not_permitted("stop", &target, &error));
                    }
                }
            }
            if !any {
                break;
            }
        }
        let now = Instant::now();
        self.next_switch = now + self.pause();
        self.next_search = now + SEARCH_INTERVAL;
        if stopped.is_empty() { Err(self.targets.missing()) } else { Ok(stopped) }
    }

    fn advance(&mut self, now: Instant, pauses: &mut Pauses) -> Instant {
        if now >= self.next_search {
            self.next_search = now + SEARCH_INTERVAL;
            self.find_new(pauses);
        }
        if self.percent.is_some() && now >= self.next_switch {
            if self.is_stopped {
                self.known.iter().for_each(|pid| pauses.resume(*pid));
                self.next_switch = now + (PERIOD - self.pause());
            } else {
                self.known.retain(|pid| pauses.stop(*pid, &self.targets).unwrap_or(false));
                self.next_switch = now + self.pause();
            }
            self.is_stopped = !self.is_stopped;
        }
        match self.percent {
            Some(_) => self.next_search.min(self.next_switch),
            None => self.next_search,
        }
    }

    fn find_new(&mut self, pauses: &mut Pauses) {
        for target in self.targets.find() {
            if self.known.contains(&target.pid) {
                continue;
            }
            if !self.is_stopped || pauses.stop(target.pid, &self.targets).unwrap_or(false) {
                self.known.push(target.pid);
            }
        }
    }

    fn resume(&mut self, pauses: &mut Pauses) {
        if self.is_stopped {
            self.known.iter().for_each(|pid| pauses.resume(*pid));
        }
        self.known.clear();
    }

    /// How long they are stopped in each period.
    fn pause(&self) -> Duration {
        PERIOD * (100 - self.percent.unwrap_or(0).min(100)) / 100
    }
}
