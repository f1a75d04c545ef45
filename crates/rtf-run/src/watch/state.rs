//! Decides what to do when a file changes, a run ends, or a signal arrives. Does no I/O.

use crate::exit;

/// The exit code of a run that SIGTERM ended.
const TERMINATED: u8 = 128 + 15;

/// The state of the watcher.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WatchState {
    /// It waits for a change.
    #[default]
    Waiting,
    /// A run is active.
    Running,
    /// The active run was stopped, to start the next one.
    Restarting,
    /// The watcher exits as soon as the run has ended.
    Exiting {
        signal: u8,
        /// Whether the watcher had stopped the run before.
        was_stopped: bool,
    },
}

/// What to do next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WatchAction {
    None,
    /// Report that the watcher waits for a change.
    Wait,
    /// Start a run.
    Start,
    /// Stop the run, with its hooks and tear-down.
    Stop,
    /// Pass the signal on to the run.
    PassSignal,
    /// Exit with this code.
    Exit(u8),
}

impl WatchState {
    pub fn files_changed(&mut self) -> WatchAction {
        match self {
            Self::Waiting => self.enter(Self::Running, WatchAction::Start),
            Self::Running => self.enter(Self::Restarting, WatchAction::Stop),
            Self::Restarting | Self::Exiting { .. } => WatchAction::None,
        }
    }

    /// The run ended with this exit code.
    pub fn run_ended(&mut self, code: u8) -> WatchAction {
        match *self {
            // The robot may not be in a safe state: the user has to check it first.
            Self::Restarting if code == exit::HOOK_FAILED => {
                self.enter(Self::Waiting, WatchAction::Wait)
            }
            Self::Restarting => self.enter(Self::Running, WatchAction::Start),
            Self::Exiting { signal, was_stopped: true } if code == TERMINATED => {
                WatchAction::Exit(exit::of_signal(signal.into()))
            }
            Self::Exiting { .. } => WatchAction::Exit(code),
            Self::Running | Self::Waiting => self.enter(Self::Waiting, WatchAction::Wait),
        }
    }

    /// A signal arrived.
    pub fn signal(&mut self, signal: u8) -> WatchAction {
        match self {
            Self::Waiting => WatchAction::Exit(exit::of_signal(signal.into())),
            Self::Running => {
                self.enter(Self::Exiting { signal, was_stopped: false }, WatchAction::PassSignal)
            }
            // A second signal would interrupt the tear-down.
            Self::Restarting => {
                self.enter(Self::Exiting { signal, was_stopped: true }, WatchAction::None)
            }
            Self::Exiting { .. } => WatchAction::PassSignal,
        }
    }

    fn enter(&mut self, state: Self, action: WatchAction) -> WatchAction {
        *self = state;
        action
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INT: u8 = 2;

    #[test]
    fn a_change_starts_and_stops_runs() {
        let mut state = WatchState::default();
        assert_eq!(state.files_changed(), WatchAction::Start);
        assert_eq!(state.files_changed(), WatchAction::Stop);
        assert_eq!(state.files_changed(), WatchAction::None, "it stops once");
        assert_eq!(state.run_ended(143), WatchAction::Start);
        assert_eq!(state.run_ended(1), WatchAction::Wait);
        assert_eq!(state.files_changed(), WatchAction::Start);
    }

    #[test]
    fn no_run_starts_by_itself_after_a_failed_hook() {
        let mut state = WatchState::Restarting;
        assert_eq!(state.run_ended(4), WatchAction::Wait);
        assert_eq!(state.files_changed(), WatchAction::Start);
    }

    #[test]
    fn a_signal_ends_the_watcher_with_its_run() {
        assert_eq!(WatchState::Waiting.signal(INT), WatchAction::Exit(130));
        for code in [130, 0, 4] {
            let mut state = WatchState::Running;
            assert_eq!(state.signal(INT), WatchAction::PassSignal);
            assert_eq!(state.files_changed(), WatchAction::None);
            assert_eq!(state.signal(INT), WatchAction::PassSignal, "the second signal kills");
            assert_eq!(state.run_ended(code), WatchAction::Exit(code));
        }
    }

    #[test]
    fn a_signal_does_not_interrupt_the_tear_down_of_a_stopped_run() {
        for (code, exit) in [(143, 130), (4, 4)] {
            let mut state = WatchState::Restarting;
            assert_eq!(state.signal(INT), WatchAction::None);
            assert_eq!(state.signal(INT), WatchAction::PassSignal);
            assert_eq!(state.run_ended(code), WatchAction::Exit(exit));
        }
    }
}
