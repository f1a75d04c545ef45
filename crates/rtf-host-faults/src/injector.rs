//! The running tests and the faults that last.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use rtf_host::Session;
use rtf_model::protocol::TestAttempt;
use rtf_model::{FaultInjected, Finding, FindingSeverity, Message, MessageKind, TestId};

use crate::clock::FaultClock;
use crate::lasting::{self, Effect};
use crate::pauses::Pauses;
use crate::running_test::RunningTest;
use crate::settings::{FaultSettings, Settings};

/// What the threads of the fixture share.
#[derive(Debug)]
pub(crate) struct Injector {
    session: Session,
    pub settings: Arc<Settings>,
    pub clock: FaultClock,
    pub state: Mutex<InjectorState>,
    /// Lock order: after the state.
    pub pauses: Mutex<Pauses>,
    /// Notified when the state has changed.
    pub changed: Condvar,
}

#[derive(Debug, Default)]
pub(crate) struct InjectorState {
    pub tests: Vec<RunningTest>,
    pub faults: Vec<ActiveFault>,
    /// The fixture was torn down.
    pub has_ended: bool,
}

/// A fault of a test that is being injected, or lasts.
#[derive(Debug)]
pub(crate) struct ActiveFault {
    test: TestId,
    fault: usize,
    /// Its injection is no longer needed.
    is_cancelled: Arc<AtomicBool>,
    /// Its effect, once it has begun.
    pub effect: Option<Effect>,
    /// When it is removed, on the suite's clock.
    pub until: Option<f64>,
}

/// Why a fault was not injected.
#[derive(Debug)]
pub(crate) enum NotInjected {
    Failed(String),
    TestEnded,
}

impl Injector {
    pub fn new(settings: Arc<Settings>, session: Session) -> Self {
        let clock = FaultClock::new(settings.has_clock);
        let (state, pauses, changed) = (Mutex::default(), Mutex::default(), Condvar::new());
        Self { session, settings, clock, state, pauses, changed }
    }

