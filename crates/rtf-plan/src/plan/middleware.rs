//! Probes and signals of middleware, as commands: `rtf` itself speaks no middleware.

use std::path::PathBuf;
use std::time::Duration;

use rtf_model::Diagnostic;

use super::ProbeKind;
use super::host_kind;
use super::plugin_search::shipped_dir;
use super::program::utf8;
use super::search_scope::SearchScope;
use crate::suite::{MiddlewareProbe, SignalMiddleware};

/// The default limit for one answer.
pub(super) const TIMEOUT: Duration = Duration::from_secs(5);
/// The additional time for the start of the probe program.
pub(super) const STARTUP_TIME: Duration = Duration::from_secs(2);
/// The probe program, relative to the directory of the shipped fixture managers.
const PROGRAM: &str = "rtf_fixtures/probe.py";
/// The program that reads recordings.
const RECORDED_SIGNALS: &str = "rtf_fixtures/recorded_signals.py";
/// Options that speed up the interpreter; the ROS 2 probes need installed packages.
const ISOLATED: [&str; 2] = ["-E", "-S"];

/// Returns the program and first arguments of a command that writes values of topics or ports.
pub(super) fn signals(
    middleware: SignalMiddleware,
    scope: &SearchScope<'_>,
) -> Result<Vec<String>, Box<Diagnostic>> {
    let (program, consequence) = match middleware {
        SignalMiddleware::Ros => ("rtf_fixtures/ros1_signals.py", "topics of ROS 1 cannot be read"),
        SignalMiddleware::Ros2 => {
            ("rtf_fixtures/ros2_signals.py", "topics of ROS 2 cannot be read")
        }
        SignalMiddleware::Yarp => ("rtf_fixtures/yarp_signals.py", "ports of YARP cannot be read"),
    };
    python_program(program, consequence, scope)
}

/// Returns the program and first arguments of a command that writes values of a recording.
pub(super) fn recorded_signals(scope: &SearchScope<'_>) -> Result<Vec<String>, Box<Diagnostic>> {
    python_program(RECORDED_SIGNALS, "recordings cannot be read", scope)
}

fn python_program(
    program: &str,
    consequence: &str,
    scope: &SearchScope<'_>,
) -> Result<Vec<String>, Box<Diagnostic>> {
    let program = shipped_program(program, consequence, scope)?;
    Ok(vec![utf8(&host_kind::python(scope)?)?, utf8(&program)?])
}

fn shipped_program(
    name: &str,
    consequence: &str,
    scope: &SearchScope<'_>,
) -> Result<PathBuf, Box<Diagnostic>> {
    let program = shipped_dir(scope).map(|dir| dir.join(name));
    program.filter(|program| program.is_file()).ok_or_else(|| {
        let hint = "it is installed together with `rtf`, in `share/rtf/fixtures`";
        let message = format!("{consequence}: `{name}` is missing");
        Diagnostic::error("no-such-program", message).hint(hint).into()
    })
}

/// Plans the command of a probe.
pub(super) fn probe(
    query: &MiddlewareProbe,
    timeout: Duration,
    scope: &SearchScope<'_>,
) -> Result<ProbeKind, Box<Diagnostic>> {
    let program = shipped_program(PROGRAM, &format!("`{}` cannot be probed", query.kind), scope)?;
    let mut command = vec![utf8(&host_kind::python(scope)?)?];
    if !query.kind.starts_with("ros2-") {
        command.extend(ISOLATED.map(str::to_owned));
    }
    command.extend([utf8(&program)?, query.kind.to_owned(), query.name.clone()]);
    command.extend(["--timeout".to_owned(), timeout.as_secs_f64().to_string()]);
    if let Some(rate) = query.min_rate {
        command.extend(["--min-rate".to_owned(), rate.to_string()]);
    }
    let subject = format!("{} `{}`", query.kind, query.name);
    Ok(ProbeKind::Middleware { command, subject })
}
