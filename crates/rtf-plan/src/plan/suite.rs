//! Plans a suite file, or the plug-ins that are given directly.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use rtf_model::{SuiteId, TestId};

use super::context::{PlanContext, parent_dir};
use super::draft::SuiteDraft;
use super::framework_tests::{self, FrameworkTest, FrameworkTests};
use super::hosts::HostKind;
use super::inputs::InputFile;
use super::names::UniqueNames;
use super::plugin_planner::PluginPlanner;
use super::plugin_search::base_name;
use super::search_scope::{SearchScope, search_variables};
use super::use_site::PluginRole;
use super::{
    CombinationPlan, Compatibility, Isolation, OwnMiddleware, PluginPlan, Preparation, SuitePlan,
    SuiteSettings, TestLimits, TestPlan, TestSettings, clock, defaults, fixture, hook,
    known_failure, matrix, middleware,
};
use crate::config;
use crate::suite::{
    Combination, DeclaredLimits, DeclaredMiddleware, DeclaredPlugin, DeclaredSuite, DeclaredTest,
    FixtureKind, SourceText, split_param,
};

/// The name of the suite of the plug-ins that are given directly.
const DIRECT_PLUGINS: &str = "plug-ins";

/// The limits of tests; tests with equal limits share them.
#[derive(Default)]
struct SharedLimits {
    known: HashMap<DeclaredLimits, Arc<TestLimits>>,
}

impl SharedLimits {
    fn get(&mut self, declared: DeclaredLimits) -> Arc<TestLimits> {
        let limits = self.known.entry(declared).or_insert_with(|| {
            Arc::new(TestLimits {
                load: declared.load.unwrap_or(defaults::TEST.load),
                setup: declared.setup.unwrap_or(defaults::TEST.setup),
                run: declared.run.unwrap_or(defaults::TEST.run),
                teardown: declared.teardown.unwrap_or(defaults::TEST.teardown),
                slow: declared.slow.unwrap_or(defaults::TEST.slow),
                grace: declared.grace.unwrap_or(defaults::TEST.grace),
            })
        });
        Arc::clone(limits)
    }
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
    let isolate = isolation(&suite);
    let env = Arc::new(suite.env);
    let name = suite.name.map(|name| name.value).unwrap_or_else(|| stem(&file.path));
    let named = suite.tests.iter().filter(|test| is_first_of_matrix(test));
    let declared = named.map(|test| test.name.as_ref());
    let mut names = UniqueNames::reserve("test", declared, source, &mut context.problems);
    let fallback_dir = fallback_dir.as_deref();
    let scope = SearchScope { runner, dir: &dir, fallback_dir, suite_env: &env, own_env: &[] };
    let mut planner = PluginPlanner::new(context, scope);
    let mut fixtures =
        fixture::plan_all(&mut planner, source, (suite.fixtures, &suite.fixture_references.found));
    let clock = clock::plan(&mut planner, source, suite.clock, &mut fixtures);
    let hooks = hook::plan_all(&mut planner, source, suite.hooks);
    let (tests, frameworks) =
        plan_tests(&mut planner, source, &mut names, (&suite.tags, suite.tests));
    planner.report_missing();
    let plan = SuitePlan {
        id: SuiteId(0),
        name,
        file: file.name.clone(),
        folder: dir,
        env,
        isolate,
        preparation: Preparation::NotNeeded,
        settings: suite.settings,
        refers_to_values: suite.fixture_references.any,
        clock,
        fixtures,
        hooks,
        tests,
    };
    SuiteDraft { plan, frameworks }
}

