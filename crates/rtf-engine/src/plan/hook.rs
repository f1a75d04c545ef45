//! The hooks of a suite → [`HookPlan`]s.

use std::sync::Arc;

use rtf_model::HookId;

use super::context::{PluginPlanner, Role};
use super::names::Names;
use super::plugin::base_name;
use super::{HookBody, HookPlan, defaults, program};
use crate::suite::{Hook, HookKind, Source};

/// Plans all hooks of a suite, in the order of the file.
pub(super) fn plan_all(
    planner: &mut PluginPlanner<'_, '_>,
    source: &Arc<Source>,
    hooks: Vec<Hook>,
) -> Vec<HookPlan> {
    let given = hooks.iter().map(|hook| hook.name.as_ref());
    let mut made_up = Names::given("hook", given, source, &mut planner.context.problems);
    let mut plans = Vec::with_capacity(hooks.len());
    for hook in hooks {
        let name = match &hook.name {
            Some(name) => name.value.clone(),
            None => made_up.unique(base_of(&hook)),
        };
        plans.extend(plan(planner, source, hook, name));
    }
    plans
}

/// The name of a hook that has none of its own.
fn base_of(hook: &Hook) -> &str {
    match &hook.body {
        HookKind::Plugin(plugin) => base_name(&plugin.name.value),
        HookKind::Command(command) => program::base_name(&command.value),
    }
}

fn plan(
    planner: &mut PluginPlanner<'_, '_>,
    source: &Arc<Source>,
    hook: Hook,
    name: String,
) -> Option<HookPlan> {
    let body = match hook.body {
        HookKind::Plugin(plugin) => {
            HookBody::Plugin(planner.plan(plugin, source, &hook.env, Role::Hook)?)
        }
        HookKind::Command(command) => {
            let suite_scope = planner.scope();
            let scope = suite_scope.with(&hook.env);
            let problems = &mut planner.context.problems;
            HookBody::Command(program::command(command, &scope, source, problems))
        }
    };
    let timeout = hook.timeout.unwrap_or(defaults::HOOK);
    Some(HookPlan { id: HookId(0), name, on: hook.on, body, env: hook.env, timeout })
}
