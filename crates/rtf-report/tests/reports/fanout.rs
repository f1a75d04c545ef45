//! The thread between a run and its reporters.

use std::path::PathBuf;
use std::sync::mpsc::{self, Receiver, Sender};

use crate::support::*;
use rtf_model::{Event, Record, Source, TestId};
use rtf_report::{Fanout, ReportError, Reporter};

#[derive(Debug, PartialEq, Eq)]
enum Call {
    Event(u64),
    Idle,
    Finish,
}

/// Tells what it was called with; fails at one event.
struct Probe {
    calls: Sender<Call>,
    fails_at: Option<u64>,
}

impl Probe {
    fn new(fails_at: Option<u64>) -> (Box<Self>, Receiver<Call>) {
        let (calls, receiver) = mpsc::channel();
        (Box::new(Self { calls, fails_at }), receiver)
    }
}

impl Reporter for Probe {
    fn event(&mut self, event: &Event, record: &Record) -> Result<(), ReportError> {
        assert_eq!(record.events, event.seq + 1, "the record already contains the event");
        self.calls.send(Call::Event(event.seq)).unwrap();
        if self.fails_at == Some(event.seq) {
            let source = std::io::ErrorKind::StorageFull.into();
            return Err(ReportError { what: "a probe", path: PathBuf::from("there"), source });
        }
        Ok(())
    }

    fn idle(&mut self, _record: &Record) -> Result<(), ReportError> {
        self.calls.send(Call::Idle).unwrap();
        Ok(())
    }

    fn finish(&mut self, _record: &Record) -> Result<(), ReportError> {
        self.calls.send(Call::Finish).unwrap();
        Ok(())
    }
}

fn calls(receiver: &Receiver<Call>) -> Vec<Call> {
    receiver.try_iter().filter(|call| *call != Call::Idle).collect()
}

fn all_of(events: &[Event]) -> Vec<Call> {
    events.iter().map(|event| Call::Event(event.seq)).chain([Call::Finish]).collect()
}

#[test]
fn each_reporter_gets_each_event_and_one_that_fails_does_not_stop_the_others() {
    let (events, stored) = events("verdicts");
    let (failing, of_failing) = Probe::new(Some(3));
    let (working, of_working) = Probe::new(None);
    let fanout = Fanout::start(vec![failing, working]).unwrap();
    events.iter().for_each(|event| fanout.send(event.clone()));
    let finished = fanout.join();
    assert_eq!(finished.record.totals(), stored.record.totals());
    assert_eq!(calls(&of_working), all_of(&events));
    assert_eq!(calls(&of_failing), (0..4).map(Call::Event).collect::<Vec<_>>());
    let errors: Vec<_> = finished.errors.iter().map(ToString::to_string).collect();
    assert_eq!(errors, ["cannot write a probe to `there`"]);
}

#[test]
fn a_reporter_is_told_when_nothing_is_waiting() {
    let (events, _) = events("silent");
    let (probe, calls) = Probe::new(None);
    let fanout = Fanout::start(vec![probe]).unwrap();
    assert_eq!(calls.recv().unwrap(), Call::Idle, "before the first event");
    fanout.send(events[0].clone());
    assert_eq!(calls.recv().unwrap(), Call::Event(0));
    assert_eq!(calls.recv().unwrap(), Call::Idle, "after it");
    assert_eq!(fanout.join().record.events, 1);
}

#[test]
#[should_panic(expected = "event 2: expected number 1")]
fn a_run_that_breaks_the_order_is_noticed() {
    let (events, _) = events("silent");
    let fanout = Fanout::start(Vec::new()).unwrap();
    fanout.send(events[0].clone());
    fanout.send(events[2].clone());
    drop(fanout.join());
}

/// Panics at the first event.
struct Panics;

impl Reporter for Panics {
    fn event(&mut self, _event: &Event, _record: &Record) -> Result<(), ReportError> {
        panic!("a reporter that is wrong")
    }
}

#[test]
fn a_reporter_that_panics_stops_neither_the_others_nor_the_run() {
    let (events, stored) = events("verdicts");
    let (working, of_working) = Probe::new(None);
    let fanout = Fanout::start(vec![Box::new(Panics), working]).unwrap();
    let handle = fanout.handle();
    events.iter().for_each(|event| fanout.send(event.clone()));
    let tests = (0..stored.record.tests.len()).map(|test| TestId(u32::try_from(test).unwrap()));
    let sources: Vec<_> = tests.map(Source::Test).collect();
    while calls_until_last(&of_working, &events) {}
    assert!(sources.iter().all(|source| handle.backlog(*source) == 0));
    drop(handle);
    let finished = fanout.join();
    assert_eq!(finished.record.totals(), stored.record.totals());
    let errors: Vec<_> = finished.errors.iter().map(ToString::to_string).collect();
    assert_eq!(errors, ["cannot write a report to `its place`"]);
}

/// Whether the last event is still to come.
fn calls_until_last(calls: &Receiver<Call>, events: &[Event]) -> bool {
    let last = events.last().map(|event| Call::Event(event.seq));
    Some(calls.recv().unwrap()) != last
}

/// Each write fails, the error is reported once, and the run continues.
#[test]
#[cfg(target_os = "linux")]
fn what_cannot_be_written_is_told_once() {
    let Ok(full) = std::fs::OpenOptions::new().write(true).open("/dev/full") else {
        panic!("Linux has /dev/full")
    };
    let console = rtf_report::console::Console::new(
        Box::new(full),
        rtf_report::console::ConsoleOptions::default(),
    );
    let fanout = Fanout::start(vec![Box::new(console)]).unwrap();
    events("verdicts").0.into_iter().for_each(|event| fanout.send(event));
    let finished = fanout.join();
    let errors: Vec<_> = finished.errors.iter().map(ToString::to_string).collect();
    assert_eq!(errors, ["cannot write what happens to `standard output`"]);
    assert!(finished.record.is_complete());
}

/// A full disk is reported when it is full, not hours later.
#[test]
fn what_cannot_be_written_is_said_at_once() {
    let (events, _) = events("verdicts");
    let (failing, _calls) = Probe::new(Some(3));
    let paper = Paper::default();
    let options = rtf_report::console::ConsoleOptions::default();
    let console = rtf_report::console::Console::new(Box::new(paper.clone()), options);
    let fanout = Fanout::start(vec![failing, Box::new(console)]).unwrap();
    events.into_iter().for_each(|event| fanout.send(event));
    assert!(fanout.join().record.is_complete());
    let text = paper.text();
    let told = text.find("a probe `there`: no storage space").expect("it is said");
    let first_test = text.find("passed").expect("a test passed");
    assert!(told < first_test, "{text}");
}
