//! Streams of real producers, and damaged ones.

use super::super::line::Directive;
use super::{TapEvent, TapParser};

/// The events of a stream: `+name` opens, `-name` closes, `!text` is a problem.
fn read(text: &str) -> Vec<String> {
    read_until(text, true)
}

fn read_until(text: &str, is_complete: bool) -> Vec<String> {
    let mut parser = TapParser::default();
    let mut events: Vec<TapEvent> = text.lines().flat_map(|line| parser.line(line)).collect();
    events.extend(parser.finish(is_complete));
    events.into_iter().filter_map(show).collect()
}

fn show(event: TapEvent) -> Option<String> {
    let result = |reported: super::ReportedPoint| {
        let point = reported.point;
        let directive = match point.directive {
            Some(Directive::Skip(reason)) => format!(" skip:{reason}"),
            Some(Directive::Todo(reason)) => format!(" todo:{reason}"),
            None => String::new(),
        };
        let yaml = if reported.yaml.is_empty() { "" } else { " yaml" };
        let comments = if reported.comments.is_empty() { "" } else { " comments" };
        let ok = if point.ok { "ok" } else { "not ok" };
        format!("{}: {ok}{directive}{yaml}{comments}", point.description)
    };
    Some(match event {
        TapEvent::Opened(name) => format!("+{name}"),
        TapEvent::Point(point) => result(point),
        TapEvent::Closed(point) => format!("-{}", result(point)),
        TapEvent::Problem(text) => format!("!{text}"),
        TapEvent::SkippedAll(reason) => format!("skipped: {reason}"),
        TapEvent::BailOut(reason) => format!("bail out: {reason}"),
        TapEvent::Output => return None,
    })
}

#[test]
fn test_more() {
    let text = "1..4\nok 1 - passes\nnot ok 2 - differs \\# hash\n# Subtest: inner\n    1..2\n    ok 1 - i1\n    \
                not ok 2 - i2\nnot ok 3 - inner\nnot ok 4 - todo # TODO later\n#   Failed (TODO) test 'todo'\n";
    let expected = [
        "passes: ok",
        "differs # hash: not ok",
        "+inner",
        "i1: ok",
        "i2: not ok",
        "-inner: not ok",
        "todo: not ok todo:later comments",
    ];
    assert_eq!(read(text), expected);
}

#[test]
fn node_writes_a_subtest_comment_before_each_test() {
    let text = "TAP version 13\n# Subtest: a\n    # Subtest: inner\n    not ok 1 - inner\n      ---\n      \
                error: |-\n        ok 1 - in YAML\n      ...\n    1..1\nnot ok 1 - a\n  ---\n  x: y\n  ...\n\
                # Subtest: s\nok 2 - s # SKIP why\n1..2\n# tests 2\n";
    let expected = ["+a", "inner: not ok yaml", "-a: not ok yaml", "s: ok skip:why"];
    assert_eq!(read(text), expected);
}

#[test]
fn the_name_of_a_bare_subtest_follows_it() {
    let text = "1..1\n    1..1\n        1..1\n        ok 1 - c\n    ok 1 - b\nok 1 - a\n";
    assert_eq!(read(text), ["+a", "+b", "c: ok", "-b: ok", "-a: ok"]);
}

#[test]
fn subtests_in_braces() {
    let text = "TAP version 14\nok 1 - a {\n    1..1\n    ok 1 - b {\n        ok 1 - c\n        1..1\n    }\n}\n\
                ok 2 - not a block {\n1..2\n";
    let expected = ["+a", "+b", "c: ok", "-b: ok", "-a: ok", "not a block {: ok"];
    assert_eq!(read(text), expected);
    let next = read("1..2\nok 1 - a {\n  ok 1 - b\n  1..1\n}\n    1..1\n    ok 1 - d\nok 2 - c\n");
    assert_eq!(next, ["+a", "b: ok", "-a: ok", "+c", "d: ok", "-c: ok"]);
    let cut = read("1..1\nok 1 - a {\n    ok 1 - b\n    1..1\n");
    assert_eq!(cut, ["+a", "b: ok", "!the subtest has no end (`}`)", "-: not ok"]);
}

