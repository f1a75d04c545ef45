//! The thread that injects and removes faults at their times.

use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

use rtf_model::TestId;

use crate::injector::{Injector, InjectorState};
use crate::settings::EffectSettings;

/// How long to wait without a reason to do anything.
const IDLE: Duration = Duration::from_secs(3600);

/// Runs until the fixture is torn down.
pub(crate) fn run(injector: &Arc<Injector>) {
    let mut state = injector.state();
    while !state.has_ended {
        let due = take_due(injector, &mut state);
        if due.is_empty() {
            let wait = wait_time(injector, &mut state);
            let waited = injector.changed.wait_timeout(state, wait);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
            continue;
        }
        drop(state);
        for (test, fault) in due {
            inject(injector, test, fault);
        }
        state = injector.state();
    }
}

fn take_due(injector: &Injector, state: &mut InjectorState) -> Vec<(TestId, usize)> {
    let Some(now) = injector.clock.now() else { return Vec::new() };
    injector.remove_due(state, now);
    let tests = state.tests.iter_mut();
    tests.flat_map(|test| test.take_due(now).into_iter().map(|fault| (test.id, fault))).collect()
}

/// Filling, and the answer of a proxy, take a while, in which other faults begin and end.
fn inject(injector: &Arc<Injector>, test: TestId, fault: usize) {
    match &injector.settings.faults[fault].effect {
        EffectSettings::Memory(_) | EffectSettings::Disk { .. } | EffectSettings::Values { .. } => {
            let injector = Arc::clone(injector);
            std::thread::spawn(move || injector.inject_due(test, fault));
        }
        EffectSettings::Kill(_)
        | EffectSettings::Stop(_)
        | EffectSettings::Slow { .. }
        | EffectSettings::Network { .. } => {
            injector.inject_due(test, fault);
        }
    }
}

/// Advances the effects that last; returns how long to wait until something is due.
fn wait_time(injector: &Injector, state: &mut InjectorState) -> Duration {
    let now = Instant::now();
    let mut wait = IDLE;
    let mut pauses = injector.pauses();
    for effect in state.faults.iter_mut().filter_map(|fault| fault.effect.as_mut()) {
        if let Some(next) = effect.advance(now, &mut pauses) {
            wait = wait.min(next.saturating_duration_since(now));
        }
    }
    let times = state.tests.iter().filter_map(|test| test.next());
    let times = times.chain(state.faults.iter().filter_map(|fault| fault.until));
    if let Some(next) = times.min_by(f64::total_cmp) {
        let left = injector.clock.now().map_or(0.0, |now| next - now);
        wait = wait.min(injector.clock.wait_for(left));
    }
    wait
}
