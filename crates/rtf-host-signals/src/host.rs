//! The functions of the fixture.

use std::sync::Arc;
use std::time::{Duration, Instant};

use rtf_host::{
    HostPlugin, LoadError, PluginKind, Session, Step, StepEnd, TestNotification, added_fixture,
};
use rtf_model::protocol::{Initialized, Plugin, Subscription, TestReportedParams};

use crate::settings::Settings;
use crate::watch::Watch;

/// How long set-up waits for the first line of each program: less than its default limit, so
/// that the reason contains the program.
const FIRST_LINE_LIMIT: Duration = Duration::from_secs(50);
/// The interval at which set-up looks for them.
const POLL: Duration = Duration::from_millis(2);

pub(crate) struct SignalsHost {
    session: Session,
    settings: Arc<Settings>,
    watch: Option<Watch>,
}

impl SignalsHost {
    pub fn new(session: Session) -> Self {
        Self { session, settings: Arc::default(), watch: None }
    }

    fn set_up(&mut self) -> StepEnd {
        match Watch::start(&self.settings, &self.session) {
            Ok(watch) => self.watch = Some(watch),
            Err(problem) => return StepEnd::Broken(problem, None),
        }
        let deadline = Instant::now() + FIRST_LINE_LIMIT;
        while let Some(watch) = &self.watch {
            if watch.has_collapsed() {
                return StepEnd::Stopped;
            }
            if watch.is_ready() {
                break;
            }
            if Instant::now() >= deadline {
                let text = format!(
                    "nothing was written within {FIRST_LINE_LIMIT:?} by {}; if it writes only \
                     while a test runs, write `wait=\"false\"` in the suite",
                    watch.missing()
                );
                return StepEnd::Broken(text, None);
            }
            if self.session.wait(POLL) {
                return StepEnd::Stopped;
            }
        }
        StepEnd::Done
    }

    fn tear_down(&mut self) -> StepEnd {
        self.watch.take().into_iter().for_each(Watch::stop);
        StepEnd::Done
    }
}

impl HostPlugin for SignalsHost {
    fn describe(&self) -> Initialized {
        added_fixture::describe("signals")
    }

    fn load(&mut self, kind: PluginKind, plugin: &Plugin) -> Result<(), LoadError> {
        self.settings = Arc::new(added_fixture::settings("signals", kind, plugin, Settings::read)?);
        Ok(())
    }

    fn step(&mut self, step: Step) -> StepEnd {
        match step {
            Step::Setup => self.set_up(),
            Step::TearDown => self.tear_down(),
            Step::Check if self.watch.as_ref().is_some_and(Watch::has_collapsed) => {
                StepEnd::Stopped
            }
            Step::Check => StepEnd::Done,
            Step::Run => StepEnd::Refused,
        }
    }

    fn subscriptions(&self) -> Vec<Subscription> {
        vec![Subscription::TestStarted, Subscription::TestEnded, Subscription::TestReported]
    }

    fn reported(&mut self, reported: TestReportedParams) {
        if let Some(watch) = &self.watch {
            watch.reported(reported.test, reported.report);
        }
    }

    fn notify(&mut self, notification: TestNotification<'_>) -> StepEnd {
        let Some(watch) = &self.watch else { return StepEnd::Refused };
        let result = match notification {
            TestNotification::Started(started) => watch.start_test(&started.test),
            TestNotification::Ended(ended) => watch.finish_test(ended.test.id, ended.stopped),
            TestNotification::Finished(_) => Ok(()),
        };
        match result {
            Ok(()) if watch.has_collapsed() => StepEnd::Stopped,
            Ok(()) => StepEnd::Done,
            Err(problem) => StepEnd::Broken(problem, None),
        }
    }
}
