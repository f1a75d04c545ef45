//! A journal that was damaged after its run never reads as green.

use crate::mutate::{Random, mutate};
use crate::support::{Finished, Folder};

const SUITE: &str = "<suite name='arm'><hook name='park' on='failure'><command>true</command></hook>\
    <test>Good.lua</test><test>Bad.lua</test><test name='Again'>Good.lua</test></suite>";
const GOOD: &str = "function TestCase.run() rtf.report('fine') end";
const BAD: &str = "function TestCase.run() rtf.fail('the arm is stuck') end";
const MUTATIONS: u64 = 300;

/// A folder with a red run, and its journal.
fn red_run() -> (Folder, String) {
    let folder = Folder::new();
    folder.file("Good.lua", GOOD).file("Bad.lua", BAD).file("arm.xml", SUITE);
    let run = folder.rtf(&["run", "arm.xml"]);
    assert_eq!(run.code, Some(1), "{}{}", run.stdout, run.stderr);
    let journal = folder.read("rtf-results/latest/events.jsonl");
    (folder, journal)
}

fn red_and_damaged(what: &str, done: &Finished) {
    assert_eq!(done.code, Some(1), "{what}: {}{}", done.stdout, done.stderr);
    assert!(!done.stdout.contains("PASSED"), "{what}: {}", done.stdout);
}

/// The fault itself: one bad byte in the plan of the test that failed.
#[test]
fn a_failed_test_that_a_bad_byte_hides_is_still_a_red_run() {
    let (folder, journal) = red_run();
    let place = journal.find("\"name\":\"Bad\"").expect("the plan of the failed test");
    let kind = journal[..place].rfind("test-planned").expect("its kind");
    let mut damaged = journal.clone();
    damaged.replace_range(kind..=kind, "T");
    folder.file("rtf-results/latest/events.jsonl", &damaged);

    let shown = folder.rtf(&["show", "latest"]);
    red_and_damaged("show", &shown);
    let first = shown.stdout.lines().next().unwrap_or_default();
    assert!(first.contains("DAMAGED"), "first of all: {}", shown.stdout);
    let last = shown.stdout.lines().last().unwrap_or_default();
    assert!(last.starts_with("DAMAGED"), "and last of all: {}", shown.stdout);

    let report = |format: &str| folder.rtf(&["report", "latest", "--format", format]);
    let formats = [
        ("text", "the journal of this run is damaged"),
        ("junit", "the journal is damaged: line "),
        ("tap", "# the journal is damaged: line "),
        ("github", "title=the journal is damaged%3A line "),
        ("json", "{\"seq\":0,"),
    ];
    for (format, beginning) in formats {
        let report = report(format);
        red_and_damaged(format, &report);
        let before = report.stdout.find(beginning);
        let first = report.stdout.find("Good").unwrap_or(usize::MAX);
        assert!(before.is_some_and(|at| at < first || format == "json"), "{}", report.stdout);
        assert!(report.stderr.starts_with("error: the journal is damaged: line "), "{format}");
    }
    let junit = report("junit").stdout;
    let junit = junit_parser::from_reader(junit.as_bytes()).expect("valid JUnit");
    assert_eq!((junit.suites[0].name.as_str(), junit.suites[0].errors), ("rtf", 1));
    assert!(report("tap").stdout.contains("Bail out!"));

    // What is copied keeps its damage.
    folder.file("copy.jsonl", &report("json").stdout);
    red_and_damaged("a copy", &folder.rtf(&["show", "copy.jsonl"]));

    for refused in [&["merge", "latest"][..], &["run", "--rerun", "failed", "latest"]] {
        let refused = folder.rtf(refused);
        assert_eq!(refused.code, Some(2), "{}", refused.stdout);
        assert!(refused.stderr.contains("is damaged: line "), "{}", refused.stderr);
    }
}

#[test]
fn a_journal_that_is_not_damaged_is_not_called_so() {
    let (folder, journal) = red_run();
    let shown = folder.rtf(&["show", "latest"]);
    assert_eq!(shown.code, Some(1));
    assert!(!shown.stdout.contains("DAMAGED") && shown.stdout.contains("FAILED"));
    let json = folder.rtf(&["report", "latest", "--format", "json"]);
    assert_eq!((json.code, json.stdout, json.stderr.as_str()), (Some(0), journal, ""));
}

/// What a runner wrote before there were check values.
#[test]
fn a_journal_without_check_values_is_read() {
    let (folder, journal) = red_run();
    let strip = |line: &str| {
        let (event, _) = line.rsplit_once(",\"crc\":").expect("a check value");
        format!("{event}}}\n")
    };
    let old: String = journal.lines().map(strip).collect();
    folder.file("old.jsonl", &old);
    let shown = folder.rtf(&["show", "old.jsonl"]);
    assert_eq!(shown.code, Some(1));
    assert!(shown.stdout.contains("FAILED") && !shown.stdout.contains("DAMAGED"));
    let lost: String =
        old.lines().filter(|line| !line.contains("Bad")).map(|line| format!("{line}\n")).collect();
    folder.file("lost.jsonl", &lost);
    red_and_damaged("lost", &folder.rtf(&["show", "lost.jsonl"]));
}

/// The library is tried with many more: see `mutations` among the tests of `rtf-report`.
#[test]
fn no_mutation_of_a_red_journal_is_shown_as_green_and_none_panics() {
    let (folder, journal) = red_run();
    let green = {
        let green = Folder::new();
        green.file("Good.lua", GOOD).file("Bad.lua", GOOD).file("arm.xml", SUITE);
        assert_eq!(green.rtf(&["run", "arm.xml"]).code, Some(0));
        green.read("rtf-results/latest/events.jsonl")
    };
    for number in 0..MUTATIONS {
        let mut random = Random::new(number);
        let mutated = mutate(journal.as_bytes(), green.as_bytes(), &mut random);
        if mutated == journal.as_bytes() || mutated == green.as_bytes() {
            continue;
        }
        std::fs::write(folder.path().join("mutated.jsonl"), &mutated).expect("a file");
        let command = if number % 2 == 0 {
            &["show", "mutated.jsonl"][..]
        } else {
            &["show", "-v", "mutated.jsonl"]
        };
        let shown = folder.rtf(command);
        assert!(
            matches!(shown.code, Some(1 | 2 | 4)),
            "mutation {number}: {:?} {}{}",
            shown.code,
            shown.stdout,
            shown.stderr
        );
        assert!(!shown.stderr.contains("panicked"), "mutation {number}: {}", shown.stderr);
    }
}
