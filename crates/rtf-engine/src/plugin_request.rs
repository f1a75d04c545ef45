//! The request to run a plug-in.

use rtf_model::protocol::Plugin;
use rtf_plan::plan::{PluginPlan, SuitePlan};

/// Returns the parameters for one run of a plug-in; not the last one of its host.
pub fn plugin(suite: &SuitePlan, name: &str, plan: &PluginPlan, repetition: u32) -> Plugin {
    Plugin {
        file: plan.file.to_string_lossy().into_owned(),
        name: name.to_owned(),
        param: plan.param.clone(),
        args: plan.args.clone(),
        environment: suite.settings.environment.clone(),
        repetition,
        ..Plugin::default()
    }
}
