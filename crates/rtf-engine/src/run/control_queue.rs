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
    /// Creates the queue of a suite that starts, and returns an earlier request to skip the
    /// suite. Earlier requests to stop its tests are ignored.
    pub fn new(mut controls: Controls, suite: &SuitePlan) -> (Self, Option<Input>) {
        let earlier = controls.borrow_and_update().clone();
        let skip = earlier.iter().find_map(|control| match control {
            Control::SkipSuite { suite: id, by } if *id == suite.id => {
                Some(Input::Skip(by.clone()))
            }
            _ => None,
        });
        (Self { controls, handled: earlier.len() }, skip)
    }

    /// Waits for the next request that concerns this suite. Never returns once all senders
    /// were dropped.
    pub async fn next(&mut self, suite: &SuitePlan) -> Input {
        loop {
            while let Some(control) = self.pop() {
                match control {
                    Control::SkipSuite { suite: id, by } if id == suite.id => {
                        return Input::Skip(by);
                    }
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

    fn pop(&mut self) -> Option<Control> {
        let control = self.controls.borrow_and_update().get(self.handled).cloned();
        self.handled += usize::from(control.is_some());
        control
    }
}
