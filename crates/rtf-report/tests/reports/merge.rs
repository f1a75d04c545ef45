//! Parts of a run, merged, are the run.

mod episodes;
mod runs;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use proptest::prelude::*;
use rtf_model::{
    Event, EventKind, FixtureRecord, LineSealer, Micros, OrderChecker, Record, SuiteRecord, TestId,
    Verdict,
};
use rtf_report::merge::{
    Header, Keep, MergeInput, MergeOptions, MergeProblem, attachment_path, merge,
};

use runs::{PARTS, Run, Suite, Test, Try, suites};

fn header() -> Header {
    let (run, rtf) = ("merged".to_owned(), "0.1.0".to_owned());
    Header { run, rtf, command: vec!["rtf".into(), "merge".into()] }
}

/// Writes each part to a journal, as a runner does.
fn journal((number, events): (usize, Vec<Event>), dir: &Path) -> MergeInput {
    let (mut sealer, mut text) = (LineSealer::default(), Vec::new());
    for event in events {
        let start = text.len();
        serde_json::to_writer(&mut text, &event).unwrap();
        sealer.seal(&mut text, start);
    }
    let journal = dir.join(format!("{number}.jsonl"));
    std::fs::write(&journal, text).unwrap();
    MergeInput { name: format!("run-{number}"), journal }
}

fn merged(parts: impl IntoIterator<Item = Vec<Event>>) -> Result<Record, Vec<MergeProblem>> {
    merged_keeping(Keep::All, parts).map(|(record, _)| record)
}

/// The merged run, and the paths of the files that are copied.
fn merged_keeping(
    keep: Keep,
    parts: impl IntoIterator<Item = Vec<Event>>,
) -> Result<(Record, BTreeSet<String>), Vec<MergeProblem>> {
    let dir = tempfile::tempdir().unwrap();
    let parts = (1..).zip(parts).map(|part| journal(part, dir.path())).collect();
    let (mut events, mut order) = (Vec::new(), OrderChecker::default());
    let mut copied = BTreeSet::new();
    merge(parts, MergeOptions { keep, ..MergeOptions::default() })?
        .write(header(), &mut |event, file| {
            order.check(event).unwrap();
            events.push(event.clone());
            copied.extend(file.map(|file| file.target.clone()));
            Ok(())
        })
        .unwrap();
    order.finish().unwrap();
    Ok((record(&events), copied))
}

fn record(events: &[Event]) -> Record {
    let mut record = Record::default();
    events.iter().for_each(|event| record.apply(event));
    record
}

/// What is known of each test, without the times at which it happened.
fn facts(record: &Record) -> BTreeMap<String, Vec<String>> {
    let facts = (0..).map(TestId).zip(&record.tests).map(|(id, test)| {
        let verdict = (record.final_verdict(id), test.is_flaky(), test.reason(), test.duration());
        let attempts = test.attempts.iter().map(|attempt| {
            let told = (&attempt.messages, &attempt.measurements, attempt.counts);
            let files: Vec<_> = attempt.attachments.iter().map(|file| &file.name).collect();
            let ends = (attempt.verdict(), attempt.duration());
            format!("{:?} {ends:?} {told:?} {files:?}", (attempt.repetition, attempt.attempt))
        });
        (record.full_name(id), [format!("{verdict:?}")].into_iter().chain(attempts).collect())
    });
    facts.collect()
}

/// Number of measurements of the shared hosts of each suite. Each part has separate hosts.
fn measured(record: &Record) -> BTreeMap<&str, u64> {
    let seen = |suite: &SuiteRecord| suite.hosts.iter().map(|host| host.usage.seen()).sum();
    record.suites.iter().map(|suite| (suite.plan.name.as_str(), seen(suite))).collect()
}

/// The values of each fixture.
fn values(record: &Record) -> BTreeMap<String, Vec<String>> {
    let of_fixture = |fixture: &FixtureRecord| {
        let suite = &record.suites[fixture.plan.suite.index()].plan.name;
        let values = fixture.values.iter();
        let values = values.map(|value| format!("{} {}", value.name, value.text()));
        (format!("{suite}/{}", fixture.plan.name), values.collect())
    };
    record.fixtures.iter().map(of_fixture).collect()
}

