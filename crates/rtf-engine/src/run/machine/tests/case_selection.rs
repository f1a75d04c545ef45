//! Tests of which only some cases run.

use rtf_model::protocol::{CaseSelector, Notification, Reply, Request};
use rtf_model::{CaseId, CaseStart, Verdict};
use rtf_plan::plan::{CaseSelection, CaseSelectionOrigin, SuitePlan};
use serde_json::json;

use super::world::{TEST, World, suite};
use crate::run::machine::ProcessEvent;

fn selecting(path: &str, origin: CaseSelectionOrigin) -> SuitePlan {
    let mut plan = suite(0, 1);
    let selectors = vec![CaseSelector::Equals(path.to_owned())];
    plan.tests[0].select_cases(CaseSelection { selectors, origin });
    plan
}

fn initialized(world: &mut World<'_>, selects_cases: bool) {
    let value = json!({ "protocol": 1, "host": "scratch 1", "selects_cases": selects_cases });
    world.input(TEST, ProcessEvent::Replied(1, Reply::Result(value)));
}

fn run_case(world: &mut World<'_>, name: &str) {
    let (case, name) = (CaseId(1), name.to_owned());
    let start = CaseStart::new(case, name);
    world.input(TEST, ProcessEvent::Notified(Notification::CaseStarted(start)));
    let (outcome, reason, duration_us, rerun) = (None, None, None, false);
    let end =
        Notification::CaseFinished { case, outcome, reason, duration_us, rerun, episode: None };
    world.input(TEST, ProcessEvent::Notified(end));
}

fn verdict(mut world: World<'_>) -> (Verdict, Option<String>) {
    world.end(TEST, "passed");
    world.finish();
    let test = &world.record.tests[0];
    (test.final_verdict(), test.reason().map(str::to_owned))
}

#[test]
fn the_host_gets_the_selectors() {
    let plan = selecting("up", CaseSelectionOrigin::Named);
    let world = World::started(&plan);
    let sent = world.sent.iter().find_map(|(_, _, request)| match request {
        Request::RunTest(plugin) => Some(plugin.cases.clone()),
        _ => None,
    });
    assert_eq!(sent, Some(vec![CaseSelector::Equals("up".to_owned())]));
}

#[test]
fn a_host_that_cannot_select_is_an_error_except_in_a_rerun() {
    use CaseSelectionOrigin::{Filter, Named, Rerun};
    for origin in [Filter, Named] {
        let plan = selecting("up", origin);
        let mut world = World::running(&plan);
        initialized(&mut world, false);
        run_case(&mut world, "up");
        let reason = Some("scratch 1 cannot select cases".to_owned());
        assert_eq!(verdict(world), (Verdict::Error, reason));
    }
    let plan = selecting("up", Rerun);
    let mut world = World::running(&plan);
    initialized(&mut world, false);
    run_case(&mut world, "up");
    assert_eq!(verdict(world), (Verdict::Passed, None));
}

#[test]
fn a_named_case_that_does_not_exist_is_an_error() {
    use CaseSelectionOrigin::{Filter, Named, Rerun};
    for (origin, passes) in [(Filter, true), (Named, false), (Rerun, false)] {
        let plan = selecting("up", origin);
        let mut world = World::running(&plan);
        initialized(&mut world, true);
        let (verdict, reason) = verdict(world);
        assert_eq!(verdict, if passes { Verdict::Passed } else { Verdict::Error });
        let expected = (!passes).then(|| "the test has no case `up`".to_owned());
        assert_eq!(reason, expected);
    }
}
