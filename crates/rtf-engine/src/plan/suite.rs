//! One suite file, or the plug-ins of the command line → a [`SuitePlan`].

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use rtf_model::{SuiteId, TestId};

use super::context::{Context, PluginPlanner, Role, folder_of};
use super::hosts::HostKind;
use super::inputs::Found;
use super::names::Names;
use super::plugin::base_name;
use super::scope::Scope;
use super::{
    AfterCollapse, Given, Isolation, Leaks, Manner, OwnMiddleware, Retries, SuitePlan, TestLimits,
    TestPlan, clock, defaults, fixture, hook, middleware,
};
use crate::config;
use crate::suite::{FixtureKind, Middleware, Source, Suite, Test, WrittenLimits};

/// The name of the suite that gathers the plug-ins of the command line.
pub(super) const PLUGINS: &str = "plug-ins";

/// Shares the limits between tests that have the same.
#[derive(Default)]
struct Limits {
    known: HashMap<WrittenLimits, Arc<TestLimits>>,
}

impl Limits {
    fn of(&mut self, written: WrittenLimits) -> Arc<TestLimits> {
        let limits = self.known.entry(written).or_insert_with(|| {
            Arc::new(TestLimits {
                load: written.load.unwrap_or(defaults::TEST.load),
                setup: written.setup.unwrap_or(defaults::TEST.setup),
                run: written.run.unwrap_or(defaults::TEST.run),
                teardown: written.teardown.unwrap_or(defaults::TEST.teardown),
                slow: written.slow.unwrap_or(defaults::TEST.slow),
                grace: written.grace.unwrap_or(defaults::TEST.grace),
            })
        });
        Arc::clone(limits)
    }
}

/// Plans what a file says. Ids are given at the end, when all suites are known.
pub(super) fn plan(
    context: &mut Context<'_>,
    found: &Found,
    source: &Arc<Source>,
    suite: Suite,
) -> SuitePlan {
    let own_folder = folder_of(&found.path);
    let surroundings = &context.options.surroundings;
    let (folder, beside) = match context.options.manner {
        Manner::Own => (own_folder, None),
        Manner::Predecessor => (surroundings.current_folder.clone(), Some(own_folder)),
    };
    let isolate = isolation(&suite);
    let env = Arc::new(suite.env);
    let name = suite.name.map(|name| name.value).unwrap_or_else(|| stem(&found.path));
    let given = suite.tests.iter().map(|test| test.name.as_ref());
    let mut names = Names::given("test", given, source, &mut context.problems);
    let beside = beside.as_deref();
    let scope = Scope { surroundings, folder: &folder, beside, suite: &env, own: &[] };
    let mut planner = PluginPlanner::new(context, scope);
    let mut fixtures = fixture::plan_all(&mut planner, source, suite.fixtures);
    let clock = clock::plan(&mut planner, source, suite.clock, &mut fixtures);
    let hooks = hook::plan_all(&mut planner, source, suite.hooks);
    let (mut limits, mut tests) = (Limits::default(), Vec::with_capacity(suite.tests.len()));
    for test in suite.tests {
        let given = test.name.as_ref().map(|name| name.value.clone());
        let name = given.unwrap_or_else(|| names.unique(base_name(&test.plugin.name.value)));
        let (tags, env) = (tags(&suite.tags, &test), &test.env);
        let Some(plugin) = planner.plan(test.plugin, source, env, Role::Test) else { continue };
        tests.push(TestPlan {
            id: TestId(0),
            name,
            plugin,
            env: test.env,
            repetitions: test.repetitions,
            limits: limits.of(test.limits),
            after_collapse: test.after_collapse,
            leaks: test.leaks,
            retries: test.retries,
            critical: test.critical,
            exclusive: test.exclusive,
            shared: test.shared,
            tags,
        });
    }
    planner.report_missing();
    SuitePlan {
        id: SuiteId(0),
        name,
        file: found.name.clone(),
        folder,
        description: suite.description,
        environment: suite.environment,
        env,
        timeout: suite.timeout,
        isolate,
        given: Given::Nothing,
        requires: suite.requires,
        tolerates_collapse: suite.tolerates_collapse,
        critical_stops_run: suite.critical_stops_run,
        parallel: suite.parallel,
        clock,
        fixtures,
        hooks,
        tests,
    }
}

