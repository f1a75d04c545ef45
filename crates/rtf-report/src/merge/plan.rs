//! The plan of the merged run: suites of the same name and file are one suite,
//! with the fixtures, hooks and tests that they have in any of the runs.

use std::collections::HashMap;

use rtf_model::{
    EventKind, FixtureId, FixturePlanned, HookId, HookPlanned, SuiteId, SuitePlanned, TestId,
    TestPlanned,
};

use super::count;

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

/// Sorts entries by their suites, so that the ids of a suite follow each other. Returns the new
/// ids by the old ones.
fn sort_by_suite<T>(list: &mut Vec<T>, suite: impl Fn(&T) -> SuiteId) -> Vec<u32> {
    let mut sorted: Vec<_> = std::mem::take(list).into_iter().enumerate().collect();
    sorted.sort_by_key(|(_, entry)| suite(entry));
    let mut new = vec![0; sorted.len()];
    for (place, (old, entry)) in sorted.into_iter().enumerate() {
        new[old] = count(place);
        list.push(entry);
    }
    new
}

impl MergedPlan {
    /// The plan of all runs, with its last ids.
    pub fn numbered(mut self) -> Self {
        let fixtures = sort_by_suite(&mut self.fixtures, |fixture| fixture.suite);
        let hooks = sort_by_suite(&mut self.hooks, |hook| hook.suite);
        let tests = sort_by_suite(&mut self.tests, |test| test.suite);
        for map in &mut self.maps {
            map.fixtures.iter_mut().for_each(|id| id.0 = fixtures[id.index()]);
            map.hooks.iter_mut().for_each(|id| id.0 = hooks[id.index()]);
            map.tests.iter_mut().for_each(|id| id.0 = tests[id.index()]);
        }
        (0..).zip(&mut self.fixtures).for_each(|(id, plan)| plan.fixture = FixtureId(id));
        (0..).zip(&mut self.hooks).for_each(|(id, plan)| plan.hook = HookId(id));
        (0..).zip(&mut self.tests).for_each(|(id, plan)| plan.test = TestId(id));
        self
    }

    /// Its events, suite by suite.
    pub fn events(&self) -> impl Iterator<Item = EventKind> {
        self.suites.iter().flat_map(|suite| {
            let id = suite.suite;
            let fixtures = of_suite(&self.fixtures, id, |fixture| fixture.suite);
            let hooks = of_suite(&self.hooks, id, |hook| hook.suite);
            let tests = of_suite(&self.tests, id, |test| test.suite);
            std::iter::once(EventKind::SuitePlanned(suite.clone()))
                .chain(fixtures.iter().cloned().map(EventKind::FixturePlanned))
                .chain(hooks.iter().cloned().map(EventKind::HookPlanned))
                .chain(tests.iter().cloned().map(EventKind::TestPlanned))
        })
    }
}

/// The entries of a suite in a list that is sorted by suite.
fn of_suite<T>(list: &[T], id: SuiteId, suite: impl Fn(&T) -> SuiteId) -> &[T] {
    let begin = list.partition_point(|entry| suite(entry) < id);
    let rest = &list[begin..];
    &rest[..rest.partition_point(|entry| suite(entry) == id)]
}

/// A test that two runs have.
#[derive(Debug)]
pub(super) struct Duplicate {
    pub suite: SuiteId,
    /// With its suite.
    pub test: String,
    /// Whether the number of its repetitions is not planned in either of them.
    pub timed: bool,
    /// The places of the runs.
    pub runs: [usize; 2],
}

/// Plans that are joined, one run after the other; the ids are not the last ones.
#[derive(Debug, Default)]
pub(super) struct JoinedPlans {
    /// The plan so far. Only the ids of suites are final.
    pub plan: MergedPlan,
    /// The suites by their names and files.
    suites: HashMap<(String, String), SuiteId>,
    fixtures: HashMap<(SuiteId, String), FixtureId>,
    hooks: HashMap<(SuiteId, String), HookId>,
    /// With the run that has it first.
    tests: HashMap<(SuiteId, String), (usize, TestId)>,
    pub duplicates: Vec<Duplicate>,
}

impl JoinedPlans {
    /// The next run begins; answers its place.
    pub fn begin_part(&mut self) -> usize {
        self.plan.maps.push(Map::default());
        self.plan.maps.len() - 1
    }

    /// Adds a plan of the run that began last; other events change nothing.
    pub fn add(&mut self, kind: &EventKind) {
        match kind {
            EventKind::SuitePlanned(plan) => self.suite(plan),
            EventKind::FixturePlanned(plan) => self.fixture(plan),
            EventKind::HookPlanned(plan) => self.hook(plan),
            EventKind::TestPlanned(plan) => self.test(plan),
            _ => {}
        }
    }

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

    /// Two runs may have the same test in other episodes: then it has one id.
    fn test(&mut self, plan: &TestPlanned) {
        let (suite, part) = (self.last_suite(), self.plan.maps.len() - 1);
        let next = TestId(count(self.plan.tests.len()));
        let (first, id) = *self.tests.entry((suite, plan.name.clone())).or_insert((part, next));
        let mut is_joined = false;
        if first != part {
            let test = format!("{}/{}", self.plan.suites[suite.index()].name, plan.name);
            let timed = plan.timed && self.plan.tests[id.index()].timed;
            is_joined = timed;
            self.duplicates.push(Duplicate { suite, test, timed, runs: [first, part] });
        }
        let id = if is_joined { id } else { next };
        if id == next {
            self.plan.tests.push(TestPlanned { suite, ..plan.clone() });
        }
        self.map().tests.push(id);
    }
}
