//! The plan of the merged run: suites of the same name and file are one suite,
//! with the fixtures, hooks and tests that they have in any of the runs.

use std::collections::HashMap;

use rtf_model::{
    EventKind, FixtureId, FixturePlanned, HookId, HookPlanned, SuiteId, SuitePlanned, TestId,
    TestPlanned,
};

use super::{MergeInput, MergeProblem, count};

/// The plan, by the new ids.
#[derive(Debug, Default)]
pub(super) struct MergedPlan {
    pub suites: Vec<SuitePlanned>,
    pub fixtures: Vec<FixturePlanned>,
    pub hooks: Vec<HookPlanned>,
    pub tests: Vec<TestPlanned>,
    /// From old ids to new ones, for each run.
    pub maps: Vec<Map>,
}

/// The new ids of one run's suites, fixtures, hooks and tests, by the old ones.
#[derive(Debug, Default)]
pub(super) struct Map {
    pub suites: Vec<SuiteId>,
    pub fixtures: Vec<FixtureId>,
    pub hooks: Vec<HookId>,
    pub tests: Vec<TestId>,
}

/// In which order ids were given, and which they get when all are known: those
/// of a suite follow each other.
struct Renumbered(Vec<u32>);

impl Renumbered {
    fn sort<T>(list: &mut Vec<T>, suite: impl Fn(&T) -> SuiteId) -> Self {
        let mut sorted: Vec<_> = std::mem::take(list).into_iter().enumerate().collect();
        sorted.sort_by_key(|(_, entry)| suite(entry));
        let mut new = vec![0; sorted.len()];
        for (place, (old, entry)) in sorted.into_iter().enumerate() {
            new[old] = count(place);
            list.push(entry);
        }
        Self(new)
    }

    fn of(&self, old: usize) -> u32 {
        self.0[old]
    }
}

impl MergedPlan {
    /// Joins plans; returns a problem for each test that more than one run has.
    pub fn join(parts: &[MergeInput]) -> (Self, Vec<MergeProblem>) {
        let mut joining = Joining::default();
        for (number, part) in parts.iter().enumerate() {
            joining.plan.maps.push(Map::default());
            for event in &part.events {
                match &event.kind {
                    EventKind::SuitePlanned(plan) => joining.suite(plan),
                    EventKind::FixturePlanned(plan) => joining.fixture(plan),
                    EventKind::HookPlanned(plan) => joining.hook(plan),
                    EventKind::TestPlanned(plan) => joining.test(plan, number, parts),
                    EventKind::SuiteStarted { .. } => break,
                    _ => {}
                }
            }
        }
        (joining.plan.numbered(), joining.problems)
    }

    fn numbered(mut self) -> Self {
        let fixtures = Renumbered::sort(&mut self.fixtures, |fixture| fixture.suite);
        let hooks = Renumbered::sort(&mut self.hooks, |hook| hook.suite);
        let tests = Renumbered::sort(&mut self.tests, |test| test.suite);
        for map in &mut self.maps {
            map.fixtures.iter_mut().for_each(|id| id.0 = fixtures.of(id.index()));
            map.hooks.iter_mut().for_each(|id| id.0 = hooks.of(id.index()));
            map.tests.iter_mut().for_each(|id| id.0 = tests.of(id.index()));
        }
        (0..).zip(&mut self.fixtures).for_each(|(id, plan)| plan.fixture = FixtureId(id));
        (0..).zip(&mut self.hooks).for_each(|(id, plan)| plan.hook = HookId(id));
        (0..).zip(&mut self.tests).for_each(|(id, plan)| plan.test = TestId(id));
        self
    }

    /// The events that tell it.
    pub fn events(&self) -> impl Iterator<Item = EventKind> {
        self.suites.iter().flat_map(|suite| {
            let id = suite.suite;
            let fixtures = self.fixtures.iter().filter(move |fixture| fixture.suite == id);
            let hooks = self.hooks.iter().filter(move |hook| hook.suite == id);
            let tests = self.tests.iter().filter(move |test| test.suite == id);
            std::iter::once(EventKind::SuitePlanned(suite.clone()))
                .chain(fixtures.cloned().map(EventKind::FixturePlanned))
                .chain(hooks.cloned().map(EventKind::HookPlanned))
                .chain(tests.cloned().map(EventKind::TestPlanned))
        })
    }
}

