//! The last results of tests.

use rtf_history::answers::RecentResults;
use rtf_model::Verdict::{self, Failed, Interrupted, Passed, Skipped};

use crate::world::{Run, Test, World};

fn recent(results: &[(Verdict, u64)]) -> RecentResults {
    let run = |(day, (verdict, millis)): (u32, &(Verdict, u64))| {
        Run::new(day, "aaaa", vec![Test { millis: *millis, ..Test::new("Moves", *verdict) }])
    };
    let world = World::with(&(1..).zip(results).map(run).collect::<Vec<_>>());
    let found = world.store.recent_results(None).expect("results");
    assert_eq!(world.store.recent_results(Some("real")).expect("results").len(), 0);
    let [(test, results)] = found.iter().collect::<Vec<_>>()[..] else { panic!("{found:?}") };
    assert_eq!(test.to_string(), "arm/Moves");
    *results
}

#[test]
fn the_last_result_that_says_something_counts() {
    assert!(recent(&[(Passed, 1), (Failed, 1)]).failed);
    assert!(recent(&[(Failed, 1), (Skipped, 1), (Interrupted, 1)]).failed);
    assert!(!recent(&[(Failed, 1), (Passed, 1)]).failed);
    assert!(!recent(&[(Skipped, 1)]).failed);
}

#[test]
fn the_duration_is_the_median_of_the_last_ten() {
    let mut results = vec![(Passed, 9000); 20];
    assert_eq!(recent(&results).duration, Some(9.0));
    results.extend([(Passed, 1000); 10]);
    assert_eq!(recent(&results).duration, Some(1.0));
    assert_eq!(recent(&[(Skipped, 5)]).duration, None);
}
