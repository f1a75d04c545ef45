//! Requests to a run while it is running: signals, and the browser.

use std::time::Duration;

use rtf_engine::run::{Control, QuestionReply, Stop, StopLevel};
use rtf_model::{SuiteId, TestId};
use rtf_web::AnswerRequest;
use tokio::sync::watch;

/// The origin of a request from the browser, in verdicts.
const BROWSER: &str = "a person, in the browser";

/// Passes requests to a run.
#[derive(Debug)]
pub struct ControlChannels {
    pub stops: watch::Sender<Option<Stop>>,
    pub controls: watch::Sender<Vec<Control>>,
    pub shutdown_timeout: Duration,
}

impl ControlChannels {
    pub fn new(shutdown_timeout: Duration) -> Self {
        let (stops, controls) = (watch::channel(None).0, watch::channel(Vec::new()).0);
        Self { stops, controls, shutdown_timeout }
    }

    /// Ends the run, unless it is already ending: an earlier signal requests the same or more.
    pub fn stop(&self, reason: String) {
        self.stops.send_if_modified(|stop| {
            let is_first = stop.is_none();
            if is_first {
                let (level, limit) = (StopLevel::TearDown, self.shutdown_timeout);
                *stop = Some(Stop { level, reason, limit });
            }
            is_first
        });
    }

    /// Whether a signal has ended the run.
    pub fn is_interrupted(&self) -> bool {
        self.stops.borrow().as_ref().is_some_and(|stop| stop.reason != BROWSER)
    }
}

impl rtf_web::RunControl for ControlChannels {
    fn stop_run(&self) {
        self.stop(BROWSER.to_owned());
    }

    fn stop_test(&self, test: TestId) {
        let by = BROWSER.to_owned();
        self.controls.send_modify(|controls| controls.push(Control::StopTest { test, by }));
    }

    fn answer(&self, answer: AnswerRequest) {
        let AnswerRequest { test, question, answer, by } = answer;
        let reply = QuestionReply { question, answer: Some(answer), by };
        self.controls.send_modify(|controls| controls.push(Control::Answer { test, reply }));
    }

    fn skip_suite(&self, suite: SuiteId) {
        let by = BROWSER.to_owned();
        self.controls.send_modify(|controls| controls.push(Control::SkipSuite { suite, by }));
    }
}
