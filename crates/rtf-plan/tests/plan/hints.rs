//! A hint can be followed: what it says repairs the suite, its files or the command line.

mod desk;
mod fixtures;
mod formulas;
mod limits;
mod options;
mod plugins;
mod suites;
mod unapplied;

use std::path::{Path, PathBuf};

use regex::Regex;
use rtf_model::SignalSource;

use self::desk::{Desk, bench};
use crate::signals::signals;

/// The text around a mistake, in which `{}` stands for it, and its rows: a mistake, its hint, and
/// what replaces the mistake if a user follows the hint.
///
/// The text is a suite, followed by other files. A line `== NAME` begins a file, `== program NAME`
/// an executable one, `== command line` the inputs and options, `== environment` variables.
type Table = (&'static str, &'static [(&'static str, &'static str, &'static str)]);

const TABLES: [&[Table]; 6] = [
    suites::TABLES,
    fixtures::TABLES,
    plugins::TABLES,
    options::TABLES,
    limits::TABLES,
    formulas::TABLES,
];

#[test]
fn nothing_is_wrong_after_a_hint_was_followed() {
    let mut desk = Desk::new();
    let mut wrong = Vec::new();
    for (around, rows) in TABLES.concat() {
        for (mistake, hint, repair) in rows {
            let before = desk.problems(&around.replace("{}", mistake));
            let hints: Vec<_> = before.iter().filter_map(|(_, hint)| hint.as_deref()).collect();
            let after = desk.problems(&around.replace("{}", repair));
            if hints != [*hint] || !after.is_empty() {
                wrong.push((mistake, hint, before, after));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Each text after the word `hint` in the sources is in a table, or one that none can apply.
#[test]
fn each_hint_is_in_a_table() {
    let literal = Regex::new(
        r#"\bhint\w*\s*(?:\(|=>?|:)\s*(?:(?:Some|format!)\(\s*)*"((?:[^"\\]|\\(?s:.))*)""#,
    );
    let literal = literal.unwrap();
    let rows = TABLES.concat().into_iter().flat_map(|(_, rows)| rows.iter().map(|row| row.1));
    let known: Vec<&str> = rows.chain(unapplied::HINTS.iter().copied()).collect();
    let mut unknown = Vec::new();
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for file in ["rtf-plan/src", "rtf-monitor/src"].iter().flat_map(|dir| files(&crates.join(dir)))
    {
        let text = std::fs::read_to_string(&file).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap();
        for found in literal.captures_iter(code) {
            let pattern = pattern(&found[1]);
            if !known.iter().any(|hint| pattern.is_match(hint)) {
                unknown.push(format!("{}: {}", file.display(), &found[1]));
            }
        }
    }
    assert!(unknown.is_empty(), "{unknown:#?}");
}

/// What a literal stands for. A part in braces may be anything.
fn pattern(literal: &str) -> Regex {
    let text = Regex::new(r"\\\n\s*").unwrap().replace_all(literal, "");
    let text = text.replace("\\\"", "\"").replace("\\\\", "\\");
    let text = regex::escape(&text.replace("{{", "{").replace("}}", "}"));
    let text = Regex::new(r"\\\{.*?\\\}").unwrap().replace_all(&text, ".*");
    Regex::new(&format!("^{text}$")).unwrap()
}

fn files(dir: &Path) -> Vec<PathBuf> {
    let entries = dir.read_dir().unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

/// What a running program of signals reports about times of another clock.
#[test]
fn hints_about_times_of_another_clock_can_be_followed() {
    let bench = bench();
    let advice = |suite: &str| {
        assert_eq!(bench.shown(suite), "", "{suite}");
        let plan = bench.plan(&["s.xml"]);
        let (_, config) = signals(&plan);
        let [SignalSource::Program(program)] = &*config.sources else { panic!("{config:?}") };
        program.other_clock.clone()
    };
    let suite = |attributes: &str, signal: &str| {
        format!("<suite{attributes}><signal name='q' {signal}<test>A.lua</test></suite>")
    };
    let own = advice(&suite("", "><command>./read</command></signal>"));
    assert_eq!(own, "`time=\"own\"` in the suite is for another clock");
    advice(&suite("", "time=\"own\"><command>./read</command></signal>"));
    for (signal, clock) in [
        ("ros='/arm.position[elbow]'/>", "clock=\"ros\""),
        ("ros2='/arm.position[elbow]'/>", "clock=\"ros2\""),
        ("yarp='/arm:o[0]'/>", "clock=\"yarp\""),
    ] {
        let wall = advice(&suite("", signal));
        assert_eq!(wall, format!("`{clock}` in `<suite>` is for simulated times"));
        let simulated = advice(&suite(&format!(" {clock}"), signal));
        assert!(simulated.contains("has to use the simulated time"), "{simulated}");
    }
}
