//! The additional fixture of a suite with a `clock`: it writes the simulated time
//! to the file that tests follow, or checks that another fixture does.

use std::sync::Arc;
use std::time::Duration;

use rtf_model::{Diagnostic, FixtureId};

use super::plugin_planner::PluginPlanner;
use super::plugin_search::shipped;
use super::use_site::UseSite;
use super::{ClockPlan, FixtureBody, FixturePlan, defaults};
use crate::suite::{DeclaredClock, SourceText};

/// The name of the fixture and of its plug-in.
const NAME: &str = "clock";
/// The default limit in wall time, as a multiple of a test's limit.
const BACKSTOP: u32 = 10;
/// The interval at which the file is checked.
const CHECK_EVERY: Duration = Duration::from_secs(1);

/// Plans the clock and adds its fixture after all others.
pub(super) fn plan(
    planner: &mut PluginPlanner<'_, '_>,
    source: &Arc<SourceText>,
    declared: Option<DeclaredClock>,
    fixtures: &mut Vec<FixturePlan>,
) -> Option<ClockPlan> {
    let declared = declared?;
    let fixture = fixture(planner, source, &declared, fixtures)?;
    fixtures.push(fixture);
    Some(ClockPlan { backstop: declared.backstop.unwrap_or(BACKSTOP) })
}

fn fixture(
    planner: &mut PluginPlanner<'_, '_>,
    source: &Arc<SourceText>,
    declared: &DeclaredClock,
    others: &[FixturePlan],
) -> Option<FixturePlan> {
    let Some((file, kind)) = shipped(NAME, &planner.scope()) else {
        let message = "tests cannot follow the simulated time: `clock.py` is missing";
        let hint = "it is installed together with `rtf`, in `share/rtf/fixtures`";
        let problem = Diagnostic::error("no-such-plug-in", message).hint(hint);
        planner.context.problems.push(problem.label(source.label(declared.span, "")));
        return None;
    };
    let site = UseSite::Suite(Arc::clone(source), declared.span);
    let param = format!("--source {}", declared.source.word());
    let plugin = planner.plan_shipped(&file, kind, param, &site)?;
    let is_taken = |name: &str| others.iter().any(|other| other.name == name);
    let mut names = (2..).map(|number| format!("{NAME}#{number}"));
    let name = Some(NAME.to_owned()).filter(|name| !is_taken(name));
    Some(FixturePlan {
        id: FixtureId(0),
        name: name.or_else(|| names.find(|name| !is_taken(name)))?,
        provides: Vec::new(),
        depends: (0..others.len()).collect(),
        body: FixtureBody::Plugin(plugin),
        env: Vec::new(),
        limits: defaults::FIXTURE,
        reset: None,
        restarts: defaults::RESTARTS,
        restart_delay: defaults::RESTART_DELAY,
        check_every: Some(CHECK_EVERY),
    })
}
