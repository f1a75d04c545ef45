//! Plans the tests of a suite.

use std::collections::HashMap;
use std::sync::Arc;

use rtf_model::TestId;

use super::framework_tests::{self, FrameworkTest, FrameworkTests};
use super::names::UniqueNames;
use super::of_tests::OfTests;
use super::plugin_planner::PluginPlanner;
use super::plugin_search::base_name;
use super::search_scope::{Env, search_variables};
use super::use_site::PluginRole;
use super::{CombinationPlan, PluginPlan, TestLimits, TestPlan, defaults, known_failure, matrix};
use crate::suite::{
    Combination, DeclaredFault, DeclaredLimits, DeclaredMonitor, DeclaredPlugin, DeclaredTest,
    SourceText, Spanned, split_param,
};

/// The limits of tests; tests with equal limits share them.
#[derive(Default)]
pub(super) struct SharedLimits {
    known: HashMap<DeclaredLimits, Arc<TestLimits>>,
}

impl SharedLimits {
    /// Returns the limits, with the defaults for undeclared ones.
    pub fn get(&mut self, declared: DeclaredLimits) -> Arc<TestLimits> {
        // The limit of cases is in [`CasesInPrograms`](super::CasesInPrograms).
        let declared = DeclaredLimits { case: None, ..declared };
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

struct NamedPlugin<'t> {
    name: Option<Spanned<String>>,
    plugin: DeclaredPlugin,
    env: &'t Env,
}

/// Plans the tests of one suite.
pub(super) struct TestPlanner<'p, 'a, 'c> {
    planner: &'p mut PluginPlanner<'a, 'c>,
    source: &'p Arc<SourceText>,
    names: &'p mut UniqueNames,
    limits: SharedLimits,
    /// The name and the plug-in of the matrix whose combinations are being added.
    matrix: Option<(Arc<str>, Option<PluginPlan>)>,
    plans: Vec<TestPlan>,
    frameworks: FrameworkTests,
    monitors: OfTests<DeclaredMonitor>,
    faults: OfTests<DeclaredFault>,
}

pub(super) struct PlannedTests {
    pub tests: Vec<TestPlan>,
    pub frameworks: FrameworkTests,
    pub monitors: OfTests<DeclaredMonitor>,
    pub faults: OfTests<DeclaredFault>,
}

impl<'p, 'a, 'c> TestPlanner<'p, 'a, 'c> {
    pub fn new(
        planner: &'p mut PluginPlanner<'a, 'c>,
        source: &'p Arc<SourceText>,
        names: &'p mut UniqueNames,
    ) -> Self {
        Self {
            planner,
            source,
            names,
            limits: SharedLimits::default(),
            matrix: None,
            plans: Vec::new(),
            frameworks: FrameworkTests::default(),
            monitors: OfTests::default(),
            faults: OfTests::default(),
        }
    }

    /// Plans the tests; omits those without a plug-in, which are reported.
    pub fn plan(mut self, suite_tags: &[String], tests: Vec<DeclaredTest>) -> PlannedTests {
        self.plans.reserve_exact(tests.len());
        tests.into_iter().for_each(|test| self.add(suite_tags, test));
        let Self { plans: tests, frameworks, monitors, faults, .. } = self;
        PlannedTests { tests, frameworks, monitors, faults }
    }

    fn add(&mut self, suite_tags: &[String], mut test: DeclaredTest) {
        let today = self.planner.context.options.today;
        let framework = FrameworkTest::new(&test, self.source);
        let combination = test.combination.take();
        if combination.as_ref().is_none_or(|combination| combination.is_first) {
            self.check(&test, framework.as_ref());
        }
        let tags = tags(suite_tags, &test);
        let DeclaredTest { span, name, was, plugin, env, limits, settings, .. } = test;
        let known_failure = test.known_failure;
        let declared = NamedPlugin { name, plugin, env: &env };
        let (name, plugin, combination) = match combination {
            None => {
                let name = self.name(declared.name, &declared.plugin, framework.as_ref());
                (name, self.plugin(declared.plugin, &env), None)
            }
            Some(combination) => self.combination(combination, declared, framework.as_ref()),
        };
        self.monitors.add(&name, test.monitors);
        self.faults.add(&name, test.faults);
        let Some(plugin) = plugin else { return };
        let was = was.map(|was| match &combination {
            Some(combination) => matrix::combination_name(&was, &combination.parameters),
            None => was,
        });
        let was = was.map(String::into_boxed_str);
        let cases_in_programs = framework.as_ref().map(|test| Box::new(test.plan(limits)));
        if let Some(framework) = framework {
            self.frameworks.tests.insert(name.clone(), framework);
        }
        self.plans.push(TestPlan {
            id: TestId(0),
            name,
            was,
            line: self.source.line(span),
            combination: combination.map(Box::new),
            plugin,
            env,
            limits: self.limits.get(limits),
            settings,
            tags,
            learn: test.learn,
            learned: Vec::new(),
            expected: known_failure.map(|it| Box::new(known_failure::expect(&it, today))),
            slots: test.slots.map(|slots| slots.value),
            cases: None,
            cases_in_programs,
        });
    }

    /// Reports problems of attributes.
    fn check(&mut self, test: &DeclaredTest, framework: Option<&FrameworkTest>) {
        let context = &mut *self.planner.context;
        if let Some(failure) = &test.known_failure {
            let today = context.options.today;
            context.problems.extend(known_failure::warn_of_end(failure, today, self.source));
        }
        context.problems.extend(framework_tests::check_attributes(test, framework, self.source));
    }

    /// Returns the declared name, or a unique one.
    fn name(
        &mut self,
        declared: Option<Spanned<String>>,
        plugin: &DeclaredPlugin,
        framework: Option<&FrameworkTest>,
    ) -> String {
        if let Some(Spanned { value, .. }) = declared {
            return value;
        }
        let file = &plugin.name.value;
        match framework {
            Some(framework) => {
                self.names.unique(&framework.default_name(file, self.planner.scope().dir))
            }
            None => self.names.unique(base_name(file)),
        }
    }

    fn plugin(&mut self, plugin: DeclaredPlugin, env: &Env) -> Option<PluginPlan> {
        self.planner.plan(plugin, self.source, env, PluginRole::Test)
    }

    /// Returns the name and the plug-in of a combination. The combinations of a matrix share
    /// its name and plug-in.
    fn combination(
        &mut self,
        Combination { is_first, parameters }: Combination,
        NamedPlugin { name, plugin, env }: NamedPlugin<'_>,
        framework: Option<&FrameworkTest>,
    ) -> (String, Option<PluginPlan>, Option<CombinationPlan>) {
        let base: Arc<str> = match &self.matrix {
            Some((base, _)) if !is_first => Arc::clone(base),
            _ => Arc::from(self.name(name, &plugin, framework)),
        };
        let known = self.matrix.take().and_then(|(_, plugin)| plugin).filter(|_| !is_first);
        let plan = match known {
            Some(known) if search_variables(env).is_empty() => {
                Some(PluginPlan { args: split_param(&plugin.param), param: plugin.param, ..known })
            }
            None if !is_first => None,
            _ => self.plugin(plugin, env),
        };
        self.matrix = Some((Arc::clone(&base), plan.clone()));
        let name = self.names.unique(&matrix::combination_name(&base, &parameters));
        (name, plan, Some(CombinationPlan { test: base, parameters }))
    }
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
