use super::*;
use Stream::{Stderr, Stdout};

fn patterns(texts: &[&str]) -> Vec<Regex> {
    texts.iter().map(|text| Regex::new(text).unwrap()).collect()
}

fn awaiting(pattern: &str) -> LogWatch {
    LogWatch::new(patterns(&[pattern]), Vec::new(), Vec::new())
}

fn of_value(pattern: &str) -> LogWatch {
    let pattern = Regex::new(pattern).unwrap();
    LogWatch::new(Vec::new(), Vec::new(), vec![("port".to_owned(), pattern)])
}

fn port(watch: &mut LogWatch) -> Option<String> {
    watch.take_values().pop().map(|(_, value)| value)
}

#[test]
fn patterns_match_lines_that_arrive_in_pieces() {
    let mut watch = LogWatch::new(patterns(&["^READY$"]), patterns(&["FATAL"]), Vec::new());
    watch.push(Stdout, b"REA");
    assert!(!watch.has_seen_awaited());
    watch.push(Stdout, b"DY\r\nno FAT");
    assert!(watch.has_seen_awaited());
    assert_eq!(watch.take_forbidden(), None);
    watch.push(Stdout, b"AL: motor\n");
    assert_eq!(watch.take_forbidden().as_deref(), Some("no FATAL: motor"));
    assert_eq!(watch.tail(), ["READY", "no FATAL: motor"]);
}

#[test]
fn the_first_line_that_matches_provides_a_value() {
    let mut watch = of_value("port (\\d*)");
    watch.push(Stdout, b"port \nport 40");
    assert_eq!(port(&mut watch), None);
    watch.push(Stdout, b"123\nport 5\n");
    assert_eq!(port(&mut watch).as_deref(), Some("40123"));
    assert!(watch.pattern_of("port").is_none());
}

/// What simulators print, cut at any byte.
#[test]
fn what_a_terminal_shows_is_searched_wherever_it_is_cut() {
    for (pattern, output) in [
        ("^pxh> $", "boot\r\n\x1b[32mpxh> \x1b[0m"),
        ("^gr\u{fc}n bereit$", "\x1b]0;sim\x07\x1b[1mgr\u{fc}n\x1b[0m bereit\n"),
        ("^100 %$", "\r 50 %\r100 %\r"),
        ("^READY$", "READY\r\r\n"),
        ("^\u{fc}> $", "\u{fc}> "),
        ("32mREADY", "\x1b[32mREADY\x1b[0m\n"),
    ] {
        for size in 1..=output.len() {
            let mut watch = awaiting(pattern);
            output.as_bytes().chunks(size).for_each(|piece| watch.push(Stdout, piece));
            (0..2).for_each(|_| watch.try_unfinished());
            assert!(watch.has_seen_awaited(), "{output:?} in pieces of {size} bytes");
        }
    }
}

#[test]
fn the_streams_have_separate_lines() {
    let mut watch = awaiting("^pxh> $");
    watch.push(Stdout, b"px");
    watch.push(Stderr, b"WARN [mavlink]");
    watch.push(Stdout, b"h> ");
    (0..2).for_each(|_| watch.try_unfinished());
    assert!(watch.has_seen_awaited());
    assert_eq!(watch.tail(), ["pxh> ", "WARN [mavlink]"]);
}

#[test]
fn a_match_at_the_end_of_an_unfinished_line_counts_once_nothing_follows() {
    for (pattern, pieces, is_seen) in [
        ("^READY$", ["READY", " in 5 s", ""], false),
        ("^READY", ["READY", " in 5 s", ""], true),
        ("^READY$", ["REA", "DY", ""], false),
        ("^READY$", ["READY", "", ""], true),
    ] {
        let mut watch = awaiting(pattern);
        for piece in pieces[..2].iter().filter(|piece| !piece.is_empty()) {
            watch.push(Stdout, piece.as_bytes());
            watch.try_unfinished();
        }
        if pieces[1].is_empty() {
            assert!(watch.has_unfinished());
            watch.try_unfinished();
        }
        assert_eq!(watch.has_seen_awaited(), is_seen, "{pattern} {pieces:?}");
    }
}

#[test]
fn an_unfinished_line_is_tried_until_it_is_quiet_and_matches_once() {
    let mut watch = LogWatch::new(Vec::new(), patterns(&["FATAL"]), Vec::new());
    watch.push(Stdout, b"FATAL: motor");
    watch.try_unfinished();
    assert_eq!(watch.take_forbidden().as_deref(), Some("FATAL: motor"));
    watch.push(Stdout, b"\n");
    assert!(!watch.has_unfinished());
    watch.push(Stdout, b"> ");
    (0..2).for_each(|_| {
        assert!(watch.has_unfinished());
        watch.try_unfinished();
    });
    assert!(!watch.has_unfinished(), "nothing was printed since");
}

#[test]
fn a_part_of_a_value_is_no_value() {
    let mut watch = of_value("port (\\d+)");
    watch.push(Stdout, b"port 40");
    watch.try_unfinished();
    assert_eq!(port(&mut watch), None);
    watch.push(Stdout, b"123");
    watch.try_unfinished();
    assert_eq!(port(&mut watch), None);
    watch.try_unfinished();
    assert_eq!(port(&mut watch).as_deref(), Some("40123"), "nothing follows");

    let mut watch = of_value("port (\\d+)");
    watch.push(Stdout, b"\x1b[36mport 40123\x1b[0m pxh> ");
    watch.try_unfinished();
    assert_eq!(port(&mut watch).as_deref(), Some("40123"), "something else follows");

    // A full buffer ends anywhere, and the next one may come late.
    let mut watch = of_value("port (\\d+)");
    watch.push(Stdout, &[vec![b'\n'; 4096 - 7], b"port 40".to_vec()].concat());
    (0..3).for_each(|_| watch.try_unfinished());
    assert_eq!(port(&mut watch), None);
    watch.push(Stdout, b"123\n");
    assert_eq!(port(&mut watch).as_deref(), Some("40123"));
}

#[test]
fn a_line_with_a_value_that_is_not_known_yet_is_not_reported() {
    let value = ("token".to_owned(), Regex::new("token (\\w+)").unwrap());
    let mut watch = LogWatch::new(Vec::new(), patterns(&["FATAL"]), vec![value]);
    watch.push(Stdout, b"FATAL: token s3c");
    watch.try_unfinished();
    assert_eq!(watch.take_forbidden(), None);
    watch.push(Stdout, b"ret\n");
    assert_eq!(watch.take_values().len(), 1);
    assert!(watch.take_forbidden().is_some());
}

#[test]
fn only_the_last_state_of_an_overwritten_line_is_kept() {
    let mut watch = awaiting("never");
    watch.push(Stdout, b"loading\r\n 1 %\r 2 %\r 3 %\r\n\x1b[31mno map\x1b[0m\n 1 %\r");
    assert_eq!(watch.tail(), ["loading", " 3 %", "no map", " 1 %"]);
    watch.finish();
    assert_eq!(watch.tail(), ["loading", " 3 %", "no map", " 1 %"]);
}
