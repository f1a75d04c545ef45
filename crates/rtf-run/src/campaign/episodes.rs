//! Adds the episodes of a campaign to the plan of its suite.

use std::sync::Arc;

use rtf_model::{Episode, Parameter};
use rtf_plan::plan::{Plan, SuitePlan};
use rtf_plan::suite::episode_reference;

use crate::error::Failure;
use crate::request::TestsRequest;

/// Begins the names of the variables with parameters.
const PARAMETER_PREFIX: &str = "RTF_PARAM_";

/// Adds the episodes, or one to a suite whose test with slots runs without a campaign.
pub fn add(plan: &mut Plan, request: &TestsRequest) -> Result<(), Failure> {
    let is_campaign = !request.episodes.is_empty();
    let mut has_slots = false;
    for suite in &mut plan.suites {
        let is_batch = suite.tests.iter().any(|test| test.slots.is_some());
        has_slots |= is_batch;
        if is_campaign {
            suite.episodes = request.episodes.iter().cloned().collect();
            suite.awaits_episodes = request.episode_stream.is_some();
            suite.refers_to_values = true;
        } else if is_batch {
            suite.episodes = [Episode::new(1, 0, parameters(request))].into_iter().collect();
        }
        if is_batch {
            prepare(suite, request)?;
        }
    }
    match request.slots {
        Some(_) if !has_slots => {
            let hint = "give the test of the suite `slots` if it can run many episodes";
            Err(Failure::input("`--slots` needs a test with `slots`").hint(hint))
        }
        _ => Ok(()),
    }
}

/// The parameters of the command line.
fn parameters(request: &TestsRequest) -> Vec<Parameter> {
    let all = request.options.config_request.params.iter();
    all.map(|(name, value)| Parameter { name: name.clone(), value: value.clone() }).collect()
}

/// Prepares a suite whose test runs many episodes.
fn prepare(suite: &mut SuitePlan, request: &TestsRequest) -> Result<(), Failure> {
    for slots in suite.tests.iter_mut().filter_map(|test| test.slots.as_mut()) {
        slots.slots = request.slots.unwrap_or(slots.slots);
    }
    // Its process outlives the episodes.
    let is_variable = |name: &str| name.starts_with(PARAMETER_PREFIX);
    Arc::make_mut(&mut suite.env)
        .retain(|(name, value)| !(is_variable(name) && episode_reference::mentions(value)));
    if rtf_engine::refers_to_episode(suite) {
        let error = format!(
            "suite `{}` has a test with `slots`, and a parameter of the campaign in a text",
            suite.name
        );
        let hint = "the parameters of an episode arrive with it: read them in the test";
        return Err(Failure::input(error).hint(hint));
    }
    Ok(())
}
