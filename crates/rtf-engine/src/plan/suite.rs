//! One suite file, or the plug-ins of the command line → a [`SuitePlan`].

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use rtf_model::{SuiteId, TestId};

use super::context::{Context, PluginPlanner, Role, folder_of};
use super::hosts::HostKind;
use super::inputs::Found;
use super::names::Names;
use super::plugin::base_name;
use super::scope::Scope;
use super::{AfterCollapse, Leaks, SuitePlan, TestLimits, TestPlan, fixture, hook};
use crate::suite::{Source, Suite, Test, WrittenLimits};

/// The name of the suite that gathers the plug-ins of the command line.
pub(super) const PLUGINS: &str = "plug-ins";

/// The limits of a test that says nothing; `spec/suite.md` lists them.
const DEFAULTS: TestLimits = TestLimits {
    load: Duration::from_secs(30),
    setup: Duration::from_secs(60),
    run: Duration::from_secs(300),
    teardown: Duration::from_secs(30),
    slow: Duration::from_secs(60),
    grace: Duration::from_secs(2),
};

/// Shares the limits between tests that have the same.
#[derive(Default)]
struct Limits {
    known: HashMap<WrittenLimits, Arc<TestLimits>>,
}

impl Limits {
    fn of(&mut self, written: WrittenLimits) -> Arc<TestLimits> {
        let limits = self.known.entry(written).or_insert_with(|| {
            Arc::new(TestLimits {
                load: written.load.unwrap_or(DEFAULTS.load),
                setup: written.setup.unwrap_or(DEFAULTS.setup),
                run: written.run.unwrap_or(DEFAULTS.run),
                teardown: written.teardown.unwrap_or(DEFAULTS.teardown),
                slow: written.slow.unwrap_or(DEFAULTS.slow),
                grace: written.grace.unwrap_or(DEFAULTS.grace),
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
    let folder = folder_of(&found.path);
    let env = Arc::new(suite.env);
    let name = suite.name.map(|name| name.value).unwrap_or_else(|| stem(&found.path));
    let given = suite.tests.iter().map(|test| test.name.as_ref());
    let mut names = Names::given("test", given, source, &mut context.problems);
    let surroundings = &context.options.surroundings;
    let scope = Scope { surroundings, folder: &folder, suite: &env, own: &[] };
    let mut planner = PluginPlanner::new(context, scope);
    let fixtures = fixture::plan_all(&mut planner, source, suite.fixtures);
    let hooks = hook::plan_all(&mut planner, source, suite.hooks);
    let mut limits = Limits::default();
    let mut tests = Vec::with_capacity(suite.tests.len());
    for test in suite.tests {
        let name = match &test.name {
            Some(name) => name.value.clone(),
            None => names.unique(base_name(&test.plugin.name.value)),
        };
        let limits = limits.of(test.limits);
        let tags = tags(&suite.tags, &test);
        let env = &test.env;
        let Some(plugin) = planner.plan(test.plugin, source, env, Role::Test) else { continue };
        tests.push(TestPlan {
            id: TestId(0),
            name,
            plugin,
            env: test.env,
            repetitions: test.repetitions,
            limits,
            after_collapse: test.after_collapse,
            leaks: test.leaks,
            critical: test.critical,
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
        tolerates_collapse: suite.tolerates_collapse,
        fixtures,
        hooks,
        tests,
    }
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
    let folder = options.surroundings.current_folder.clone();
    let surroundings = &options.surroundings;
    let scope = Scope { surroundings, folder: &folder, suite: &[], own: &[] };
    let mut names = Names::default();
    let limits = Limits::default().of(WrittenLimits::default());
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
            repetitions: options.repetitions.max(1),
            limits: Arc::clone(&limits),
            after_collapse: AfterCollapse::default(),
            leaks: Leaks::default(),
            critical: false,
            tags: Vec::new(),
        });
    }
    SuitePlan {
        id: SuiteId(0),
        name: PLUGINS.to_owned(),
        file: String::new(),
        folder,
        description: String::new(),
        environment: options.environment.clone(),
        env: Arc::new(Vec::new()),
        timeout: None,
        tolerates_collapse: false,
        fixtures: Vec::new(),
        hooks: Vec::new(),
        tests,
    }
}
