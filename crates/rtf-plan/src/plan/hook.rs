//! Plans the hooks of a suite.

use std::sync::Arc;

use rtf_model::HookId;

use super::names::UniqueNames;
use super::plugin_planner::PluginPlanner;
use super::plugin_search::base_name;
use super::use_site::PluginRole;
use super::{HookBody, HookPlan, defaults, program};
use crate::suite::{DeclaredHook, HookKind, SourceText};

/// Plans all hooks of a suite, in the order of the file.
pub(super) fn plan_all(
    planner: &mut PluginPlanner<'_, '_>,
    source: &Arc<SourceText>,
    hooks: Vec<DeclaredHook>,
) -> Vec<HookPlan> {
    let declared = hooks.iter().map(|hook| hook.name.as_ref());
    let mut names = UniqueNames::reserve("hook", declared, source, &mut planner.context.problems);
    let mut plans = Vec::with_capacity(hooks.len());
    for hook in hooks {
        let name = match &hook.name {
            Some(name) => name.value.clone(),
            None => names.unique(default_name(&hook)),
        };
        plans.extend(plan(planner, source, hook, name));
    }
    plans
}

/// Returns the name of a hook without `name`.
fn default_name(hook: &DeclaredHook) -> &str {
    match &hook.body {
        HookKind::Plugin(plugin) => base_name(&plugin.name.value),
        HookKind::Command(command) => program::base_name(&command.value),
    }
}

fn plan(
    planner: &mut PluginPlanner<'_, '_>,
    source: &Arc<SourceText>,
    hook: DeclaredHook,
    name: String,
) -> Option<HookPlan> {
    let body = plan_body(planner, source, hook.body, &hook.env)?;
    let timeout = hook.timeout.unwrap_or(defaults::HOOK);
    Some(HookPlan { id: HookId(0), name, on: hook.on, body, env: hook.env, timeout })
}

/// Plans the body of a hook or a reset, with these variables in addition to the suite's.
pub(super) fn plan_body(
    planner: &mut PluginPlanner<'_, '_>,
    source: &Arc<SourceText>,
    body: HookKind,
    env: &[(String, String)],
) -> Option<HookBody> {
    Some(match body {
        HookKind::Plugin(plugin) => {
            HookBody::Plugin(planner.plan(plugin, source, env, PluginRole::Hook)?)
        }
        HookKind::Command(command) => {
            let suite_scope = planner.scope();
            let scope = suite_scope.with(env);
            let problems = &mut planner.context.problems;
            HookBody::Command(program::command(command, &scope, source, problems))
        }
    })
}
