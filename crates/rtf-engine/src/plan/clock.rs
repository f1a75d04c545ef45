//! The fixture that a suite with a `clock` has beside its own: it brings the
//! simulated time into the file that tests follow, or looks at who does.

use std::sync::Arc;
use std::time::Duration;

use rtf_model::{Diagnostic, FixtureId};

use super::context::{Place, PluginPlanner};
use super::fixture::{RESTART_DELAY, RESTARTS};
use super::plugin::shipped;
use super::{ClockPlan, FixtureBody, FixturePlan, defaults};
use crate::suite::{Source, WrittenClock};

/// Its name, and that of its plug-in.
const NAME: &str = "clock";
/// How many times a limit a test may take in wall time.
const BACKSTOP: u32 = 10;

/// How often it is looked at whether the file has a time.
const CHECK_EVERY: Duration = Duration::from_secs(1);

/// What tests follow, and the fixture for it, which comes after all others.
pub(super) fn plan(
    planner: &mut PluginPlanner<'_, '_>,
    source: &Arc<Source>,
    written: Option<WrittenClock>,
    fixtures: &mut Vec<FixturePlan>,
) -> Option<ClockPlan> {
    let written = written?;
    let fixture = fixture(planner, source, &written, fixtures)?;
    fixtures.push(fixture);
    Some(ClockPlan { backstop: written.backstop.unwrap_or(BACKSTOP) })
}

fn fixture(
    planner: &mut PluginPlanner<'_, '_>,
    source: &Arc<Source>,
    written: &WrittenClock,
    others: &[FixturePlan],
) -> Option<FixturePlan> {
    let Some((file, kind)) = shipped(NAME, &planner.scope()) else {
        let message = "the simulated time cannot be followed: `clock.py` is not there";
        let hint = "it is installed together with `rtf`, in `share/rtf/fixtures`";
        let problem = Diagnostic::error("no-such-plug-in", message).hint(hint);
        planner.context.problems.push(problem.label(source.label(written.span, "")));
        return None;
    };
    let place = Place::In(Arc::clone(source), written.span);
    let param = format!("--source {}", written.source.word());
    let plugin = planner.plan_shipped(&file, kind, param, &place)?;
    let taken = |name: &str| others.iter().any(|other| other.name == name);
    let mut names = (2..).map(|number| format!("{NAME}#{number}"));
    let name = Some(NAME.to_owned()).filter(|name| !taken(name));
    Some(FixturePlan {
        id: FixtureId(0),
        name: name.or_else(|| names.find(|name| !taken(name)))?,
        depends: (0..others.len()).collect(),
        body: FixtureBody::Plugin(plugin),
        env: Vec::new(),
        limits: defaults::FIXTURE,
        restarts: RESTARTS,
        restart_delay: RESTART_DELAY,
        check_every: Some(CHECK_EVERY),
    })
}
