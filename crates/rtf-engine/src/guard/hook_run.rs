//! Runs a hook without a runner, or adopts a hook that the dead runner has started.

use std::io;
use std::os::unix::process::CommandExt;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Instant;

use rtf_model::protocol::{CHANNEL_VARIABLE, Request, SCOPE_VARIABLE};
use rtf_model::{EventKind, TestId, Trigger};
use rtf_process::namespaces::Namespaces;
use rtf_process::task::ProcessStream;
use rtf_process::{codec, resources, start_failure, start_gate, tree};

use super::hook_process::{HookProcess, StreamEnds, supervise};
use super::journal_close::TimedEvent;
use super::message::{HookSpec, HookStart};
use super::recovery_state::{HookStatus, RunningHook};
use super::unix::GuardSignals;
use crate::hook::{HOOK_NOT_RUN, HookJudgement, RUN_REQUEST, trigger_variables};

#[derive(Debug)]
pub struct HookContext<'a> {
    /// The reason, for users.
    pub reason: &'a str,
    /// The interrupted test of its suite.
    pub test: Option<&'a (TestId, String)>,
    pub network: Option<&'a Arc<Namespaces>>,
    /// Why it cannot be started, if a value of a fixture is missing.
    pub resolved: Result<(), String>,
}

/// A hook that the dead runner has started.
enum StartedHook {
    /// It is running, or has just ended.
    Running(Box<HookProcess>),
    /// It has ended, and its result was lost with the runner.
    Ended,
    /// It has done nothing yet, or was never started.
    NotBegun,
}

/// Runs a hook, or waits for its end. Returns its problem, if any: the robot may not be in
/// a safe state; and its events from `hook-started` to `hook-finished`.
pub fn run(
    hook: &HookSpec,
    status: HookStatus,
    context: &HookContext<'_>,
    signals: &mut GuardSignals,
) -> (Option<String>, Vec<TimedEvent>) {
    let mut started = Instant::now();
    let mut start = HookStart {
        hook: hook.id,
        scope: format!("guard-{}.{}", std::process::id(), hook.id),
        trigger: Trigger::Interrupt,
        reason: context.reason.to_owned(),
        test: context.test.map(|(id, _)| *id),
    };
    let found = match status {
        HookStatus::Running(running) => {
            (started, start) = (running.at, running.start.clone());
            adopt(hook, running)
        }
        HookStatus::Due | HookStatus::Done | HookStatus::SuiteFinished => StartedHook::NotBegun,
    };
    let mut events = vec![TimedEvent { at: started, kind: start.event() }];
    let process = match found {
        StartedHook::Running(process) => Ok(*process),
        StartedHook::Ended => Err("it ended, and how was lost with the runner".to_owned()),
        StartedHook::NotBegun if signals.requests_kill() => Err(HOOK_NOT_RUN.to_owned()),
        StartedHook::NotBegun if let Err(problem) = &context.resolved => Err(problem.clone()),
        StartedHook::NotBegun => spawn(hook, &start, context).map_err(|error| {
            let program = hook.command.first().map_or("", String::as_str);
            format!("`{program}` cannot be started: {}", start_failure::describe(program, &error))
        }),
    };
    let problem = match process {
        Ok(process) => {
            let (problem, more) = supervise(process, signals);
            events.extend(more);
            problem
        }
        Err(problem) => Some(problem),
    };
    let kind = EventKind::HookFinished { hook: hook.id, problem: problem.clone() };
    events.push(TimedEvent { at: Instant::now(), kind });
    (problem, events)
}

/// Adopts the process of a hook that the runner has started. The process waits for its
/// request, which the runner sends once the guard knows the process.
fn adopt(hook: &HookSpec, running: RunningHook) -> StartedHook {
    match running.pid {
        Some(pid) if tree::is_child(pid) => {
            repeat_request(hook, &running.streams);
            StartedHook::Running(Box::new(HookProcess {
                hook: hook.id,
                pid,
                scope: running.start.scope,
                streams: running.streams,
                deadline: running.at + hook.limit,
                judgement: HookJudgement::adopted(hook.plugin.is_some(), hook.limit),
            }))
        }
        Some(_) => StartedHook::Ended,
        None => {
            if let Some(pid) = tree::child_of_scope(&running.start.scope) {
                tree::kill_tree(pid);
            }
            StartedHook::NotBegun
        }
    }
}

/// Sends the request again: a process that has received it ignores the second one.
fn repeat_request(hook: &HookSpec, streams: &StreamEnds) {
    let request = match &hook.plugin {
        Some(plugin) => codec::encode(Some(RUN_REQUEST), Request::RunTest(plugin.clone())),
        None => Ok(start_gate::GO.to_vec()),
    };
    let channel = streams.iter().find(|(stream, _)| *stream == ProcessStream::Channel);
    if let (Ok(line), Some((_, channel))) = (request, channel) {
        // Fails if the process has ended.
        let _ = rustix::io::write(channel, &line);
    }
}

fn spawn(hook: &HookSpec, start: &HookStart, context: &HookContext<'_>) -> io::Result<HookProcess> {
    let Some((program, arguments)) = hook.command.split_first() else {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "an empty command"));
    };
    let mut command = Command::new(program);
    command.args(arguments).current_dir(&hook.working_dir).process_group(0);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let test = context.test.map(|(_, name)| name.as_str());
    let variables = trigger_variables(start.trigger, &start.reason, test);
    command.envs(hook.env.iter().chain(&variables).map(|(name, value)| (name, value)));
    command.env(SCOPE_VARIABLE, &start.scope);
    if let Some(network) = context.network {
        network.enter(&mut command);
    }
    let mut streams = StreamEnds::new();
    let mut theirs = None;
    if let Some(plugin) = &hook.plugin {
        let (ours, host) = std::os::unix::net::UnixStream::pair()?;
        let mut lines = codec::greeting(None)?;
        lines.extend(codec::encode(Some(RUN_REQUEST), Request::RunTest(plugin.clone()))?);
        io::Write::write_all(&mut &ours, &lines)?;
        command.env(CHANNEL_VARIABLE, tree::inheritable(&host)?);
        streams.push((ProcessStream::Channel, ours.into()));
        theirs = Some(host);
    }
    resources::limit_descriptors_of(&mut command);
    rtf_process::reset_signals(&mut command);
    let child = command.spawn();
    drop(theirs);
    let mut child = child?;
    streams.extend(child.stdout.take().map(|end| (ProcessStream::Stdout, end.into())));
    streams.extend(child.stderr.take().map(|end| (ProcessStream::Stderr, end.into())));
    Ok(HookProcess {
        hook: hook.id,
        pid: i32::try_from(child.id()).map_err(io::Error::other)?,
        scope: start.scope.clone(),
        streams,
        deadline: Instant::now() + hook.limit,
        judgement: HookJudgement::new(hook.plugin.is_some(), hook.limit),
    })
}
