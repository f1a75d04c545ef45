//! The summary in Markdown.

use rtf_model::{EventKind, Record};
use rtf_report::{journal, markdown};

use crate::support::*;

fn summary(record: &Record) -> String {
    let mut page = Vec::new();
    markdown::write(&mut page, record, &markdown_options()).unwrap();
    String::from_utf8(page).unwrap()
}

#[test]
fn markdown_summary() {
    for name in names() {
        let (record, page) = (record(&name), summary(&record(&name)));
        let mark = if record.is_green() { "## ✅ PASSED" } else { "## ❌ " };
        assert!(page.starts_with(mark), "{name}: {page}");
        insta::assert_snapshot!(format!("markdown-{name}"), page);
    }
}

#[test]
fn a_damaged_run_says_so_first() {
    let green = names().into_iter().find(|name| record(name).is_green()).unwrap();
    let mut bytes = sealed(&green);
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    let record = journal::read_from("damaged".as_ref(), bytes.as_slice()).unwrap().record;
    let page = summary(&record);
    let start = "## ❌ DAMAGED (the journal cannot be trusted)\n\n**This run is not green:** <code>the journal";
    assert!(page.starts_with(start), "{page}");
    assert!(!page.contains("✅"), "{page}");
}

/// GitHub accepts 1 MiB per step.
#[test]
fn the_length_is_limited() {
    let (events, _) = events("verdicts");
    let mut record = Record::default();
    let long = "`<b>&|*_\n".repeat(500);
    for mut event in events {
        match &mut event.kind {
            EventKind::Message { message, .. } => message.text.clone_from(&long),
            EventKind::Output(output) => output.text.clone_from(&long),
            EventKind::TestFinished(finished) => {
                finished.reason.iter_mut().for_each(|reason| *reason = long.replace('\n', ""));
            }
            _ => {}
        }
        record.apply(&event);
    }
    let tests = record.tests.clone();
    while record.tests.len() < 2_000 {
        record.tests.extend_from_slice(&tests);
    }
    let page = summary(&record);
    assert!(page.len() < 1 << 20, "{} bytes", page.len());
    assert!(page.contains("characters left out"), "long lines are cut");
    assert!(page.contains("lines left out"), "long texts are cut");
    assert!(page.contains(" more tests without details:"), "further tests are listed");
    assert!(page.contains(" more tests\n"), "the rest is counted");
}
