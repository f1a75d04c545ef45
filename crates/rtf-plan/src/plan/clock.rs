//! The additional fixture of a suite with a `clock`: it writes the simulated time
//! to the file that tests follow, or checks that another fixture does.

use std::sync::Arc;
use std::time::Duration;

use rtf_model::Diagnostic;

use super::plugin_planner::PluginPlanner;
use super::plugin_search::shipped;
use super::use_site::UseSite;
use super::{ClockPlan, FixturePlan, added_fixture};
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
    let fixture = added_fixture::plan(added_fixture::free_name(NAME, others), plugin, others);
    Some(FixturePlan { check_every: Some(CHECK_EVERY), ..fixture })
}