    pub fn state(&self) -> MutexGuard<'_, InjectorState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn pauses(&self) -> MutexGuard<'_, Pauses> {
        self.pauses.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn settings_of(&self, fault: usize) -> &FaultSettings {
        &self.settings.faults[fault]
    }

    fn now(&self) -> Result<f64, String> {
        // The file is replaced while it is read, if at all.
        let now = self.clock.now().or_else(|| self.clock.now());
        now.ok_or_else(|| "the suite's clock shows no time".to_owned())
    }

    /// A test is about to start.
    pub fn start_test(&self, test: &TestAttempt) -> Result<(), String> {
        let running = RunningTest::new(test, self.now()?, &self.settings);
        self.state().tests.push(running);
        self.changed.notify_all();
        Ok(())
    }

    /// The process of a test has ended: removes its faults.
    pub fn finish_test(&self, test: TestId, was_stopped: bool) {
        let mut state = self.state();
        let ended: Vec<_> = state.tests.extract_if(.., |running| running.id == test).collect();
        while let Some(fault) = state.faults.iter().find(|it| it.test == test).map(|it| it.fault) {
            state = self.remove_one(state, (test, fault)).0;
        }
        drop(state);
        let pending = ended.iter().flat_map(|test| &test.pending);
        for (at, fault) in pending.filter(|_| !was_stopped) {
            let config = &self.settings_of(*fault).config;
            let text = format!(
                "fault `{}` was not injected: the test ended before {at:.3} s",
                config.name
            );
            let location = Some(config.location.clone());
            self.session.message(Message::new(MessageKind::Report, text, location));
        }
    }

    /// Injects a fault, and returns when it has begun.
    pub fn inject(&self, test: TestId, fault: usize) -> Result<(), NotInjected> {
        let is_cancelled = Arc::new(AtomicBool::new(false));
        {
            let mut state = self.state();
            if state.has_ended || state.tests.iter().all(|running| running.id != test) {
                return Err(NotInjected::TestEnded);
            }
            if state.faults.iter().any(|it| it.test == test && it.fault == fault) {
                return Err(NotInjected::Failed("it lasts already".to_owned()));
            }
            let is_cancelled = Arc::clone(&is_cancelled);
            let (effect, until) = (None, None);
            state.faults.push(ActiveFault { test, fault, is_cancelled, effect, until });
        }
        let begun = lasting::begin(&self.settings_of(fault).effect, &self.pauses, &is_cancelled);
        let mut state = self.state();
        let result = match begun {
            Err(problem) => Err(NotInjected::Failed(problem)),
            Ok((effect, _)) if is_cancelled.load(Ordering::Acquire) || state.has_ended => {
                effect.end(&mut self.pauses());
                Err(NotInjected::TestEnded)
            }
            Ok((effect, done)) => {
                self.report_injected((test, fault), done);
                if self.settings_of(fault).kind().lasts() {
                    self.keep(&mut state, (test, fault), effect);
                    self.changed.notify_all();
                    return Ok(());
                }
                Ok(())
            }
        };
        state.faults.retain(|it| it.test != test || it.fault != fault);
        self.changed.notify_all();
        result
    }

    fn keep(&self, state: &mut InjectorState, (test, fault): (TestId, usize), effect: Effect) {
        let running = state.tests.iter().find(|running| running.id == test);
        let duration = running.and_then(|running| running.durations[fault]);
        let until = duration.and_then(|duration| Some(self.clock.now()? + duration));
        let active = state.faults.iter_mut().find(|it| it.test == test && it.fault == fault);
        if let Some(active) = active {
            (active.effect, active.until) = (Some(effect), until);
        }
    }

    /// Injects a fault whose time has come. A problem is one of the test.
    pub fn inject_due(&self, test: TestId, fault: usize) {
        let Err(NotInjected::Failed(problem)) = self.inject(test, fault) else { return };
        let config = &self.settings_of(fault).config;
        let text = format!("fault `{}` was not injected: {problem}", config.name);
        let (severity, location) = (FindingSeverity::Error, Some(config.location.clone()));
        self.session.finding(Finding { test, severity, text, location, interval: None });
    }

    /// Removes a fault of a test; false if it does not last.
    pub fn remove(&self, test: TestId, fault: usize) -> bool {
        self.remove_one(self.state(), (test, fault)).1
    }

    /// Removes a fault, or waits until its injection was cancelled.
    fn remove_one<'s>(
        &'s self,
        mut state: MutexGuard<'s, InjectorState>,
        (test, fault): (TestId, usize),
    ) -> (MutexGuard<'s, InjectorState>, bool) {
        loop {
            let index = state.faults.iter().position(|it| it.test == test && it.fault == fault);
            let Some(index) = index else { return (state, false) };
            if let Some(effect) = state.faults[index].effect.take() {
                state.faults.remove(index);
                effect.end(&mut self.pauses());
                let name = self.settings_of(fault).config.name.clone();
                self.session.fault_removed(test, name);
                return (state, true);
            }
            state.faults[index].is_cancelled.store(true, Ordering::Release);
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Removes the faults whose time has elapsed.
    pub fn remove_due(&self, state: &mut InjectorState, now: f64) {
        let is_over = |it: &mut ActiveFault| it.until.is_some_and(|until| until <= now);
        let over: Vec<_> = state.faults.extract_if(.., is_over).collect();
        for ActiveFault { test, fault, effect, .. } in over {
            effect.into_iter().for_each(|effect| effect.end(&mut self.pauses()));
            let name = self.settings_of(fault).config.name.clone();
            self.session.fault_removed(test, name);
        }
    }

    /// The fixture is torn down: ends all effects and threads.
    pub fn end(&self) {
        let mut state = self.state();
        state.has_ended = true;
        for fault in std::mem::take(&mut state.faults) {
            fault.is_cancelled.store(true, Ordering::Release);
            fault.effect.into_iter().for_each(|effect| effect.end(&mut self.pauses()));
        }
        self.changed.notify_all();
    }

    /// The runner has died: continues all processes. None is stopped afterwards.
    pub fn abandon(&self) {
        let mut pauses = self.pauses();
        pauses.resume_all();
        std::mem::forget(pauses);
    }

    fn report_injected(&self, (test, fault): (TestId, usize), effect: String) {
        let settings = self.settings_of(fault);
        let (name, kind) = (settings.config.name.clone(), settings.kind());
        self.session.fault_injected(FaultInjected { test, name, kind, effect });
    }
}
