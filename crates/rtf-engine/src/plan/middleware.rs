//! What is asked of middleware, as a command: rtf itself knows none. And which
//! of the fixture managers that come with rtf start some.

use std::path::PathBuf;
use std::time::Duration;

use rtf_model::Diagnostic;

use super::ProbeKind;
use super::hosts;
use super::plugin::shipped_folder;
use super::scope::Scope;
use crate::suite::{MiddlewareQuestion, Plugin};

/// How long one answer may take.
pub(super) const ANSWER: Duration = Duration::from_secs(5);
/// How long the program that asks may take beside that.
pub(super) const START: Duration = Duration::from_secs(2);
/// Below the folder of what comes with rtf.
const PROGRAM: &str = "rtf_fixtures/probe.py";
/// The interpreter needs nothing but its own library; for ROS 2 it needs what
/// the user has installed.
const BARE: [&str; 2] = ["-E", "-S"];

/// Those that bring middleware up. Recorders use what there is.
const STARTS: [&str; 6] =
    ["roscore", "roslaunch", "yarpserver", "yarpmanager", "ros2launch", "orocos"];

/// Whether a fixture starts middleware: the names are those of what comes with
/// rtf, and a plug-in of the user that is called so will do the same.
pub(super) fn starts(plugin: &Plugin) -> bool {
    plugin.plugin_type.is_none() && STARTS.contains(&plugin.name.value.as_str())
}

/// The program that asks.
pub(super) fn probe(
    asked: &MiddlewareQuestion,
    timeout: Duration,
    scope: &Scope<'_>,
) -> Result<ProbeKind, Box<Diagnostic>> {
    let program = shipped_folder(scope).map(|folder| folder.join(PROGRAM));
    let Some(program) = program.filter(|program: &PathBuf| program.is_file()) else {
        let message = format!("`{}` cannot be asked: `{PROGRAM}` is not there", asked.kind);
        let hint = "it is installed together with `rtf`, in `share/rtf/fixtures`";
        return Err(Diagnostic::error("no-such-program", message).hint(hint).into());
    };
    let mut command = vec![hosts::text(&hosts::python(scope)?)?];
    if !asked.kind.starts_with("ros2-") {
        command.extend(BARE.map(str::to_owned));
    }
    command.extend([hosts::text(&program)?, asked.kind.to_owned(), asked.name.clone()]);
    command.extend(["--timeout".to_owned(), timeout.as_secs_f64().to_string()]);
    if let Some(rate) = asked.min_rate {
        command.extend(["--min-rate".to_owned(), rate.to_string()]);
    }
    let subject = format!("{} `{}`", asked.kind, asked.name);
    Ok(ProbeKind::Middleware { command, subject })
}
