//! Every reporter × every stored stream of events.

use crate::support::*;
use anstream::StripStream;
use rtf_model::OrderChecker;
use rtf_report::console::{Console, ConsoleOptions, Verbosity};
use rtf_report::{journal, text};

fn plain(name: &str, verbosity: Verbosity) -> String {
    let paper = Paper::default();
    let folder = Some("rtf-results/run".into());
    let options = ConsoleOptions { verbosity, folder, ..ConsoleOptions::default() };
    let mut console = Console::new(
        Box::new(StripStream::new(Box::new(paper.clone()) as Box<dyn std::io::Write + Send>)),
        options,
    );
    journal::replay(&stream_path(name), &mut console).unwrap();
    paper.text()
}

#[test]
fn the_streams_are_legal() {
    for name in names() {
        let (events, stored) = events(&name);
        let mut order = OrderChecker::default();
        for event in &events {
            order.check(event).unwrap_or_else(|error| panic!("{name}: {error}"));
        }
        assert!(stored.record.damages.is_empty(), "{name}: {:?}", stored.record.damages);
        assert_eq!(stored.torn, name == KILLED, "{name}");
        assert_eq!(order.finish().is_err(), name == KILLED, "{name}");
    }
}

#[test]
fn console() {
    for name in names() {
        insta::assert_snapshot!(format!("console-{name}"), plain(&name, Verbosity::Normal));
    }
}

#[test]
fn quiet_console() {
    let names = [
        "verdicts",
        "silent",
        "collapse-restart",
        "hooks",
        "leaked",
        "prepared",
        "cases",
        "values",
    ];
    for name in names {
        insta::assert_snapshot!(format!("quiet-{name}"), plain(name, Verbosity::Quiet));
    }
}

#[test]
fn verbose_console() {
    let names = [
        "verdicts",
        "nasty",
        "sampled",
        "killed",
        "hooks",
        "runner-died",
        "prepared",
        "side-by-side",
        "parallel",
        "cases",
        "carried-cases",
        "faults",
    ];
    for name in names {
        insta::assert_snapshot!(format!("verbose-{name}"), plain(name, Verbosity::Verbose));
    }
}

#[test]
fn text_report() {
    for name in names() {
        let mut report = Vec::new();
        text::write(&mut report, &record(&name)).unwrap();
        insta::assert_snapshot!(format!("text-{name}"), String::from_utf8(report).unwrap());
    }
}

#[test]
fn junit_report() {
    for name in names() {
        insta::assert_snapshot!(format!("junit-{name}"), junit(&name));
    }
}
