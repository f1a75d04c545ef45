//! What a person asks of a run while it goes on, beside its end.

use rtf_model::{SuiteId, TestId};
use tokio::sync::watch;

use super::machine::Input;
use rtf_plan::plan::SuitePlan;

/// What is asked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Control {
    /// Stop a test that runs, and skip what is left of its repetitions.
    StopTest {
        /// The test.
        test: TestId,
        /// Who asks, in words.
        by: String,
    },
    /// Stop a suite's running test and skip the rest of the suite.
    SkipSuite {
        /// The suite.
        suite: SuiteId,
        /// Who asks, in words.
        by: String,
    },
}

/// Everything that was asked in a run, the oldest first.
pub type Controls = watch::Receiver<Vec<Control>>;

/// What of it a suite has not seen yet.
#[derive(Debug)]
pub struct Unseen {
    controls: Controls,
    seen: usize,
}

impl Unseen {
    /// For a suite that starts: what was asked of its tests before cannot mean
    /// this start, what was asked of the suite does.
    pub fn at_start(mut controls: Controls, suite: &SuitePlan) -> (Self, Option<Input>) {
        let asked = controls.borrow_and_update().clone();
        let skip = asked.iter().find_map(|control| match control {
            Control::SkipSuite { suite: of, by } if *of == suite.id => Some(skip(by)),
            _ => None,
        });
        (Self { controls, seen: asked.len() }, skip)
    }

    /// Waits for something new that concerns this suite; for ever when nobody
    /// can ask any more.
    pub async fn next(&mut self, suite: &SuitePlan) -> Input {
        loop {
            while let Some(control) = self.take() {
                match control {
                    Control::SkipSuite { suite: of, by } if of == suite.id => return skip(&by),
                    Control::StopTest { test, by }
                        if suite.tests.iter().any(|plan| plan.id == test) =>
                    {
                        return Input::StopTest(test, by);
                    }
                    _ => {}
                }
            }
            if self.controls.changed().await.is_err() {
                std::future::pending::<()>().await;
            }
        }
    }

    fn take(&mut self) -> Option<Control> {
        let control = self.controls.borrow_and_update().get(self.seen).cloned();
        self.seen += usize::from(control.is_some());
        control
    }
}

fn skip(by: &str) -> Input {
    Input::Skip(by.to_owned())
}