#[test]
fn output_between_lines_is_not_part_of_a_report() {
    let text = "hello\n1..2\n# comment\nok 1 - a\n  indented\n# Subtest: b\nfrom the program\n    ok 1 - c\n\
                at the margin\n    1..1\nok 2 - b\n";
    assert_eq!(read(text), ["a: ok", "+b", "c: ok", "-b: ok"]);
}

#[test]
fn comments_belong_to_a_failed_test_until_something_else_follows() {
    let text = "1..3\nok 1 a\n# about a\nnot ok 2 b\n# (in test file t.bats, line 2)\n\nnot ok 3 c\n  ---\n  x: y\n  ...\n# d\n";
    assert_eq!(read(text), ["a: ok", "b: not ok comments", "c: not ok yaml"]);
}

#[test]
fn wrong_counts_and_numbers() {
    assert_eq!(read("1..3\nok 1\nok 2\n").last().unwrap(), "!2 of 3 planned tests were reported");
    assert_eq!(read("ok 1 a\n").last().unwrap(), "!there is no plan (`1..N`)");
    assert_eq!(read("1..2\nok 1 a\nok 1 b\n")[1], "!the test number 1 is used twice");
    let beyond = read("1..1\nok 1 a\nok 2 b\n");
    assert_eq!(
        beyond[1..],
        ["!test 2 is not in the plan, 1..1", "b: ok", "!2 of 1 planned tests were reported"]
    );
    assert_eq!(read("1..1\nok 1 a\n1..1\n").last().unwrap(), "!there is a second plan");
    assert!(
        read("ok 1 a\n1..2\nok 2 b\n")
            .contains(&"!test 2 follows the plan, which is at the end".to_owned())
    );
    // Producers that run tests in parallel.
    assert_eq!(read("1..2\nok 2 b\nok 1 a\n"), ["b: ok", "a: ok"]);
    assert_eq!(
        read("    ok 1 - b\nok 1 - a\n1..1\n"),
        ["+a", "b: ok", "!there is no plan (`1..N`)", "-a: ok"]
    );
    assert_eq!(read("1..0\nok 1 a\n").last().unwrap(), "!1 of 0 planned tests were reported");
}

#[test]
fn skipped_streams_and_bail_outs() {
    assert_eq!(read("1..0 # SKIP no arm\n"), ["skipped: no arm"]);
    let text = "1..5\nok 1 a\n# Subtest: b\n    ok 1 c\n    Bail out! no power\nok 2 b\n";
    assert_eq!(read(text), ["a: ok", "+b", "c: ok", "bail out: no power"]);
}

#[test]
fn a_killed_program_leaves_its_subtest_open() {
    let text = "1..5\nok 1 a\n# Subtest: b\n    ok 1 c\n";
    assert_eq!(read_until(text, false), ["a: ok", "+b", "c: ok"]);
    let bare = "1..5\n    ok 1 c\n";
    assert_eq!(read_until(bare, false), ["+unnamed subtest", "c: ok"]);
    let yaml = "1..5\nnot ok 1 a\n  ---\n  message: x\n";
    assert_eq!(read_until(yaml, false), ["a: not ok yaml"]);
    assert_eq!(
        read_until("1..1\n# Subtest: b\n    ok 1 c\n    1..1\n", true),
        [
            "+b",
            "c: ok",
            "!the subtest has no test line of its own",
            "-: not ok",
            "!0 of 1 planned tests were reported",
        ]
    );
}

#[test]
fn strict_streams() {
    let strict = read("pragma +strict\n1..1\nnot TAP\nok 1 a\n");
    assert_eq!(strict[0], "!a line is not TAP, which `pragma +strict` forbids: not TAP");
    assert_eq!(read("1..1\nnot TAP\nok 1 a\n"), ["a: ok"]);
}