/// What the suite is to get for itself; `spec/suite.md` says when.
fn isolation(suite: &Suite) -> Isolation {
    let network = suite.isolate.network;
    // What runs already has its ids, and ours are unique on this machine only.
    // Whether a user's plug-in starts middleware or uses what runs cannot be told; a
    // suite that the predecessor runs finds what it finds there.
    let (mut starts, mut elsewhere) = (false, false);
    for fixture in &suite.fixtures {
        match &fixture.body {
            FixtureKind::Attached(_) => elsewhere = true,
            FixtureKind::Process(process) if process.host.is_some() => elsewhere = true,
            FixtureKind::Process(_) => starts = true,
            FixtureKind::Plugin(plugin) => starts |= middleware::starts(plugin),
        }
    }
    let middleware = match suite.isolate.middleware {
        Some(Middleware::Own) => OwnMiddleware::Always,
        Some(Middleware::Shared) => OwnMiddleware::No,
        // What the user's environment names cannot be reached from there.
        None if network => OwnMiddleware::Always,
        None if starts && !elsewhere => OwnMiddleware::UnlessSet,
        None => OwnMiddleware::No,
    };
    Isolation { network, middleware, ports: suite.isolate.ports.clone() }
}

/// The suite's tags, then the test's own ones.
fn tags(suite: &[String], test: &Test) -> Vec<String> {
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

/// A plug-in of the command line.
pub(super) struct Single {
    /// Its file.
    pub found: Found,
    /// Its type.
    pub kind: &'static HostKind,
    /// Whether it lies in a folder that was given.
    pub from_folder: bool,
}

/// Gathers the plug-ins of the command line into one suite.
pub(super) fn plan_singles(context: &mut Context<'_>, singles: &[Single]) -> SuitePlan {
    let options = context.options;
    let named = singles.iter().any(|single| options.are_for(single.from_folder));
    let folder = options.surroundings.current_folder.clone();
    let surroundings = &options.surroundings;
    let given = if named { options.environment.as_str() } else { "" };
    let config::Singles { environment, env, limits } = context.config_of_singles(&folder, given);
    let scope = Scope { surroundings, folder: &folder, beside: None, suite: &env, own: &[] };
    let mut names = Names::default();
    let limits = Limits::default().of(limits);
    let mut planner = PluginPlanner::new(context, scope);
    let mut tests = Vec::with_capacity(singles.len());
    for single in singles {
        let Some(plugin) = planner.plan_file(&single.found.path, single.kind, single.from_folder)
        else {
            continue;
        };
        tests.push(TestPlan {
            id: TestId(0),
            name: names.unique(base_name(&single.found.name)),
            plugin,
            env: Vec::new(),
            repetitions: if named { options.repetitions.max(1) } else { 1 },
            limits: Arc::clone(&limits),
            after_collapse: AfterCollapse::default(),
            leaks: Leaks::default(),
            retries: Retries::default(),
            critical: false,
            exclusive: false,
            shared: false,
            tags: Vec::new(),
        });
    }
    SuitePlan {
        id: SuiteId(0),
        name: PLUGINS.to_owned(),
        file: String::new(),
        folder,
        description: String::new(),
        environment,
        env: Arc::new(env),
        timeout: None,
        isolate: Isolation::default(),
        given: Given::Nothing,
        requires: Vec::new(),
        tolerates_collapse: false,
        critical_stops_run: false,
        parallel: 1,
        clock: None,
        fixtures: Vec::new(),
        hooks: Vec::new(),
        tests,
    }
}
