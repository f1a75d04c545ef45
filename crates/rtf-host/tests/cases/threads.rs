//! Cases on several threads.

use std::sync::mpsc::channel;

use rtf_host::{CaseEnd, Session, Step, StepEnd};
use serde_json::json;

use crate::script_host::{Runner, all, case, done, in_run, report};

#[test]
fn a_thread_without_a_case_reports_in_that_of_the_test() {
    let (lines, _) = all(in_run!(session, {
        case(session, "main", || {
            std::thread::scope(|scope| {
                scope.spawn(|| {
                    report(session, "a");
                    case(session, "own", || {
                        report(session, "b");
                        CaseEnd::Done
                    });
                    report(session, "c");
                });
            });
            CaseEnd::Done
        });
    }));
    let expected = [
        "start 1 in -: main",
        "report in 1: a",
        "start 2 in -: own",
        "report in 2: b",
        "end 2",
        "report in 1: c",
        "end 1",
    ];
    assert_eq!(lines, expected);
}

#[test]
fn numbers_of_cases_on_several_threads_arrive_in_order() {
    let (lines, _) = all(in_run!(session, {
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| (0..200).for_each(|number| done(session, &number.to_string())));
            }
        });
    }));
    let number = |line: &String| line.strip_prefix("start ")?.split(' ').next()?.parse().ok();
    let numbers: Vec<u32> = lines.iter().filter_map(number).collect();
    assert_eq!(numbers, (1..=800).collect::<Vec<_>>());
    assert_eq!(lines.len(), 2 * 800);
}

/// A thread that outlives its test finishes its case during the next test.
#[test]
fn a_case_of_an_earlier_test_is_not_reported() {
    use std::sync::Mutex;
    static FINISH: Mutex<Option<std::sync::mpsc::Sender<()>>> = Mutex::new(None);
    static FINISHED: Mutex<Option<std::sync::mpsc::Receiver<()>>> = Mutex::new(None);
    let mut runner = Runner::start(in_run!(session, {
        let finish = FINISH.lock().unwrap().take();
        if let Some(finish) = finish {
            finish.send(()).unwrap();
            FINISHED.lock().unwrap().take().unwrap().recv().unwrap();
            done(session, "second");
        } else {
            let ((finish, wait), (ended, finished)) = (channel(), channel());
            let (opened, is_open) = channel();
            let session = session.clone();
            std::thread::spawn(move || {
                case(&session, "first", || {
                    opened.send(()).unwrap();
                    wait.recv().unwrap();
                    CaseEnd::Done
                });
                ended.send(()).unwrap();
            });
            is_open.recv().unwrap();
            *FINISH.lock().unwrap() = Some(finish);
            *FINISHED.lock().unwrap() = Some(finished);
        }
    }));
    let (lines, _) = runner.ask("run-test", &json!([]));
    assert_eq!(lines, ["start 1 in -: first"]);
    let (lines, _) = runner.ask("run-test", &json!([]));
    assert_eq!(lines, ["start 1 in -: second", "end 1"]);
}