/// Plans the tests of a suite; omits those without a plug-in, which are reported.
fn plan_tests(
    planner: &mut PluginPlanner<'_, '_>,
    source: &Arc<SourceText>,
    names: &mut UniqueNames,
    (suite_tags, tests): (&[String], Vec<DeclaredTest>),
) -> (Vec<TestPlan>, FrameworkTests) {
    let (mut limits, mut plans) = (SharedLimits::default(), Vec::with_capacity(tests.len()));
    let mut frameworks = FrameworkTests::default();
    let today = planner.context.options.today;
    // The combinations of a matrix share its name and plug-in.
    let mut matrix: Option<(Arc<str>, Option<PluginPlan>)> = None;
    for mut test in tests {
        let combination = test.combination.take();
        let is_first = combination.as_ref().is_none_or(|it| it.is_first);
        if is_first && let Some(failure) = &test.known_failure {
            let warning = known_failure::warn_of_end(failure, today, source);
            planner.context.problems.extend(warning);
        }
        let tags = tags(suite_tags, &test);
        let framework = FrameworkTest::new(&test, source);
        if is_first {
            let problems = framework_tests::check_attributes(&test, framework.as_ref(), source);
            planner.context.problems.extend(problems);
        }
        let dir = planner.scope().dir;
        let DeclaredTest { name, plugin, env, limits: declared, settings, known_failure, .. } =
            test;
        let named = |plugin: &DeclaredPlugin| {
            let unique = || match &framework {
                Some(test) => names.unique(&test.default_name(&plugin.name.value, dir)),
                None => names.unique(base_name(&plugin.name.value)),
            };
            name.map(|name| name.value).unwrap_or_else(unique)
        };
        let (name, plugin, base, parameters) = match combination {
            None => {
                let name = named(&plugin);
                (name, planner.plan(plugin, source, &env, PluginRole::Test), None, Vec::new())
            }
            Some(Combination { is_first, parameters }) => {
                let base = match &matrix {
                    Some((base, _)) if !is_first => Arc::clone(base),
                    _ => Arc::from(named(&plugin)),
                };
                let known = matrix.take().and_then(|(_, plugin)| plugin).filter(|_| !is_first);
                let plan = match known {
                    Some(known) if search_variables(&env).is_empty() => Some(PluginPlan {
                        args: split_param(&plugin.param),
                        param: plugin.param,
                        ..known
                    }),
                    None if !is_first => None,
                    _ => planner.plan(plugin, source, &env, PluginRole::Test),
                };
                matrix = Some((Arc::clone(&base), plan.clone()));
                let name = names.unique(&matrix::combination_name(&base, &parameters));
                (name, plan, Some(base), parameters)
            }
        };
        let Some(plugin) = plugin else { continue };
        let cases_in_programs = framework.as_ref().map(|test| Box::new(test.plan(declared)));
        if let Some(test) = framework {
            frameworks.tests.insert(name.clone(), test);
        }
        plans.push(TestPlan {
            id: TestId(0),
            name,
            combination: base.map(|test| Box::new(CombinationPlan { test, parameters })),
            plugin,
            env,
            limits: limits.get(declared),
            settings,
            tags,
            expected: known_failure.map(|it| Box::new(known_failure::expect(&it, today))),
            cases: None,
            cases_in_programs,
        });
    }
    (plans, frameworks)
}

fn is_first_of_matrix(test: &DeclaredTest) -> bool {
    test.combination.as_ref().is_none_or(|combination| combination.is_first)
}

/// Determines the private resources of a suite, as specified in `spec/suite.md`.
fn isolation(suite: &DeclaredSuite) -> Isolation {
    let network = suite.isolate.network;
    // A fixture outside of the suite cannot know the ids of private middleware. A
    // user's plug-in may start middleware or use an existing one: as in 2.x, its
    // suite shares middleware.
    let (mut starts, mut is_outside) = (false, false);
    for fixture in &suite.fixtures {
        match &fixture.body {
            FixtureKind::Attached(_) => is_outside = true,
            FixtureKind::Process(process) if process.host.is_some() => is_outside = true,
            FixtureKind::Process(_) => starts = true,
            FixtureKind::Plugin(plugin) => starts |= middleware::starts_middleware(plugin),
        }
    }
    let middleware = match suite.isolate.middleware {
        Some(DeclaredMiddleware::Own) => OwnMiddleware::Always,
        Some(DeclaredMiddleware::Shared) => OwnMiddleware::No,
        // A private network cannot reach shared middleware.
        None if network => OwnMiddleware::Always,
        None if starts && !is_outside => OwnMiddleware::UnlessSet,
        None => OwnMiddleware::No,
    };
    Isolation { network, middleware, ports: suite.isolate.ports.clone() }
}

/// Returns the tags of the suite, then those of the test.
fn tags(suite: &[String], test: &DeclaredTest) -> Vec<String> {
    let mut tags: Vec<String> = Vec::with_capacity(suite.len() + test.tags.len());
    for tag in suite.iter().chain(&test.tags) {
        if !tags.contains(tag) {
            tags.push(tag.clone());
        }
    }
    tags
}

fn stem(path: &Path) -> String {
    path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}

/// A plug-in that is given directly: by name, or as a file of a directory.
#[derive(Debug)]
pub(super) struct DirectPlugin {
    /// The file.
    pub file: InputFile,
    /// The type.
    pub kind: &'static HostKind,
    /// Whether it is a file of an input directory. If it contains no test, it is omitted.
    pub from_dir: bool,
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
            id: TestId(0),
            name: names.unique(base_name(&direct.file.name)),
            plugin,
            env: Vec::new(),
            limits: Arc::clone(&limits),
            settings: TestSettings { repetitions, ..TestSettings::default() },
            tags: Vec::new(),
            combination: None,
            expected: None,
            cases: None,
            cases_in_programs: None,
        });
    }
    SuitePlan {
        id: SuiteId(0),
        name: DIRECT_PLUGINS.to_owned(),
        file: String::new(),
        folder: dir,
        env: Arc::new(env),
        isolate: Isolation::default(),
        preparation: Preparation::NotNeeded,
        settings: SuiteSettings { environment, ..SuiteSettings::default() },
        refers_to_values: false,
        clock: None,
        fixtures: Vec::new(),
        hooks: Vec::new(),
        tests,
    }
}
