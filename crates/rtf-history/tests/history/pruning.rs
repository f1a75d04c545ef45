//! Old runs are removed, but not the last green run of a test.

use rtf_history::ImportOutcome;
use rtf_history::store::Keep;
use rtf_model::Verdict::{Failed, Passed};

use crate::world::{Run, Test, World, all_runs};

fn runs() -> Vec<Run> {
    // `Moves` last passed on day 2, `Stops` always passes.
    let verdicts = [Passed, Passed, Failed, Failed, Failed];
    let run = |(day, verdict)| {
        let mut moves = Test::new("Moves", verdict);
        moves.measured = vec![("lag", Some(1.0), "ms")];
        Run::new(day, "aaaa", vec![moves, Test::new("Stops", Passed)])
    };
    (1..).zip(verdicts).map(run).collect()
}

fn names(world: &World) -> Vec<String> {
    world.store.runs(&all_runs()).expect("runs").into_iter().map(|run| run.name).collect()
}

#[test]
fn the_last_green_run_of_a_test_stays() {
    let mut world = World::with(&runs());
    let would = world.store.prunable(Keep::Newest(2)).expect("runs");
    assert_eq!(names(&world).len(), 5, "a question removes nothing");
    assert_eq!(world.store.prune(Keep::Newest(2)).expect("runs"), would);
    assert_eq!(names(&world), ["run-005", "run-004", "run-002"]);
    assert_eq!(world.store.check().expect("a check"), Vec::<String>::new());
    assert_eq!(world.store.prune(Keep::Newest(2)).expect("runs"), []);
}

#[test]
fn a_pruned_run_returns_only_on_request() {
    let runs = runs();
    let mut world = World::with(&runs);
    let before = world.dump();
    let since = "2026-01-05T00:00:00Z".parse().expect("a time");
    assert_eq!(world.store.prune(Keep::Since(since)).expect("runs").len(), 2);
    assert_eq!(world.import(&runs[0]), ImportOutcome::Pruned);
    assert_eq!(world.import(&runs[1]), ImportOutcome::Known);
    for run in &runs {
        world.store.restore(&run.record()).expect("an import");
    }
    assert_eq!(world.dump(), before);
    assert_eq!(world.store.counts().expect("counts").pruned, 0);
}

#[test]
fn tests_without_runs_disappear() {
    let mut runs = runs();
    runs.push(Run::new(6, "aaaa", vec![Test::new("Moves", Passed), Test::new("Stops", Passed)]));
    runs[0].tests.push(Test::new("Gone", Failed));
    let mut world = World::with(&runs);
    world.store.prune(Keep::Newest(1)).expect("runs");
    let left = world.store.identities().expect("names");
    assert_eq!(
        left.iter().map(ToString::to_string).collect::<Vec<_>>(),
        ["arm/Moves", "arm/Stops"]
    );
    assert_eq!(world.store.counts().expect("counts").series, 0);
}