proptest! {
    #[test]
    fn the_parts_of_a_run_make_up_the_run(mut suites in suites()) {
        // What a broken fixture lets be run depends on the part.
        suites.iter_mut().for_each(|suite| suite.breaks = false);
        let whole = record(&Run::of(&suites, None).unwrap());
        let parts = (0..PARTS).filter_map(|part| Run::of(&suites, Some(part)));
        let merged = merged(parts).unwrap();
        prop_assert_eq!(facts(&merged), facts(&whole));
        prop_assert_eq!(merged.totals(), whole.totals());
        prop_assert_eq!(merged.is_green(), whole.is_green());
        let manifest = (*merged.run.as_ref().unwrap().manifest).clone();
        prop_assert!(!manifest.parts.is_empty());
        let manifest = rtf_model::Manifest { parts: Vec::new(), ..manifest };
        prop_assert_eq!(&manifest, &*whole.run.as_ref().unwrap().manifest);
        let suites = |record: &Record| -> BTreeSet<String> {
            record.suites.iter().map(|suite| format!("{:?}", (&suite.plan.name, suite.fixtures.len(), suite.hooks.len(), suite.tests.len()))).collect()
        };
        prop_assert_eq!(suites(&merged), suites(&whole));
        let collapses = |record: &Record| record.fixtures.iter().map(|fixture| fixture.collapses.len()).sum::<usize>();
        prop_assert_eq!(collapses(&merged), collapses(&whole));
        prop_assert_eq!(measured(&merged), measured(&whole));
        prop_assert_eq!(values(&merged), values(&whole));
    }

    /// Each part may have lost its runner, at any moment, or have fixtures that broke.
    #[test]
    fn parts_that_were_killed_are_told_as_such(
        suites in suites(),
        cuts in prop::collection::vec((any::<prop::sample::Index>(), 0..3_u8), PARTS as usize),
    ) {
        let mut parts: Vec<_> = (0..PARTS).filter_map(|part| Run::of(&suites, Some(part))).collect();
        let mut killed = false;
        for (events, (cut, how)) in parts.iter_mut().zip(cuts) {
            if how > 0 {
                events.truncate(1 + cut.index(events.len() - 1));
                killed = true;
            }
            if how > 1 {
                let (seq, at) = (events.len() as u64, Micros(events[events.len() - 1].at.0));
                let kind = EventKind::RunnerDied { reason: "signal 9".into(), leaked: Vec::new() };
                events.push(Event { seq, at, kind });
            }
        }
        let apart: BTreeMap<_, _> = parts.iter().flat_map(|events| facts(&record(events))).collect();
        let merged = merged(parts).unwrap();
        prop_assert_eq!(facts(&merged), apart);
        prop_assert_eq!(merged.runner_death().is_some(), killed);
        prop_assert!(!(killed && merged.is_green()));
    }
}

/// A passing test of a suite with a fixture.
fn single(part: u32) -> Suite {
    let tried = Try { verdict: Verdict::Passed, takes: 100, messages: 1, measured: Some(1.0) };
    let test = Test { repetitions: vec![vec![tried]], skipped: false, part };
    Suite { fixtures: 1, hooks: 1, collapses: false, breaks: false, tests: vec![test] }
}

#[test]
fn a_test_that_two_runs_have_is_told() {
    let suites = [single(0)];
    let run = || Run::of(&suites, None).unwrap();
    let problems = merged([run(), run()]).unwrap_err();
    let told: Vec<_> = problems.iter().map(ToString::to_string).collect();
    assert_eq!(told, ["test `suite-0/test-0` is in `run-1` and in `run-2`"]);
}

#[test]
fn a_part_that_is_missing_is_told_unless_it_has_no_test() {
    let suites = [single(0), single(2)];
    let part = |part| Run::of(&suites, Some(part)).unwrap();
    assert!(merged([part(0), part(2)]).unwrap().is_green());
    let problems = merged([part(2)]).unwrap_err();
    let told: Vec<_> = problems.iter().map(ToString::to_string).collect();
    assert_eq!(told, ["not all of 3 parts are there: 1/3, 2/3 are missing"]);
}

#[test]
fn attachments_of_failures_and_of_a_sample_are_kept() {
    let mut suites = [single(0), single(1), single(2)];
    let try_of = |verdict| Try { verdict, takes: 100, messages: 0, measured: Some(1.0) };
    // One attempt fails and is repeated; of five, two fail.
    suites[1].tests[0].repetitions = vec![vec![try_of(Verdict::Crashed), try_of(Verdict::Passed)]];
    suites[2].tests[0].repetitions = vec![vec![try_of(Verdict::Failed)]];
    let parts = || (0..PARTS).filter_map(|part| Run::of(&suites, Some(part)));
    let kept = |words: &str| {
        let (record, copied) = merged_keeping(words.parse().unwrap(), parts()).unwrap();
        let attempts = record.tests.iter().flat_map(|test| &test.attempts);
        let kept: Vec<_> = attempts
            .flat_map(|attempt| attempt.attachments.iter().map(|file| (attempt.verdict(), file)))
            .filter(|(_, file)| !file.omitted)
            .collect();
        let paths: BTreeSet<_> = kept.iter().map(|(_, file)| file.path.clone()).collect();
        assert_eq!(paths, copied, "{words}");
        let mut verdicts: Vec<_> =
            kept.iter().map(|(verdict, _)| verdict.unwrap().as_str()).collect();
        verdicts.sort_unstable();
        verdicts
    };
    assert_eq!(kept("all"), ["crashed", "failed", "passed", "passed"]);
    assert_eq!(kept("failed"), ["crashed", "failed"]);
    assert_eq!(kept("failed sample:1"), ["crashed", "failed", "passed"]);
    assert_eq!(kept("failed sample:9"), kept("all"));
    assert_eq!(kept("sample:2"), ["passed", "passed"]);
    assert!(kept("sample:0").is_empty());
}

