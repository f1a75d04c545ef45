//! What hosts that tests share use.

use crate::order::{check, ready, starting, stopped, stopping};
use crate::record::record;
use crate::support::*;
use rtf_model::{EventKind, Resource, Source, TestId, Usage, Verdict};

const MIB: u64 = 1024 * 1024;

fn used(source: Source, tests_served: Option<u32>, memory: u64) -> EventKind {
    EventKind::ResourcesMeasured {
        source,
        usage: Usage { processes: 1, memory, descriptors: 9 },
        tests_served,
    }
}

/// Repetitions of which each has its host served so many tests.
fn repetitions(tests_served: impl IntoIterator<Item = u32>, leak: u64) -> Vec<EventKind> {
    let mut kinds = Vec::new();
    for (repetition, tests_served) in (1..).zip(tests_served) {
        let memory = 8 * MIB + u64::from(tests_served) * leak;
        let finished = finished(Verdict::Passed);
        let used = used(Source::Test(TEST), Some(tests_served), memory);
        kinds.extend([started(repetition, 1), used, finished]);
    }
    kinds
}

fn run(tests_served: &[u32]) -> Vec<EventKind> {
    run_that_leaks(tests_served, MIB)
}

fn run_that_leaks(tests_served: &[u32], leak: u64) -> Vec<EventKind> {
    let count = u32::try_from(tests_served.len()).unwrap_or(u32::MAX);
    let body = repetitions(tests_served.iter().copied(), leak);
    opened(count).into_iter().chain(body).chain(closed()).collect()
}

#[test]
fn a_host_has_served_one_test_more_or_is_another_one() {
    assert_eq!(check(&stream(run(&[1, 2, 3, 1, 2, 1]))), Ok(()));
    for wrong in [&[2][..], &[1, 1, 3], &[1, 2, 2], &[1, 0]] {
        let told = check(&stream(run(wrong))).unwrap_err();
        assert!(told.contains("a host of suite 0 serves test"), "{wrong:?}: {told}");
    }
}

#[test]
fn only_the_host_of_a_running_test_reports_its_tests_served() {
    let body = |kind: EventKind| {
        let test = [started(1, 1), kind, finished(Verdict::Passed)];
        check(&stream(opened(1).into_iter().chain(test).chain(closed())))
    };
    let told = body(used(Source::Test(TEST), None, 0)).unwrap_err();
    assert!(told.contains("only a shared host reports"), "{told}");
    let told = body(used(Source::Fixture(SIMULATOR), Some(1), 0)).unwrap_err();
    assert!(told.contains("fixture 0 is not running"), "{told}");
    let with_fixture = |tests_served| {
        let fixture = [starting(1), ready(), used(Source::Fixture(SIMULATOR), tests_served, 0)];
        let rest = [stopping(), stopped(), skipped(0)];
        let body = fixture.into_iter().chain(rest);
        check(&stream(opened(1).into_iter().chain(body).chain(closed())))
    };
    assert_eq!(with_fixture(None), Ok(()));
    let told = with_fixture(Some(1)).unwrap_err();
    assert!(told.contains("only a shared host reports"), "{told}");
    let late = [started(1, 1), finished(Verdict::Passed), used(Source::Test(TEST), Some(1), 0)];
    let told = check(&stream(opened(1).into_iter().chain(late).chain(closed()))).unwrap_err();
    assert!(told.contains("test 0 is not running"), "{told}");
}

#[test]
fn another_host_is_another_series() {
    let tests_served: Vec<u32> = (1..=30).chain(1..=12).collect();
    let record = record(run(&tests_served));
    let suite = &record.suites[0];
    let seen: Vec<_> =
        suite.hosts.iter().map(|host| (host.tests_served, host.usage.seen())).collect();
    assert_eq!(seen, [(30, 30), (12, 12)]);
    let [(host, growth)] = &suite.growing_hosts()[..] else { panic!("{:?}", suite.hosts) };
    assert_eq!((host.tests_served, &host.tests[..]), (30, &[TestId(0)][..]));
    assert_eq!((growth.len(), growth[0].resource), (1, Resource::Memory));
    assert!((growth[0].each - MIB as f64).abs() < 1.0, "{growth:?}");
    assert!(record.is_green(), "growth changes no verdict");
}

#[test]
fn what_hosts_keep_themselves_is_no_growth() {
    let tests_served: Vec<u32> = (1..=5000).collect();
    let grows = |leak| {
        let record = record(run_that_leaks(&tests_served, leak));
        record.suites[0].growing_hosts().len()
    };
    assert_eq!((grows(600), grows(6000)), (0, 1));
}

/// Of the hosts that served the same tests, the one with the most measurements counts.
#[test]
fn one_host_counts_of_those_that_served_the_same_tests() {
    let growing = |lengths: [u32; 2], leaks: [u64; 2]| {
        let mut kinds = opened(lengths[0] + lengths[1]);
        let served = lengths.into_iter().zip(leaks);
        let uses = served.flat_map(|(length, leak)| (1..=length).map(move |n| (n, leak)));
        for (repetition, (tests_served, leak)) in (1..).zip(uses) {
            let memory = 8 * MIB + u64::from(tests_served) * leak;
            let used = used(Source::Test(TEST), Some(tests_served), memory);
            kinds.extend([started(repetition, 1), used, finished(Verdict::Passed)]);
        }
        record(kinds.into_iter().chain(closed())).suites[0].growing_hosts().len()
    };
    assert_eq!(growing([30, 60], [MIB, 0]), 0);
    assert_eq!(growing([30, 60], [0, MIB]), 1);
    assert_eq!(growing([60, 30], [MIB, 0]), 1);
    // The first one of two with as many.
    assert_eq!(growing([30, 30], [MIB, 0]), 1);
    assert_eq!(growing([30, 30], [0, MIB]), 0);
}

#[test]
fn the_growth_of_a_fixture_is_that_of_its_longest_life() {
    let uses = (1..=30).map(|n| used(Source::Fixture(SIMULATOR), None, 8 * MIB + n * MIB));
    let life = [starting(1), ready()].into_iter().chain(uses);
    let record = record(opened(1).into_iter().chain(life));
    let growth = record.fixtures[0].growth();
    assert_eq!((growth.len(), growth[0].resource), (1, Resource::Memory));
}
