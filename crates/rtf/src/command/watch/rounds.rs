//! What is done when a file changes, a run ends, or a signal comes: decides,
//! and does nothing.

use crate::exit;

/// SIGTERM ended it.
const TERMINATED: u8 = 128 + 15;

/// What the watcher is at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rounds {
    /// It waits for a change.
    #[default]
    Waiting,
    /// A run goes on.
    Running,
    /// A run was stopped for the sake of the next one.
    Restarting,
    /// A signal ends the watcher, once the run has ended.
    Ending {
        /// The first one.
        signal: u8,
        /// Whether the run was being stopped already, by us.
        stopped: bool,
    },
}

/// What is to be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Nothing.
    Nothing,
    /// Wait for a change, and say so.
    Rest,
    /// Start a run.
    Start,
    /// Stop the run, with all its tear-downs.
    Stop,
    /// Pass the signal on to the run.
    Pass,
    /// End with this exit code.
    Exit(u8),
}

impl Rounds {
    /// Something changed.
    pub fn changed(&mut self) -> Order {
        match self {
            Self::Waiting => self.go(Self::Running, Order::Start),
            Self::Running => self.go(Self::Restarting, Order::Stop),
            Self::Restarting | Self::Ending { .. } => Order::Nothing,
        }
    }

    /// The run ended with this exit code.
    pub fn ended(&mut self, code: u8) -> Order {
        match *self {
            // The robot may not be in a safe state: somebody has to look first.
            Self::Restarting if code == exit::HOOK_FAILED => self.go(Self::Waiting, Order::Rest),
            Self::Restarting => self.go(Self::Running, Order::Start),
            Self::Ending { signal, stopped: true } if code == TERMINATED => {
                Order::Exit(signalled(signal))
            }
            Self::Ending { .. } => Order::Exit(code),
            Self::Running | Self::Waiting => self.go(Self::Waiting, Order::Rest),
        }
    }

    /// A signal asks for the end.
    pub fn signal(&mut self, signal: u8) -> Order {
        match self {
            Self::Waiting => Order::Exit(signalled(signal)),
            Self::Running => self.go(Self::Ending { signal, stopped: false }, Order::Pass),
            // A second signal would kill what is being torn down.
            Self::Restarting => self.go(Self::Ending { signal, stopped: true }, Order::Nothing),
            Self::Ending { .. } => Order::Pass,
        }
    }

    fn go(&mut self, next: Self, order: Order) -> Order {
        *self = next;
        order
    }
}

fn signalled(signal: u8) -> u8 {
    128u8.saturating_add(signal)
}

#[cfg(test)]
mod tests {
    use super::*;

    const INT: u8 = 2;

    #[test]
    fn a_change_starts_and_stops_runs() {
        let mut rounds = Rounds::default();
        assert_eq!(rounds.changed(), Order::Start);
        assert_eq!(rounds.changed(), Order::Stop);
        assert_eq!(rounds.changed(), Order::Nothing, "it is stopped once");
        assert_eq!(rounds.ended(143), Order::Start);
        assert_eq!(rounds.ended(1), Order::Rest);
        assert_eq!(rounds.changed(), Order::Start);
    }

    #[test]
    fn after_a_failed_hook_nothing_starts_by_itself() {
        let mut rounds = Rounds::Restarting;
        assert_eq!(rounds.ended(4), Order::Rest);
        assert_eq!(rounds.changed(), Order::Start);
    }

    #[test]
    fn a_signal_ends_at_once_or_with_the_run() {
        assert_eq!(Rounds::Waiting.signal(INT), Order::Exit(130));
        for code in [130, 0, 4] {
            let mut rounds = Rounds::Running;
            assert_eq!(rounds.signal(INT), Order::Pass);
            assert_eq!(rounds.changed(), Order::Nothing);
            assert_eq!(rounds.signal(INT), Order::Pass, "the second insists");
            assert_eq!(rounds.ended(code), Order::Exit(code));
        }
    }

    #[test]
    fn a_signal_lets_the_stopped_run_tear_down() {
        for (code, exit) in [(143, 130), (4, 4)] {
            let mut rounds = Rounds::Restarting;
            assert_eq!(rounds.signal(INT), Order::Nothing);
            assert_eq!(rounds.signal(INT), Order::Pass);
            assert_eq!(rounds.ended(code), Order::Exit(exit));
        }
    }
}
