//! Runs a hook without a runner, or lets one that has begun come to its end.

use std::io;
use std::os::unix::process::CommandExt;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Instant;

use rtf_model::protocol::{
    CHANNEL_VARIABLE, Initialize, PROTOCOL_VERSION, Request, SCOPE_VARIABLE,
};
use rtf_model::{EventKind, TestId, Trigger};

use super::attend::{Attended, attend};
use super::closing::Happened;
use super::duties::{Begun, State, Streams};
use super::note::{Hook, HookBegins};
use super::unix::Signals;
use crate::run::machine::HOOK_NOT_RUN;
use rtf_process::namespaces::Namespaces;
use rtf_process::task::ProcessStream;
use rtf_process::{codec, resources, start_gate, tree};

/// The number of `run-test` on a hook's channel.
pub(super) const RUN: u64 = 2;

/// Why a hook is run now, and where.
#[derive(Debug)]
pub struct Why<'a> {
    /// In words.
    pub reason: &'a str,
    /// The test of its suite that ran.
    pub test: Option<&'a (TestId, String)>,
    /// The network of the suite.
    pub network: Option<&'a Arc<Namespaces>>,
}

/// A hook that ran.
#[derive(Debug)]
pub struct Ran {
    /// Why the robot may not be in a safe state.
    pub problem: Option<String>,
    /// From `hook-started` to `hook-finished`.
    pub happened: Vec<Happened>,
}

/// A process of a hook.
#[derive(Debug)]
pub(super) struct Process {
    pub pid: i32,
    pub streams: Streams,
    /// When its limit has passed.
    pub limit: Instant,
    /// Whether what it said until now was read by the runner.
    pub adopted: bool,
}

/// What the runner's death left of a hook that it had begun.
enum Found {
    /// It runs, or ended just now.
    Process(Process),
    /// It ended, and how was lost with the runner.
    Over,
    /// It did nothing yet.
    Nothing,
}

/// Runs it, or lets it come to its end.
pub fn run(hook: &Hook, state: State, why: &Why<'_>, signals: &mut Signals) -> Ran {
    let mut started = Instant::now();
    let mut begins = HookBegins {
        hook: hook.id,
        scope: format!("guard-{}.{}", std::process::id(), hook.id),
        trigger: Trigger::Interrupt,
        reason: why.reason.to_owned(),
        test: why.test.map(|(id, _)| *id),
    };
    let found = match state {
        State::Begun(begun) => {
            (started, begins) = (begun.at, begun.begins.clone());
            find(hook, begun)
        }
        State::Due | State::Done | State::Over => Found::Nothing,
    };
    let mut happened = vec![Happened { at: started, kind: begins.event() }];
    let process = match found {
        Found::Process(process) => Ok(process),
        Found::Over => Err("it ended, and how was lost with the runner".to_owned()),
        Found::Nothing if signals.kill() => Err(HOOK_NOT_RUN.to_owned()),
        Found::Nothing => start(hook, &begins, why).map_err(|error| {
            let program = hook.command.first().map_or("", String::as_str);
            format!("`{program}` cannot be started: {error}")
        }),
    };
    let problem = match process {
        Ok(process) => {
            let Attended { problem, happened: more } = attend(hook, process, signals);
            happened.extend(more);
            problem
        }
        Err(problem) => Some(problem),
    };
    let kind = EventKind::HookFinished { hook: hook.id, problem: problem.clone() };
    happened.push(Happened { at: Instant::now(), kind });
    Ran { problem, happened }
}

/// Looks for the process of a hook that the runner had begun. It waits until it
/// is asked, which the runner does once the guard knows the process.
fn find(hook: &Hook, begun: Begun) -> Found {
    match begun.pid {
        Some(pid) if tree::is_child(pid) => {
            ask(hook, &begun.streams);
            let limit = begun.at + hook.limit;
            Found::Process(Process { pid, streams: begun.streams, limit, adopted: true })
        }
        Some(_) => Found::Over,
        None => {
            if let Some(pid) = tree::child_of_scope(&begun.begins.scope) {
                tree::kill_tree(pid);
            }
            Found::Nothing
        }
    }
}

/// Asks again: one that was asked before ends without looking at the second time.
fn ask(hook: &Hook, streams: &Streams) {
    let asked = match &hook.plugin {
        Some(plugin) => codec::encode(Some(RUN), Request::RunTest(plugin.clone())),
        None => Ok(start_gate::GO.to_vec()),
    };
    let channel = streams.iter().find(|(kind, _)| *kind == ProcessStream::Channel);
    if let (Ok(line), Some((_, channel))) = (asked, channel) {
        // It may have ended meanwhile.
        let _ = rustix::io::write(channel, &line);
    }
}

fn start(hook: &Hook, begins: &HookBegins, why: &Why<'_>) -> io::Result<Process> {
    let Some((program, arguments)) = hook.command.split_first() else {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "an empty command"));
    };
    let mut command = Command::new(program);
    command.args(arguments).current_dir(&hook.folder).process_group(0);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.envs(hook.env.iter().map(|(name, value)| (name, value)));
    command.env("RTF_HOOK_TRIGGER", begins.trigger.as_str());
    command.env("RTF_HOOK_REASON", &begins.reason);
    command.env("RTF_HOOK_TEST", why.test.map_or("", |(_, name)| name.as_str()));
    command.env(SCOPE_VARIABLE, &begins.scope);
    if let Some(network) = why.network {
        network.enter(&mut command);
    }
    let mut streams = Streams::new();
    let mut theirs = None;
    if let Some(plugin) = &hook.plugin {
        let (ours, host) = std::os::unix::net::UnixStream::pair()?;
        let hello = Request::Initialize(Initialize {
            protocol: PROTOCOL_VERSION,
            rtf: env!("CARGO_PKG_VERSION").to_owned(),
            stack_file: None,
        });
        let mut lines = codec::encode(Some(codec::INITIALIZE), hello)?;
        lines.extend(codec::encode(Some(RUN), Request::RunTest(plugin.clone()))?);
        io::Write::write_all(&mut &ours, &lines)?;
        command.env(CHANNEL_VARIABLE, tree::inheritable(&host)?);
        streams.push((ProcessStream::Channel, ours.into()));
        theirs = Some(host);
    }
    resources::limit_descriptors_of(&mut command);
    let child = command.spawn();
    drop(theirs);
    let mut child = child?;
    streams.extend(child.stdout.take().map(|end| (ProcessStream::Stdout, end.into())));
    streams.extend(child.stderr.take().map(|end| (ProcessStream::Stderr, end.into())));
    let pid = i32::try_from(child.id()).map_err(io::Error::other)?;
    Ok(Process { pid, streams, limit: Instant::now() + hook.limit, adopted: false })
}