/// Also the second journal that cannot be used is read and reported.
#[test]
fn all_journals_that_cannot_be_used_are_told() {
    let part = |part| Run::of(&[single(0), single(1)], Some(part)).unwrap();
    let mut jumbled = part(0);
    jumbled.retain(|event| !matches!(event.kind, EventKind::TestStarted { .. }));
    (0..).zip(&mut jumbled).for_each(|(seq, event)| event.seq = seq);
    let mut damaged = part(1);
    damaged.remove(1);
    let problems = merged([jumbled, damaged]).unwrap_err();
    let told: Vec<_> = problems.iter().map(ToString::to_string).collect();
    assert_eq!(
        told,
        [
            "the journal of `run-1` is not in order",
            "the journal of `run-2` is damaged: line 2: found event 2 where event 1 is expected",
        ]
    );
}

#[test]
fn a_journal_that_changes_during_the_merge_is_told() {
    let dir = tempfile::tempdir().unwrap();
    let run = Run::of(&[single(0)], None).unwrap();
    let part = journal((1, run.clone()), dir.path());
    let path = part.journal.clone();
    let merged = merge(vec![part], MergeOptions::default()).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, text.replace("suite-started", "suite-restart")).unwrap();
    let mut events = 0;
    let error = merged.write(header(), &mut |_, _| {
        events += 1;
        Ok(())
    });
    let error = error.unwrap_err().to_string();
    assert!(error.ends_with("1.jsonl` has changed since it was read"), "{error}");
    assert!(events < run.len());
}

#[test]
fn a_joined_suite_starts_once_and_its_fixture_in_each_part() {
    let mut suite = single(0);
    suite.tests.extend(single(1).tests);
    let suites = [suite];
    let merged = merged((0..2).map(|part| Run::of(&suites, Some(part)).unwrap())).unwrap();
    assert_eq!((merged.suites.len(), merged.fixtures.len(), merged.hooks.len()), (1, 1, 1));
    assert_eq!(merged.fixtures[0].starts, 2);
    let tests: Vec<_> = merged.hooks[0].runs.iter().map(|run| run.test).collect();
    assert_eq!(tests, [Some(TestId(0)), Some(TestId(1))], "each about its own part's test");
    let paths: Vec<_> =
        merged.tests.iter().map(|test| test.attempts[0].attachments[0].path.as_str()).collect();
    assert_eq!(paths, ["attachments/part-1/0/1/plot.png", "attachments/part-2/0/1/plot.png"]);
}

#[test]
fn a_value_belongs_to_the_same_fixture_in_the_merged_run() {
    let suites = [single(0), single(1)];
    let merged = merged((0..2).map(|part| Run::of(&suites, Some(part)).unwrap())).unwrap();
    let values: Vec<_> = values(&merged).into_iter().collect();
    let wanted = ["suite-0/fixture-0", "suite-1/fixture-0"]
        .map(|name| (name.to_owned(), vec![format!("address {name}"), "token ***".to_owned()]));
    assert_eq!(values, wanted);
}

#[test]
fn no_path_leads_out_of_the_attachments() {
    assert_eq!(
        attachment_path(0, "attachments/0/1/a").as_deref(),
        Some("attachments/part-1/0/1/a")
    );
    for path in ["attachments/../events.jsonl", "/etc/passwd", "../x", "attachments", "logs/a.log"]
    {
        assert_eq!(attachment_path(0, path), None, "{path}");
    }
}

#[test]
fn cases_marks_and_failing_skips_are_kept() {
    let part = |name| crate::support::events(name).0;
    let mut strict = part("known-failures");
    for event in &mut strict {
        match &mut event.kind {
            EventKind::RunStarted(run) => run.manifest.no_skips = true,
            EventKind::SuitePlanned(suite) => suite.skips_fail = true,
            _ => {}
        }
    }
    let merged = merged([part("cases"), strict]).unwrap();
    let parts = [crate::support::record("cases"), crate::support::record("known-failures")];
    let kept = |record: &Record| -> Vec<_> {
        let of_test = |test: &rtf_model::TestRecord| {
            let cases = test.attempts.iter().flat_map(|attempt| attempt.cases.kept());
            let cases: Vec<_> = cases.map(|case| (case.path.clone(), case.verdict())).collect();
            let not_run: usize = test.attempts.iter().map(|a| a.cases.not_run().len()).sum();
            (test.plan.name.clone(), test.plan.expected.clone(), cases, not_run)
        };
        record.tests.iter().map(of_test).collect()
    };
    assert_eq!(kept(&merged), parts.iter().flat_map(kept).collect::<Vec<_>>());
    assert!(merged.suites[0].plan.skips_fail, "in any of the runs");
    assert!(merged.run.unwrap().manifest.no_skips, "in any of the runs");
}
