//! What other programs read: TAP, annotations, sections, the event stream.

use std::path::Path;

use crate::support::*;
use rtf_report::console::{Console, ConsoleOptions};
use rtf_report::event_stream::EventStream;
use rtf_report::gitlab::Sections;
use rtf_report::tap::{self, TapStream};
use rtf_report::{Reporter, code_quality, github, journal};

fn written(write: impl FnOnce(&mut Vec<u8>)) -> String {
    let mut bytes = Vec::new();
    write(&mut bytes);
    String::from_utf8(bytes).unwrap()
}

fn replayed(name: &str, make: impl FnOnce(Paper) -> Box<dyn Reporter>) -> String {
    let paper = Paper::default();
    journal::replay(&stream_path(name), make(paper.clone()).as_mut()).unwrap();
    paper.text()
}

#[test]
fn tap_report() {
    for name in names() {
        let report = written(|out| tap::write(out, &record(&name)).unwrap());
        insta::assert_snapshot!(format!("tap-{name}"), report);
    }
}

#[test]
fn tap_while_the_run_goes_on_is_the_report() {
    for name in names() {
        let live = replayed(&name, |paper| Box::new(TapStream::new(Box::new(paper))));
        assert_eq!(live, written(|out| tap::write(out, &record(&name)).unwrap()), "{name}");
    }
}

#[test]
fn a_test_is_told_when_it_is_over_not_when_the_run_is() {
    let (events, _) = events("verdicts");
    let paper = Paper::default();
    let mut live = TapStream::new(Box::new(paper.clone()));
    let mut record = rtf_model::Record::default();
    for event in &events {
        record.apply(event);
        live.event(event, &record).unwrap();
        live.idle(&record).unwrap();
        let told = paper.text().matches("\n    ok ").count()
            + paper.text().matches("\n    not ok ").count();
        assert_eq!(told, record.totals().done() as usize, "after event {}", event.seq);
    }
}

#[test]
fn annotations_for_github() {
    for name in names() {
        let report = written(|out| github::write(out, &record(&name), None).unwrap());
        assert!(report.lines().all(|line| line.starts_with("::")), "{name}: one line each");
        insta::assert_snapshot!(format!("github-{name}"), report);
    }
}

#[test]
fn code_quality_for_gitlab() {
    for name in names() {
        let report = written(|out| code_quality::write(out, &record(&name), None).unwrap());
        let issues: Vec<serde_json::Value> = serde_json::from_str(&report).unwrap();
        let mut prints: Vec<_> =
            issues.iter().map(|issue| issue["fingerprint"].as_str().unwrap()).collect();
        prints.sort_unstable();
        prints.dedup();
        assert_eq!(prints.len(), issues.len(), "{name}: each has its own fingerprint");
        insta::assert_snapshot!(format!("code-quality-{name}"), report);
    }
}

#[test]
fn files_are_named_from_the_repositorys_root() {
    let folder = record("verdicts").run.unwrap().working_dir;
    let above = Path::new(&folder).parent().unwrap();
    let report = written(|out| github::write(out, &record("verdicts"), Some(above)).unwrap());
    let inside = format!("file={}/", Path::new(&folder).file_name().unwrap().to_str().unwrap());
    assert!(report.contains(&inside), "{report}");
    let elsewhere = Some(Path::new("/nowhere"));
    let report = written(|out| github::write(out, &record("verdicts"), elsewhere).unwrap());
    assert!(!report.contains("file="), "{report}");
}

#[test]
fn sections_for_gitlab() {
    for name in ["verdicts", "collapse-restart", "killed", "side-by-side"] {
        let text = replayed(name, |paper| {
            let console = Console::new(
                Box::new(anstream::StripStream::new(
                    Box::new(paper.clone()) as Box<dyn std::io::Write + Send>
                )),
                ConsoleOptions::default(),
            );
            Box::new(Sections::around(Box::new(console), Box::new(paper)))
        });
        insta::assert_snapshot!(
            format!("gitlab-{name}"),
            text.replace('\x1b', "<ESC>").replace('\r', "<CR>")
        );
    }
}

#[test]
fn the_event_stream_is_the_journal() {
    for name in names() {
        let text = replayed(&name, |paper| Box::new(EventStream::new(Box::new(paper))));
        let written: Vec<rtf_model::Event> =
            text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        assert_eq!(written, events(&name).0, "{name}");
        assert!(text.ends_with('\n'), "{name}: whole lines");
    }
}
