//! The functions of the fixture.

use std::sync::{Arc, Mutex, PoisonError};

use rtf_host::{
    HostPlugin, LoadError, PluginKind, Reaction, Session, Step, StepEnd, TestNotification,
    added_fixture,
};
use rtf_model::protocol::{Initialized, Plugin, Subscription};
use rustix::process::Signal;

use crate::injector::Injector;
use crate::settings::{EffectSettings, Settings};
use crate::{fill, pauses, requests, scheduler};

pub(crate) struct FaultsHost {
    session: Session,
    settings: Arc<Settings>,
    /// While it is set up. Shared with the thread that notices the end of the runner.
    injector: Arc<Mutex<Option<Arc<Injector>>>>,
}

impl FaultsHost {
    pub fn new(session: Session) -> Self {
        Self { session, settings: Arc::default(), injector: Arc::default() }
    }

    fn injector(&self) -> Option<Arc<Injector>> {
        self.injector.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn set_up(&mut self) -> StepEnd {
        self.continue_abandoned();
        if self.settings.faults.iter().any(|it| matches!(it.effect, EffectSettings::Memory(_))) {
            fill::be_first_victim();
        }
        let injector = Arc::new(Injector::new(Arc::clone(&self.settings), self.session.clone()));
        if self.settings.has_requested() {
            match requests::listen(&injector) {
                Ok(name) => self.session.provide("socket".to_owned(), name.into()),
                Err(error) => {
                    return StepEnd::Broken(format!("cannot listen for tests: {error}"), None);
                }
            }
        }
        let for_thread = Arc::clone(&injector);
        let started =
            std::thread::Builder::new().spawn(move || scheduler::run(&for_thread)).map(drop);
        if let Err(error) = started {
            return StepEnd::Broken(format!("cannot start a thread: {error}"), None);
        }
        *self.injector.lock().unwrap_or_else(PoisonError::into_inner) = Some(injector);
        StepEnd::Done
    }

    /// Continues the processes that a killed predecessor of this process had stopped.
    fn continue_abandoned(&self) {
        for fault in &self.settings.faults {
            if let EffectSettings::Stop(targets) | EffectSettings::Slow { targets, .. } =
                &fault.effect
            {
                // One that is about to stop does not show it yet.
                for target in targets.find() {
                    let _ = pauses::signal(target.pid, targets, Signal::CONT);
                }
            }
        }
    }

    fn tear_down(&mut self) -> StepEnd {
        let injector = self.injector.lock().unwrap_or_else(PoisonError::into_inner).take();
        injector.into_iter().for_each(|injector| injector.end());
        StepEnd::Done
    }
}

impl HostPlugin for FaultsHost {
    fn describe(&self) -> Initialized {
        added_fixture::describe("faults")
    }

    fn load(&mut self, kind: PluginKind, plugin: &Plugin) -> Result<(), LoadError> {
        self.settings = Arc::new(added_fixture::settings("faults", kind, plugin, Settings::read)?);
        Ok(())
    }

    fn step(&mut self, step: Step) -> StepEnd {
        match step {
            Step::Setup => self.set_up(),
            Step::TearDown => self.tear_down(),
            Step::Check => StepEnd::Done,
            Step::Run => StepEnd::Refused,
        }
    }

    fn subscriptions(&self) -> Vec<Subscription> {
        vec![Subscription::TestStarted, Subscription::TestEnded]
    }

    fn notify(&mut self, notification: TestNotification<'_>) -> StepEnd {
        let Some(injector) = self.injector() else { return StepEnd::Refused };
        let result = match notification {
            TestNotification::Started(started) => injector.start_test(&started.test),
            TestNotification::Ended(ended) => {
                injector.finish_test(ended.test.id, ended.stopped);
                Ok(())
            }
            TestNotification::Finished(_) => Ok(()),
        };
        match result {
            Ok(()) => StepEnd::Done,
            Err(problem) => StepEnd::Broken(problem, None),
        }
    }

    fn closer(&self) -> Option<Reaction> {
        let injector = Arc::clone(&self.injector);
        Some(Box::new(move |_| {
            let injector = injector.lock().unwrap_or_else(PoisonError::into_inner).clone();
            injector.into_iter().for_each(|injector| injector.abandon());
        }))
    }
}
