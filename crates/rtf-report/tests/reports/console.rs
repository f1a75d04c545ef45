//! What snapshots of the console do not show.

use crate::support::*;
use rtf_report::console::{ConsoleOptions, Verbosity};

fn verbose() -> ConsoleOptions {
    ConsoleOptions { verbosity: Verbosity::Verbose, ..ConsoleOptions::default() }
}

/// What a plug-in prints or reports must not move the cursor, set the title,
/// or reverse the direction of writing.
#[test]
fn only_our_own_colours_reach_the_terminal() {
    for name in names() {
        for options in [ConsoleOptions::default(), verbose()] {
            let mut text = console(&name, options);
            let ours = ["\x1b[1m", "\x1b[2m", "\x1b[0m", "\x1b[31m", "\x1b[32m", "\x1b[33m"];
            ours.iter().for_each(|code| text = text.replace(code, ""));
            let commands: Vec<_> = text
                .chars()
                .filter(|c| (c.is_control() && *c != '\n' && *c != '\t') || *c == '\u{202e}')
                .collect();
            assert!(commands.is_empty(), "{name}: {commands:?}");
        }
    }
}

/// The last line is green for a green run, red for every other.
#[test]
fn the_last_line_is_the_result() {
    for name in names() {
        let text = console(&name, ConsoleOptions::default());
        let last = text.lines().next_back().unwrap();
        let green = last.starts_with("\x1b[1m\x1b[32mPASSED\x1b[0m  ");
        assert_eq!(green, record(&name).is_green(), "{name}: {last:?}");
        assert!(green || last.starts_with("\x1b[1m\x1b[31m"), "{name}: {last:?}");
    }
}

#[test]
fn a_failed_test_is_named_with_the_command_that_runs_it_again() {
    let text = console("nasty", ConsoleOptions::default());
    assert!(text.contains(r"rtf run 'my '\''odd'\'' <suite>.xml::"), "{text}");
    let none = ConsoleOptions { rerun: Box::new(|_, _, _| None), ..ConsoleOptions::default() };
    assert!(!console("nasty", none).contains("rtf run"));
}

#[test]
fn quiet_says_nothing_of_what_went_well() {
    let options = ConsoleOptions { verbosity: Verbosity::Quiet, ..ConsoleOptions::default() };
    assert_eq!(console("silent", options).trim().lines().count(), 1);
}

#[test]
fn a_hook_that_failed_is_loud_also_when_all_tests_passed() {
    for verbosity in [Verbosity::Quiet, Verbosity::Normal, Verbosity::Verbose] {
        let options = ConsoleOptions { verbosity, ..ConsoleOptions::default() };
        let text = console("hook-failed", options);
        assert!(text.contains("\x1b[1m\x1b[31mHOOK FAILED\x1b[0m"), "{verbosity:?}: {text}");
        let warning = "\x1b[1m\x1b[31mhooks that failed: the robot may not be in a safe state";
        assert!(text.contains(warning), "{verbosity:?}: {text}");
        assert!(text.trim_end().ends_with("1 passed; 1 hook failed"), "{verbosity:?}: {text}");
    }
}

#[test]
fn a_fixture_that_collapses_again_and_again_is_told_once_with_a_number() {
    let stream = std::fs::read_to_string(stream_path("collapse-tolerated")).unwrap();
    let strict = stream.replace(",\"tolerates_collapse\":true", "");
    let mut lines: Vec<_> = strict.lines().map(str::to_owned).collect();
    let collapse = lines.iter().position(|line| line.contains("fixture-collapsed")).unwrap();
    lines.insert(collapse, lines[collapse].clone());
    let numbered = |(seq, line): (usize, &String)| {
        let rest = line.split_once(',').unwrap().1;
        format!("{{\"seq\":{seq},{rest}\n")
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("events.jsonl");
    std::fs::write(&path, lines.iter().enumerate().map(numbered).collect::<String>()).unwrap();
    let paper = Paper::default();
    let options = ConsoleOptions::default();
    let mut console = rtf_report::console::Console::new(Box::new(paper.clone()), options);
    rtf_report::journal::replay(&path, &mut console).unwrap();
    assert!(paper.text().contains("the bridge is gone\u{1b}[0m (2 times)"), "{}", paper.text());
}
