//! When changed files are fit to be used again.
//!
//! A compiler writes a plug-in in many steps, an editor takes a file away before
//! it puts a new one in its place. So changes count once all is quiet, every
//! touched file is closed, and what was removed had time to come back. Knows
//! neither files nor clocks: times are counted from any fixed moment.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// How long nothing may happen before the changes count.
pub const QUIET: Duration = Duration::from_millis(200);
/// How long a file that was removed may take to come back.
pub const COMEBACK: Duration = Duration::from_secs(2);

/// What happened to a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Touch {
    /// It was made by somebody who has it open.
    Created,
    /// Somebody wrote to it, and has it open.
    Written,
    /// Who wrote to it closed it.
    Closed,
    /// Another file has taken its place, whole.
    Replaced,
    /// Something about it changed, not what is in it.
    Attributes,
    /// It is gone.
    Removed,
}

#[derive(Clone, Copy, Debug, Default)]
struct State {
    open: bool,
    gone_since: Option<Duration>,
}

/// The changes that do not count yet.
#[derive(Debug, Default)]
pub struct Debounce {
    files: BTreeMap<PathBuf, State>,
    last: Duration,
}

impl Debounce {
    /// Notes what happened to a file.
    pub fn note(&mut self, file: &Path, touch: Touch, now: Duration) {
        self.last = now;
        let state = self.files.entry(file.to_owned()).or_default();
        match touch {
            Touch::Created => *state = State { open: true, gone_since: None },
            Touch::Replaced => *state = State::default(),
            // Who has a removed file open may still write to it: it stays gone.
            Touch::Written => state.open = state.gone_since.is_none(),
            Touch::Closed => state.open = false,
            Touch::Attributes => {}
            Touch::Removed => *state = State { open: false, gone_since: Some(now) },
        }
    }

    /// What happened is not known: nobody waits for a file to be closed.
    pub fn lost(&mut self, now: Duration) {
        self.last = now;
        for state in self.files.values_mut() {
            state.open = false;
        }
    }

    /// Whether nothing was noted.
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// When the changes count, unless something happens before; `None` when
    /// there are none, or when a file has to be closed first.
    pub fn due(&self) -> Option<Duration> {
        if self.is_empty() || self.files.values().any(|state| state.open) {
            return None;
        }
        let comebacks = self.files.values().filter_map(|state| state.gone_since);
        comebacks.map(|since| since + COMEBACK).chain([self.last + QUIET]).max()
    }

    /// The changed files, once they count.
    pub fn take(&mut self, now: Duration) -> Option<BTreeSet<PathBuf>> {
        self.due().filter(|due| *due <= now)?;
        Some(std::mem::take(&mut self.files).into_keys().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ms(ms: u64) -> Duration {
        Duration::from_millis(ms)
    }

    fn after(touches: &[(&str, Touch, u64)]) -> Debounce {
        let mut debounce = Debounce::default();
        for (file, touch, at) in touches {
            debounce.note(Path::new(file), *touch, ms(*at));
        }
        debounce
    }

    fn due(touches: &[(&str, Touch, u64)]) -> Option<u128> {
        after(touches).due().map(|due| due.as_millis())
    }

    #[test]
    fn nothing_is_never_due() {
        assert_eq!(due(&[]), None);
        assert_eq!(Debounce::default().take(ms(100_000)), None);
    }

    #[test]
    fn changes_count_together_after_200_ms_of_quiet() {
        let mut debounce = after(&[("a", Touch::Replaced, 1000), ("b", Touch::Replaced, 1150)]);
        assert_eq!(debounce.take(ms(1349)), None);
        let files = debounce.take(ms(1350)).expect("they count");
        assert_eq!(files, ["a", "b"].map(PathBuf::from).into());
        assert!(debounce.is_empty());
        assert_eq!(debounce.take(ms(9000)), None, "once");
    }

    #[test]
    fn a_file_has_to_be_closed() {
        let written = [("a.so", Touch::Created, 0), ("a.so", Touch::Written, 10)];
        assert_eq!(due(&written), None);
        // The linker takes its time; another file does not make it whole.
        assert_eq!(due(&[written[0], written[1], ("b", Touch::Replaced, 5000)]), None);
        assert_eq!(due(&[written[0], written[1], ("a.so", Touch::Closed, 9000)]), Some(9200));
        assert_eq!(due(&[written[0], written[1], ("a.so", Touch::Attributes, 20)]), None);
    }

    #[test]
    fn a_closed_file_may_be_opened_again() {
        let steps = [("a", Touch::Closed, 0), ("a", Touch::Written, 100)];
        assert_eq!(due(&steps), None);
        assert_eq!(due(&[steps[0], steps[1], ("a", Touch::Closed, 150)]), Some(350));
    }

    #[test]
    fn a_removed_file_has_2_s_to_come_back() {
        assert_eq!(due(&[("a", Touch::Removed, 100)]), Some(2100));
        // It is back, and whole.
        assert_eq!(due(&[("a", Touch::Removed, 100), ("a", Touch::Replaced, 300)]), Some(500));
        // It is back, and being written.
        assert_eq!(due(&[("a", Touch::Removed, 100), ("a", Touch::Created, 1900)]), None);
        // Another one keeps its own time.
        assert_eq!(due(&[("a", Touch::Removed, 100), ("b", Touch::Closed, 300)]), Some(2100));
        assert_eq!(due(&[("a", Touch::Removed, 100), ("b", Touch::Closed, 2050)]), Some(2250));
    }

    #[test]
    fn who_has_a_removed_file_open_does_not_bring_it_back() {
        let steps = [("a", Touch::Removed, 100), ("a", Touch::Written, 150)];
        assert_eq!(due(&steps), Some(2100));
        assert_eq!(due(&[steps[0], steps[1], ("a", Touch::Closed, 200)]), Some(2100));
    }

    #[test]
    fn lost_events_close_what_is_open() {
        let mut debounce = after(&[("a", Touch::Written, 0)]);
        debounce.lost(ms(700));
        assert_eq!(debounce.due(), Some(ms(900)));
    }
}