/// A plan that grows; its ids are not the last ones.
#[derive(Default)]
struct Joining {
    plan: MergedPlan,
    /// The suites by their names and files.
    suites: HashMap<(String, String), SuiteId>,
    fixtures: HashMap<(SuiteId, String), FixtureId>,
    hooks: HashMap<(SuiteId, String), HookId>,
    /// With the run that has it.
    tests: HashMap<(SuiteId, String), usize>,
    problems: Vec<MergeProblem>,
}

impl Joining {
    fn map(&mut self) -> &mut Map {
        let last = self.plan.maps.len() - 1;
        &mut self.plan.maps[last]
    }

    /// The new id of the suite that was planned last.
    fn last_suite(&mut self) -> SuiteId {
        self.map().suites.last().copied().unwrap_or(SuiteId(0))
    }

    fn suite(&mut self, plan: &SuitePlanned) {
        let key = (plan.name.clone(), plan.file.clone());
        let id = if let Some(id) = self.suites.get(&key).copied() {
            // What a run did not tolerate, no merge makes tolerable.
            let merged = &mut self.plan.suites[id.index()];
            merged.tolerates_collapse &= plan.tolerates_collapse;
            merged.skips_fail |= plan.skips_fail;
            merged.parallel = merged.parallel.max(plan.parallel);
            id
        } else {
            let id = SuiteId(count(self.plan.suites.len()));
            let name = self.free_name(&plan.name);
            self.plan.suites.push(SuitePlanned { suite: id, name, ..plan.clone() });
            self.suites.insert(key, id);
            id
        };
        self.map().suites.push(id);
    }

    /// The name, or one that is like it and that no other suite has.
    fn free_name(&self, name: &str) -> String {
        let numbered = (2..).map(|number| format!("{name}#{number}"));
        let mut names = std::iter::once(name.to_owned()).chain(numbered);
        let free = |name: &String| !self.plan.suites.iter().any(|suite| suite.name == *name);
        names.find(free).unwrap_or_default()
    }

    fn fixture(&mut self, plan: &FixturePlanned) {
        let suite = self.last_suite();
        let next = FixtureId(count(self.plan.fixtures.len()));
        let id = *self.fixtures.entry((suite, plan.name.clone())).or_insert(next);
        if id == next {
            self.plan.fixtures.push(FixturePlanned { suite, ..plan.clone() });
        }
        self.map().fixtures.push(id);
    }

    fn hook(&mut self, plan: &HookPlanned) {
        let suite = self.last_suite();
        let next = HookId(count(self.plan.hooks.len()));
        let id = *self.hooks.entry((suite, plan.name.clone())).or_insert(next);
        if id == next {
            self.plan.hooks.push(HookPlanned { suite, ..plan.clone() });
        }
        let on = &mut self.plan.hooks[id.index()].on;
        on.extend(
            plan.on.iter().copied().filter(|trigger| !on.contains(trigger)).collect::<Vec<_>>(),
        );
        self.map().hooks.push(id);
    }

    fn test(&mut self, plan: &TestPlanned, part: usize, parts: &[MergeInput]) {
        let suite = self.last_suite();
        let first = *self.tests.entry((suite, plan.name.clone())).or_insert(part);
        if first != part {
            let suite = &self.plan.suites[suite.index()].name;
            self.problems.push(MergeProblem::Twice {
                test: format!("{suite}/{}", plan.name),
                first: parts[first].name.clone(),
                second: parts[part].name.clone(),
            });
        }
        let id = TestId(count(self.plan.tests.len()));
        self.plan.tests.push(TestPlanned { suite, ..plan.clone() });
        self.map().tests.push(id);
    }
}
