//! Answers over planted results.

use rtf_history::RunSelection;
use rtf_history::answers::FlakyTest;
use rtf_model::Verdict::{self, Collapsed, Failed, Passed, Skipped};

use crate::world::{Run, Test, World, all_runs, all_tests};

fn single(day: u32, commit: &'static str, verdict: Verdict) -> Run {
    Run::new(day, commit, vec![Test::new("Moves", verdict)])
}

fn flaky(world: &World, runs: &RunSelection) -> Vec<FlakyTest> {
    world.store.flaky(runs, &all_tests).expect("flaky tests").tests
}

#[test]
fn a_test_that_fails_and_passes_on_one_commit_is_flaky() {
    let verdicts = [Passed, Failed, Skipped, Failed, Collapsed, Passed];
    let runs: Vec<_> = (1..).zip(verdicts).map(|(day, v)| single(day, "aaaa", v)).collect();
    let world = World::with(&runs);
    let found = flaky(&world, &all_runs());
    let [test] = found.as_slice() else { panic!("{found:?}") };
    assert_eq!(test.identity.to_string(), "arm/Moves");
    assert_eq!((test.flips.flips, test.flips.pairs, test.flips.bench), (2, 3, 1));
    let problem = test.last_problem.as_ref().expect("a problem");
    assert_eq!((problem.verdict, problem.run.as_str()), (Collapsed, "id-005"));
}

#[test]
fn a_regression_is_not_flaky() {
    let runs = [single(1, "aaaa", Passed), single(2, "bbbb", Failed), single(3, "cccc", Passed)];
    assert_eq!(flaky(&World::with(&runs), &all_runs()), []);
}

#[test]
fn uncommitted_changes_and_another_robot_are_not_compared() {
    let mut runs = [single(1, "aaaa", Passed), single(2, "aaaa", Failed)];
    runs[1].dirty = true;
    assert_eq!(flaky(&World::with(&runs), &all_runs()), []);
    runs[1].dirty = false;
    runs[1].robot = "robot:icub";
    assert_eq!(flaky(&World::with(&runs), &all_runs()), []);
    runs[1].robot = "";
    assert_eq!(flaky(&World::with(&runs), &all_runs()).len(), 1);
}

#[test]
fn equal_sources_are_compared_whether_committed_or_not() {
    let mut runs: Vec<_> = [Passed, Failed, Passed, Failed, Passed]
        .into_iter()
        .zip(["aaaa", "aaaa", "", "bbbb", "cccc"])
        .zip(1..)
        .map(|((verdict, commit), day)| single(day, commit, verdict))
        .collect();
    for (run, sources) in runs.iter_mut().zip(["1f", "1f", "1f", "2e", "1f"]) {
        run.tests[0].sources = Some(sources);
    }
    runs[1].dirty = true;
    let world = World::with(&runs);
    let found = flaky(&world, &all_runs());
    let flips = found[0].flips;
    assert_eq!((flips.flips, flips.pairs, flips.pairs_by_sources), (2, 3, 3));
    let compared = world.store.flaky(&all_runs(), &all_tests).expect("flaky tests").compared;
    assert_eq!((compared.by_commit, compared.by_sources, compared.neither), (3, 2, 0));
    runs[1].robot = "robot:icub";
    runs[2].tests[0].sources = None;
    let world = World::with(&runs);
    assert_eq!(flaky(&world, &all_runs()), [], "another robot, and unknown sources");
    let compared = world.store.flaky(&all_runs(), &all_tests).expect("flaky tests").compared;
    assert_eq!((compared.by_sources, compared.neither), (1, 1));
}

#[test]
fn a_change_says_whether_the_sources_of_the_test_changed() {
    let run = |day: u32, sources: [&'static str; 2]| {
        let late = day > 4;
        let mut test = Test::new("Moves", Passed);
        test.measured = vec![("lag", Some(if late { 20.0 } else { 10.0 }), "ms")];
        test.sources = Some(sources[usize::from(late)]);
        Run::new(day, "", vec![test])
    };
    for (sources, changed) in [(["1", "1"], false), (["1", "2"], true)] {
        let runs: Vec<_> = (1..=8).map(|day| run(day, sources)).collect();
        let world = World::with(&runs);
        let changes = world.store.changes(&all_runs(), &all_tests).expect("changes");
        let found: Vec<_> = changes.iter().map(|it| (&*it.run, it.sources_changed)).collect();
        assert_eq!(found, [("id-005", Some(changed))]);
    }
}

