//! Makes up runs.

use std::path::PathBuf;

use rtf_history::{ImportOutcome, RunSelection, Store, TestAttributes};
use rtf_model::{
    Event, EventKind, Manifest, Measurement, Micros, Origin, Phase, Record, Revision, RunStarted,
    SuiteId, SuitePlanned, TestFinished, TestId, TestPlanned, Verdict,
};

/// All tests.
pub fn all_tests(_: &TestAttributes) -> bool {
    true
}

/// All runs.
pub fn all_runs() -> RunSelection {
    RunSelection::default()
}

/// A run in the making: a day, sources, and results of tests.
#[derive(Clone)]
pub struct Run {
    pub day: u32,
    pub commit: &'static str,
    pub branch: &'static str,
    pub dirty: bool,
    pub robot: &'static str,
    pub tests: Vec<Test>,
    pub is_complete: bool,
}

/// The result of a test.
#[derive(Clone)]
pub struct Test {
    pub name: &'static str,
    pub was: Option<&'static str>,
    /// Of its attempts.
    pub verdicts: Vec<Verdict>,
    pub millis: u64,
    /// Name, value and unit.
    pub measured: Vec<(&'static str, Option<f64>, &'static str)>,
    /// The hash of its sources.
    pub sources: Option<&'static str>,
}

impl Test {
    pub fn new(name: &'static str, verdict: Verdict) -> Self {
        let (verdicts, measured) = (vec![verdict], Vec::new());
        Self { name, was: None, verdicts, millis: 100, measured, sources: None }
    }
}

impl Run {
    pub fn new(day: u32, commit: &'static str, tests: Vec<Test>) -> Self {
        let (branch, robot) = ("main", "");
        Self { day, commit, branch, dirty: false, robot, tests, is_complete: true }
    }

    pub fn id(&self) -> String {
        format!("id-{:03}", self.day)
    }

    fn started(&self) -> RunStarted {
        // An empty commit: there is no repository.
        let revision = (!self.commit.is_empty()).then(|| Revision {
            commit: self.commit.to_owned(),
            branch: Some(self.branch.to_owned()),
            dir: Some(String::new()),
            dirty: Some(self.dirty),
            author_time: None,
        });
        let origin = Origin { id: self.id(), host: "bench".to_owned(), ..Origin::default() };
        let manifest = Manifest { revision, origin: Some(origin), ..Manifest::default() };
        let start: jiff::Timestamp = "2026-01-01T00:00:00Z".parse().expect("a time");
        let start = start + jiff::SignedDuration::from_hours(24 * i64::from(self.day));
        RunStarted {
            version: 1,
            run: format!("run-{:03}", self.day),
            rtf: "0.2.0".to_owned(),
            started_at: start.to_string(),
            command: vec!["rtf".to_owned()],
            working_dir: "/robot".to_owned(),
            suites: 1,
            tests: u32::try_from(self.tests.len()).expect("few"),
            manifest: Box::new(manifest),
        }
    }

    fn planned(&self) -> Vec<EventKind> {
        let robots = self.robot.split_whitespace().map(str::to_owned).collect();
        let mut events = vec![
            EventKind::RunStarted(self.started()),
            EventKind::SuitePlanned(SuitePlanned {
                suite: SuiteId(0),
                name: "arm".to_owned(),
                file: "arm.xml".to_owned(),
                description: String::new(),
                environment: String::new(),
                tolerates_collapse: false,
                skips_fail: false,
                parallel: 1,
                requires: robots,
            }),
        ];
        events.extend(self.tests.iter().zip(0..).map(|(test, id)| {
            EventKind::TestPlanned(TestPlanned {
                learned: Vec::new(),
                test: TestId(id),
                suite: SuiteId(0),
                name: test.name.to_owned(),
                plugin_type: "lua".to_owned(),
                plugin: String::new(),
                plugin_hash: None,
                source_hash: test.sources.map(str::to_owned),
                repetitions: 1,
                timed: false,
                tags: vec!["smoke".to_owned()],
                parameters: Vec::new(),
                was: test.was.map(str::to_owned),
                expected: None,
            })
        }));
        events
    }

    /// The events, each with its time.
    pub fn events(&self) -> Vec<Event> {
        let mut events: Vec<_> = self.planned().into_iter().map(|kind| (0, kind)).collect();
        let mut at = 1000;
        for (test, id) in self.tests.iter().zip(0..) {
            let id = TestId(id);
            for (attempt, verdict) in (1..).zip(&test.verdicts) {
                events.push((at, EventKind::TestStarted { test: id, repetition: 1, attempt }));
                for (name, value, unit) in &test.measured {
                    let measurement = Measurement {
                        learned: false,
                        name: (*name).to_owned(),
                        value: *value,
                        unit: (*unit).to_owned(),
                        low: None,
                        high: Some(100.0),
                        location: None,
                        case: None,
                    };
                    events.push((at, EventKind::Measured { test: id, fixture: None, measurement }));
                }
                at += test.millis * 1000;
                let finished = TestFinished {
                    test: id,
                    verdict: *verdict,
                    reason: verdict.is_problem().then(|| format!("it {verdict}")),
                    phase: Phase::Run,
                    decided_by: None,
                    exit: None,
                    rerun: usize::try_from(attempt).expect("few") < test.verdicts.len(),
                };
                events.push((at, EventKind::TestFinished(finished)));
            }
        }
        if self.is_complete {
            events.push((at, EventKind::RunFinished { interrupted: None }));
        }
        let event = |(seq, (at, kind))| Event { seq, at: Micros(at), kind };
        (0..).zip(events).map(event).collect()
    }

    pub fn record(&self) -> Record {
        record(&self.events())
    }
}

/// The fold over events.
pub fn record(events: &[Event]) -> Record {
    let mut record = Record::default();
    events.iter().for_each(|event| record.apply(event));
    record
}

/// A database in a directory that is removed with it.
pub struct World {
    pub dir: tempfile::TempDir,
    pub store: Store,
}

impl World {
    pub fn new() -> Self {
        let dir = tempfile::tempdir().expect("a directory");
        let store = Store::open(dir.path().join("history.db")).expect("a store");
        Self { dir, store }
    }

    pub fn with(runs: &[Run]) -> Self {
        let mut world = Self::new();
        runs.iter().for_each(|run| assert_eq!(world.import(run), ImportOutcome::Imported));
        world
    }

    pub fn path(&self) -> PathBuf {
        self.store.location().file().expect("a file").to_owned()
    }

    pub fn import(&mut self, run: &Run) -> ImportOutcome {
        self.store.import(&run.record()).expect("an import")
    }

    /// Everything that the store knows, as JSON.
    pub fn dump(&self) -> Vec<String> {
        dump(&self.store)
    }
}

/// Everything that a store knows, as JSON.
pub fn dump(store: &Store) -> Vec<String> {
    let json = |value: &dyn erased::Json| value.json();
    let mut lines: Vec<_> =
        store.runs(&all_runs()).expect("runs").iter().map(|run| json(run)).collect();
    let results =
        store.for_each_result::<rtf_history::StoreError>(&all_runs(), &all_tests, |line| {
            lines.push(json(&line));
            Ok(())
        });
    results.expect("results");
    let points = store.for_each_point::<rtf_history::StoreError>(&all_runs(), &all_tests, |line| {
        lines.push(json(&line));
        Ok(())
    });
    points.expect("points");
    lines
}

mod erased {
    pub trait Json {
        fn json(&self) -> String;
    }

    impl<T: serde::Serialize> Json for T {
        fn json(&self) -> String {
            serde_json::to_string(self).expect("JSON")
        }
    }
}
