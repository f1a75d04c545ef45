//! The stored event streams, and what every reporter makes of them.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use rtf_model::{Event, LineSealer, Record};
use rtf_report::console::{Console, ConsoleOptions, TestCommands};
use rtf_report::journal::{self, Stored};
use rtf_report::markdown::MarkdownOptions;

/// The one stream that ends as a killed runner leaves it.
pub const KILLED: &str = "killed";

pub fn stream_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/streams").join(format!("{name}.jsonl"))
}

/// The names of all stored streams.
pub fn names() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/streams");
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let stem = |path: PathBuf| path.file_stem().unwrap().to_str().unwrap().to_owned();
    let mut names: Vec<_> = files.map(stem).collect();
    names.sort();
    assert!(names.iter().any(|name| name == KILLED), "the streams are where they are looked for");
    names
}

pub fn events(name: &str) -> (Vec<Event>, Stored) {
    let mut events = Vec::new();
    let stored = journal::read_with(&stream_path(name), |event, _| {
        events.push(event.clone());
        Ok(())
    });
    (events, stored.unwrap())
}

pub fn record(name: &str) -> Record {
    journal::read(&stream_path(name)).unwrap().record
}

/// A stored stream as a journal with check values.
pub fn sealed(name: &str) -> Vec<u8> {
    let (mut sealer, mut journal) = (LineSealer::default(), Vec::new());
    for event in events(name).0 {
        let start = journal.len();
        serde_json::to_writer(&mut journal, &event).unwrap();
        sealer.seal(&mut journal, start);
    }
    journal
}

/// A place to write to that can be read afterwards.
#[derive(Clone, Default)]
pub struct Paper(Arc<Mutex<Vec<u8>>>);

impl Write for Paper {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Paper {
    pub fn text(&self) -> String {
        String::from_utf8(self.0.lock().unwrap().clone()).unwrap()
    }
}

/// What the console says of a stream, with its colour codes.
pub fn console(name: &str, options: ConsoleOptions) -> String {
    let paper = Paper::default();
    let mut console = Console::new(Box::new(paper.clone()), options);
    journal::replay(&stream_path(name), &mut console).unwrap();
    paper.text()
}

pub fn junit(name: &str) -> String {
    let mut xml = Vec::new();
    let folder = Path::new("rtf-results/run");
    rtf_report::junit::write(&mut xml, &record(name), Some(folder)).unwrap();
    String::from_utf8(xml).unwrap()
}

/// Options of a summary without names of this machine.
pub fn markdown_options() -> MarkdownOptions<'static> {
    MarkdownOptions {
        repository: None,
        dir: Some(Path::new("rtf-results/run")),
        url: Some("https://ci.example/results/7"),
        commands: TestCommands::without_replay(Box::new(rtf_report::console::rerun_suite)),
    }
}