#[test]
fn a_pass_after_a_retry_is_flaky() {
    let mut run = single(1, "aaaa", Passed);
    run.tests[0].verdicts = vec![Failed, Passed];
    let found = flaky(&World::with(&[run]), &all_runs());
    assert_eq!((found[0].flips.flips, found[0].flips.pairs), (1, 1));
}

#[test]
fn without_a_commit_results_of_one_run_are_compared() {
    let mut runs = [1, 2].map(|day| single(day, "aaaa", Passed));
    runs[0].tests[0].verdicts = vec![Failed, Passed];
    runs[0].dirty = true;
    runs[1].dirty = true;
    let found = flaky(&World::with(&runs), &all_runs());
    assert_eq!((found[0].flips.flips, found[0].flips.pairs), (1, 1));
}

#[test]
fn a_selection_of_runs() {
    let mut runs: Vec<_> = (1..=6).map(|day| single(day, "aaaa", Passed)).collect();
    runs[1].branch = "arm";
    runs[2].branch = "arm";
    runs[3].robot = "robot:icub gpu";
    let world = World::with(&runs);
    let names = |selection: RunSelection| {
        let found = world.store.runs(&selection).expect("runs");
        found.into_iter().map(|run| run.name).collect::<Vec<_>>()
    };
    let arm = RunSelection { branch: Some("arm".to_owned()), ..all_runs() };
    assert_eq!(names(arm.clone()), ["run-003", "run-002"]);
    assert_eq!(names(RunSelection { last: Some(1), ..arm }), ["run-003"]);
    let since = "2026-01-06T00:00:00Z".parse().ok();
    assert_eq!(names(RunSelection { since, ..all_runs() }), ["run-006", "run-005"]);
    let commit = |start: &str| RunSelection { commit: Some(start.to_owned()), ..all_runs() };
    assert_eq!((names(commit("aa")).len(), names(commit("b")).len()), (6, 0));
    let robot = RunSelection { robot: Some("robot:icub".to_owned()), ..all_runs() };
    let histories = world.store.test_histories(&robot, &all_tests).expect("histories");
    assert_eq!(histories[0].results.len(), 1);
}

#[test]
fn the_slowest_test_is_first() {
    let run = |day, fast, slow| {
        let (mut a, mut b) = (Test::new("Fast", Passed), Test::new("Slow", Passed));
        (a.millis, b.millis) = (fast, slow);
        Run::new(
            day,
            "aaaa",
            vec![a, b, Test { verdicts: Vec::new(), ..Test::new("Never", Passed) }],
        )
    };
    let world = World::with(&[run(1, 10, 500), run(2, 20, 700), run(3, 900, 600)]);
    let slow = world.store.slow(&all_runs(), &all_tests).expect("durations");
    let found: Vec<_> =
        slow.iter().map(|it| (it.identity.test.as_str(), it.median, it.max, it.last)).collect();
    assert_eq!(found, [("Slow", 0.6, 0.7, 0.6), ("Fast", 0.02, 0.9, 0.9)]);
}

#[test]
fn two_branches_are_compared() {
    let run = |day, branch, lag, verdict| {
        let mut test = Test::new("Moves", verdict);
        test.measured = vec![("lag", Some(lag), "ms")];
        let mut run = Run::new(day, "aaaa", vec![test]);
        run.branch = branch;
        run
    };
    let mut other = run(4, "arm", 120.0, Failed);
    other.tests.push(Test::new("New", Passed));
    let world = World::with(&[
        run(1, "main", 10.0, Passed),
        run(2, "main", 12.0, Passed),
        run(3, "arm", 20.0, Passed),
        other,
    ]);
    let branch = |name: &str| RunSelection { branch: Some(name.to_owned()), ..all_runs() };
    let sides = (&branch("main"), &branch("arm"));
    let found = world.store.compare(sides, &all_tests).expect("a comparison");
    assert_eq!((found.runs_a, found.runs_b, found.tests.len()), (2, 2, 1));
    let moves = &found.tests[0];
    assert_eq!((moves.last_a, moves.last_b), (Passed, Failed));
    assert_eq!((moves.verdicts_a.of(Passed), moves.verdicts_b.of(Failed)), (2, 1));
    let lag = &moves.numbers[0];
    assert_eq!((lag.a, lag.b, lag.outside_a, lag.outside_b), (Some(11.0), Some(70.0), 0, 1));
    assert_eq!(found.only_a, []);
    assert_eq!(found.only_b[0].test, "New");
}
