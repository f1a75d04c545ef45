//! The requests that a suite has not handled yet.

use crate::control::{Control, Controls};
use rtf_plan::plan::SuitePlan;

use super::machine::Input;

/// The requests that a suite has not handled yet.
#[derive(Debug)]
pub struct ControlQueue {
    controls: Controls,
    handled: usize,
}

impl ControlQueue {
    /// Creates the queue of a suite that starts, and returns earlier requests. Those to stop its
    /// tests, and answers, are ignored.
    pub fn new(mut controls: Controls, suite: &SuitePlan) -> (Self, Vec<Input>) {
        let earlier = controls.borrow_and_update().clone();
        let handled = earlier.len();
        let inputs = earlier.into_iter().filter_map(|control| input(control, suite));
        let is_of_test = |input: &Input| matches!(input, Input::StopTest(..) | Input::Answer(..));
        let inputs = inputs.filter(|input| !is_of_test(input)).collect();
        (Self { controls, handled }, inputs)
    }

    /// Waits for the next request that concerns this suite. Never returns once all senders
    /// were dropped.
    pub async fn next(&mut self, suite: &SuitePlan) -> Input {
        loop {
            while let Some(control) = self.pop() {
                if let Some(input) = input(control, suite) {
                    return input;
                }
            }
            if self.controls.changed().await.is_err() {
                std::future::pending::<()>().await;
            }
        }
    }

    fn pop(&mut self) -> Option<Control> {
        let control = self.controls.borrow_and_update().get(self.handled).cloned();
        self.handled += usize::from(control.is_some());
        control
    }
}

/// The input of a request that concerns this suite.
fn input(control: Control, suite: &SuitePlan) -> Option<Input> {
    match control {
        Control::SkipSuite { suite: id, by } => (id == suite.id).then_some(Input::Skip(by)),
        Control::StopTest { test, by } => {
            let is_of_suite = suite.tests.iter().any(|plan| plan.id == test);
            is_of_suite.then_some(Input::StopTest(test, by))
        }
        Control::Answer { test, reply } => {
            let is_of_suite = suite.tests.iter().any(|plan| plan.id == test);
            is_of_suite.then_some(Input::Answer(test, reply))
        }
        Control::Episode(episode) => Some(Input::Episode(Some(episode))),
        Control::EndOfEpisodes => Some(Input::Episode(None)),
    }
}
