//! Plans a suite file, or the plug-ins that are given directly.

use std::path::Path;
use std::sync::Arc;

use rtf_model::TestId;

use super::context::{PlanContext, parent_dir};
use super::faults::DeclaredFaults;
use super::framework_tests::FrameworkTests;
use super::input_file::{DirectPlugin, InputFile};
use super::names::UniqueNames;
use super::plugin_planner::PluginPlanner;
use super::plugin_search::base_name;
use super::search_scope::SearchScope;
use super::signals::DeclaredSignals;
use super::test_planner::{PlannedTests, SharedLimits, TestPlanner};
use super::{
    Compatibility, SuitePlan, SuiteSettings, TestPlan, TestSettings, clock, faults, fixture, hook,
    isolation, signals,
};
use crate::config;
use crate::suite::{DeclaredSuite, DeclaredTest, SourceText};

/// The name of the suite of the plug-ins that are given directly.
const DIRECT_PLUGINS: &str = "plug-ins";

/// A suite whose plug-ins have not been checked yet.
#[derive(Debug)]
pub(super) struct SuiteDraft {
    pub plan: SuitePlan,
    pub frameworks: FrameworkTests,
}

/// Plans a suite file. [`Plan::new`](super::Plan::new) assigns the ids.
pub(super) fn plan_suite(
    context: &mut PlanContext<'_>,
    file: &InputFile,
    source: &Arc<SourceText>,
    suite: DeclaredSuite,
) -> SuiteDraft {
    let suite_dir = parent_dir(&file.path);
    let runner = &context.options.runner;
    let (dir, fallback_dir) = match context.options.compatibility {
        Compatibility::Native => (suite_dir, None),
        Compatibility::Predecessor => (runner.current_dir.clone(), Some(suite_dir)),
    };
    let isolate = isolation::plan(&suite);
    let env = Arc::new(suite.env);
    let name = suite.name.map(|name| name.value).unwrap_or_else(|| stem(&file.path));
    let named = suite.tests.iter().filter(|test| is_first_of_matrix(test));
    let declared = named.map(|test| test.name.as_ref());
    let mut names = UniqueNames::reserve("test", declared, source, &mut context.problems);
    let fixture_names = suite.fixtures.iter().filter_map(|fixture| fixture.name.as_ref());
    let fixture_names: Vec<String> = fixture_names.map(|name| name.value.clone()).collect();
    let fallback_dir = fallback_dir.as_deref();
    let scope = SearchScope { runner, dir: &dir, fallback_dir, suite_env: &env, own_env: &[] };
    let mut planner = PluginPlanner::new(context, scope);
    let mut fixtures =
        fixture::plan_all(&mut planner, source, (suite.fixtures, &suite.fixture_references.found));
    let clock = clock::plan(&mut planner, source, suite.clock, &mut fixtures);
    let hooks = hook::plan_all(&mut planner, source, suite.hooks);
    let tests = TestPlanner::new(&mut planner, source, &mut names);
    let PlannedTests { tests, frameworks, monitors, faults: of_tests } =
        tests.plan(&suite.tags, suite.tests);
    let declared = DeclaredFaults {
        of_suite: suite.faults,
        of_tests,
        fixtures: fixture_names.clone(),
        has_clock: clock.is_some(),
        has_network: isolate.network,
    };
    faults::plan(&mut planner, source, &declared, &mut fixtures);
    let declared = DeclaredSignals {
        sources: suite.signals,
        monitors: suite.monitors,
        envelopes: suite.envelopes,
        of_tests: monitors,
        fixtures: fixture_names,
        has_clock: clock.is_some(),
    };
    signals::plan(&mut planner, source, declared, &mut fixtures);
    planner.report_missing();
    let plan = SuitePlan {
        name,
        file: file.name.clone(),
        folder: dir,
        env,
        isolate,
        settings: suite.settings,
        refers_to_values: suite.fixture_references.any,
        clock,
        fixtures,
        hooks,
        tests,
        ..SuitePlan::default()
    };
    SuiteDraft { plan, frameworks }
}

fn is_first_of_matrix(test: &DeclaredTest) -> bool {
    test.combination.as_ref().is_none_or(|combination| combination.is_first)
}

fn stem(path: &Path) -> String {
    path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Plans one suite of all plug-ins that are given directly.
pub(super) fn plan_direct_plugins(
    context: &mut PlanContext<'_>,
    plugins: &[DirectPlugin],
) -> SuitePlan {
    let options = context.options;
    let use_options = plugins.iter().any(|plugin| options.apply_to_plugin(plugin.from_dir));
    let dir = options.runner.current_dir.clone();
    let runner = &options.runner;
    let environment = if use_options { options.environment.as_str() } else { "" };
    let repetitions = if use_options { options.repetitions.max(1) } else { 1 };
    let config::DirectPluginConfig { environment, env, limits } =
        context.direct_plugin_config(&dir, environment);
    let scope = SearchScope { suite_env: &env, ..SearchScope::of_runner(runner) };
    let mut names = UniqueNames::default();
    let limits = SharedLimits::default().get(limits);
    let mut planner = PluginPlanner::new(context, scope);
    let mut tests = Vec::with_capacity(plugins.len());
    for direct in plugins {
        let Some(plugin) = planner.plan_file(direct) else { continue };
        tests.push(TestPlan {
            learn: Vec::new(),
            learned: Vec::new(),
            id: TestId(0),
            name: names.unique(base_name(&direct.file.name)),
            line: 0,
            plugin,
            env: Vec::new(),
            limits: Arc::clone(&limits),
            settings: TestSettings { repetitions, ..TestSettings::default() },
            tags: Vec::new(),
            combination: None,
            expected: None,
            slots: None,
            cases: None,
            cases_in_programs: None,
            was: None,
        });
    }
    SuitePlan {
        name: DIRECT_PLUGINS.to_owned(),
        folder: dir,
        env: Arc::new(env),
        settings: SuiteSettings { environment, ..SuiteSettings::default() },
        tests,
        ..SuitePlan::default()
    }
}
