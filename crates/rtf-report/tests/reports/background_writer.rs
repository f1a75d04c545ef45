//! Console output without a reader.

use std::io::{self, Write};
use std::sync::mpsc::{self, Receiver};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use crate::support::*;
use rtf_model::{EventKind, Record};
use rtf_report::Reporter;
use rtf_report::background_writer::BackgroundWriter;
use rtf_report::console::{Console, ConsoleOptions, Verbosity};

/// Paper that blocks until it is released.
struct Blocked {
    open: Receiver<()>,
    paper: Paper,
}

impl Write for Blocked {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // From then on, the other end is gone.
        let _ = self.open.recv();
        self.paper.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn options(verbosity: Verbosity) -> ConsoleOptions {
    ConsoleOptions { verbosity, progress: false, ..ConsoleOptions::default() }
}

/// A million reports of one test must not fill the memory, and no verdict may be missing.
#[test]
fn a_console_that_nobody_reads_leaves_out_detail_and_says_how_much() {
    let (open, blocked) = mpsc::channel();
    let paper = Paper::default();
    let outlet =
        BackgroundWriter::new(Box::new(Blocked { open: blocked, paper: paper.clone() })).unwrap();
    let mut console = Console::over(&outlet, options(Verbosity::Verbose));
    let mut record = Record::default();
    let mut flooded = false;
    for event in &events("verdicts").0 {
        record.apply(event);
        console.event(event, &record).unwrap();
        if matches!(event.kind, EventKind::Message { .. }) && !flooded {
            flooded = true;
            (0..1_000_000).for_each(|_| console.event(event, &record).unwrap());
        }
    }
    assert!(flooded && outlet.is_full());
    drop(open);
    console.finish(&record).unwrap();
    let text = anstream::adapter::strip_str(&paper.text()).to_string();
    assert!(text.len() < 6 * 1024 * 1024, "{} bytes", text.len());
    let told = text.lines().find_map(|line| line.trim_start().strip_prefix("left out")).unwrap();
    let left_out: usize = told.split_whitespace().next().unwrap().parse().unwrap();
    let kept = text.lines().count();
    assert!(left_out < 1_000_000 && left_out + kept > 1_000_000, "{left_out} of {kept}");
    let normal =
        anstream::adapter::strip_str(&self::console("verdicts", options(Verbosity::Normal)))
            .to_string();
    for line in normal.lines().filter(|line| line.contains("passed") || line.contains("failed")) {
        assert!(text.contains(line), "{line}");
    }
}

#[test]
fn a_reader_that_is_given_up_is_not_waited_for() {
    let (open, blocked) = mpsc::channel();
    let paper = Paper::default();
    let mut outlet =
        BackgroundWriter::new(Box::new(Blocked { open: blocked, paper: paper.clone() })).unwrap();
    outlet.write_all(b"never read").unwrap();
    let waiting = thread::spawn({
        let mut outlet = outlet.clone();
        move || outlet.flush()
    });
    outlet.abandon();
    waiting.join().unwrap().unwrap();
    assert!(!outlet.is_full() && paper.text().is_empty());
    drop(open);
}

/// A stream of data leaves nothing out, and its writer waits.
#[test]
fn a_stream_is_written_whole() {
    let (open, blocked) = mpsc::channel();
    let paper = Paper::default();
    let outlet =
        BackgroundWriter::new(Box::new(Blocked { open: blocked, paper: paper.clone() })).unwrap();
    let mut stream = outlet.for_stream();
    let writer = thread::spawn(move || {
        (0..1000).for_each(|_| stream.write_all(&[b'x'; 16 * 1024]).unwrap());
        stream.flush().unwrap();
    });
    drop(open);
    writer.join().unwrap();
    assert_eq!(paper.text().len(), 1000 * 16 * 1024);
}

/// Nothing else may be drawn in a line.
#[test]
fn a_line_is_written_when_it_is_complete() {
    let paper = Paper::default();
    let mut outlet = BackgroundWriter::new(Box::new(paper.clone())).unwrap();
    outlet.write_all(b"one\ntwo").unwrap();
    let deadline = Instant::now() + Duration::from_secs(30);
    while paper.text() != "one\n" && Instant::now() < deadline {
        thread::sleep(Duration::from_millis(1));
    }
    thread::sleep(Duration::from_millis(20));
    assert_eq!(paper.text(), "one\n");
    outlet.write_all(b" and a half\nthree").unwrap();
    outlet.flush().unwrap();
    assert_eq!(paper.text(), "one\ntwo and a half\nthree");
    // A line without an end does not fill the memory.
    outlet.write_all(&[b'x'; 100 * 1024]).unwrap();
    while paper.text().len() < 100 * 1024 && Instant::now() < deadline {
        thread::sleep(Duration::from_millis(1));
    }
    assert!(paper.text().ends_with("xxx"));
}

/// Keeps what is written at once.
#[derive(Clone, Default)]
struct Writes(Arc<Mutex<Vec<String>>>);

impl Write for Writes {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap().push(String::from_utf8(bytes.to_vec()).unwrap());
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A progress bar is drawn between writes, and must not be drawn between a question and its
/// choices.
#[test]
fn the_lines_of_an_event_are_written_together() {
    let writes = Writes::default();
    let mut outlet = BackgroundWriter::new(Box::new(writes.clone())).unwrap();
    let mut console = Console::over(&outlet, options(Verbosity::Verbose));
    let mut record = Record::default();
    for event in &mut events("verdicts").0 {
        if let EventKind::Message { message, .. } = &mut event.kind {
            message.text = "one of many lines\n".repeat(1000);
        }
        record.apply(event);
        console.event(event, &record).unwrap();
        console.idle(&record).unwrap();
        outlet.flush().unwrap();
        let written = std::mem::take(&mut *writes.0.lock().unwrap());
        assert!(written.len() <= 1, "{} writes for {event:?}", written.len());
        let lines = written.concat().lines().count();
        assert!(lines >= 1000 || !matches!(event.kind, EventKind::Message { .. }), "{lines}");
    }
}
