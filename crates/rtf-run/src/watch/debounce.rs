//! Decides when changed files are complete.
//!
//! A compiler writes a plug-in in many steps; an editor removes a file before it creates
//! the new one. So changes are due once no change has followed for a while, every changed
//! file is closed, and removed files had time to return. Reads neither files nor the
//! clock: times are relative to any fixed instant.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// How long after the last change the changes are due.
pub const QUIET: Duration = Duration::from_millis(200);
/// How long a removed file may take to return.
pub const RETURN_LIMIT: Duration = Duration::from_secs(2);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileChange {
    /// A process created it and has it open.
    Created,
    /// A process wrote to it and has it open.
    Written,
    /// The writer closed it.
    Closed,
    /// A complete file replaced it.
    Replaced,
    /// Its attributes changed, not its content.
    Attributes,
    Removed,
}

#[derive(Clone, Copy, Debug, Default)]
struct FileState {
    is_open: bool,
    removed_at: Option<Duration>,
}

/// The changes that are not due yet.
#[derive(Debug, Default)]
pub struct Debounce {
    files: BTreeMap<PathBuf, FileState>,
    last_change: Duration,
}

impl Debounce {
    pub fn record(&mut self, file: &Path, change: FileChange, now: Duration) {
        self.last_change = now;
        let state = self.files.entry(file.to_owned()).or_default();
        match change {
            FileChange::Created => *state = FileState { is_open: true, removed_at: None },
            FileChange::Replaced => *state = FileState::default(),
            // A process may write to a removed file, which stays removed.
            FileChange::Written => state.is_open = state.removed_at.is_none(),
            FileChange::Closed => state.is_open = false,
            FileChange::Attributes => {}
            FileChange::Removed => *state = FileState { is_open: false, removed_at: Some(now) },
        }
    }

    /// Records that changes were lost: a missed one may have closed an open file.
    pub fn record_lost(&mut self, now: Duration) {
        self.last_change = now;
        for state in self.files.values_mut() {
            state.is_open = false;
        }
    }

    /// Whether there are no changes.
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// When the changes are due if no other follows; `None` if there are none, or if a
    /// file is still open.
    pub fn due(&self) -> Option<Duration> {
        if self.is_empty() || self.files.values().any(|state| state.is_open) {
            return None;
        }
        let removals = self.files.values().filter_map(|state| state.removed_at);
        removals.map(|at| at + RETURN_LIMIT).chain([self.last_change + QUIET]).max()
    }

    /// Takes the changed files if they are due.
    pub fn take_due(&mut self, now: Duration) -> Option<BTreeSet<PathBuf>> {
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

    fn after(changes: &[(&str, FileChange, u64)]) -> Debounce {
        let mut debounce = Debounce::default();
        for (file, change, at) in changes {
            debounce.record(Path::new(file), *change, ms(*at));
        }
        debounce
    }

    fn due(changes: &[(&str, FileChange, u64)]) -> Option<u128> {
        after(changes).due().map(|due| due.as_millis())
    }

    #[test]
    fn no_changes_are_never_due() {
        assert_eq!(due(&[]), None);
        assert_eq!(Debounce::default().take_due(ms(100_000)), None);
    }

    #[test]
    fn changes_are_due_together_after_200_ms_of_quiet() {
        let mut debounce =
            after(&[("a", FileChange::Replaced, 1000), ("b", FileChange::Replaced, 1150)]);
        assert_eq!(debounce.take_due(ms(1349)), None);
        let files = debounce.take_due(ms(1350)).expect("they are due");
        assert_eq!(files, ["a", "b"].map(PathBuf::from).into());
        assert!(debounce.is_empty());
        assert_eq!(debounce.take_due(ms(9000)), None, "once");
    }

    #[test]
    fn a_file_has_to_be_closed() {
        let written = [("a.so", FileChange::Created, 0), ("a.so", FileChange::Written, 10)];
        assert_eq!(due(&written), None);
        // A change of another file does not complete it.
        assert_eq!(due(&[written[0], written[1], ("b", FileChange::Replaced, 5000)]), None);
        assert_eq!(due(&[written[0], written[1], ("a.so", FileChange::Closed, 9000)]), Some(9200));
        assert_eq!(due(&[written[0], written[1], ("a.so", FileChange::Attributes, 20)]), None);
    }

    #[test]
    fn a_closed_file_may_be_opened_again() {
        let steps = [("a", FileChange::Closed, 0), ("a", FileChange::Written, 100)];
        assert_eq!(due(&steps), None);
        assert_eq!(due(&[steps[0], steps[1], ("a", FileChange::Closed, 150)]), Some(350));
    }

    #[test]
    fn a_removed_file_has_2_s_to_return() {
        assert_eq!(due(&[("a", FileChange::Removed, 100)]), Some(2100));
        // It has returned, complete.
        assert_eq!(
            due(&[("a", FileChange::Removed, 100), ("a", FileChange::Replaced, 300)]),
            Some(500)
        );
        // It has returned, and is being written.
        assert_eq!(due(&[("a", FileChange::Removed, 100), ("a", FileChange::Created, 1900)]), None);
        // Each file has its own limit.
        assert_eq!(
            due(&[("a", FileChange::Removed, 100), ("b", FileChange::Closed, 300)]),
            Some(2100)
        );
        assert_eq!(
            due(&[("a", FileChange::Removed, 100), ("b", FileChange::Closed, 2050)]),
            Some(2250)
        );
    }

    #[test]
    fn writing_to_a_removed_file_does_not_return_it() {
        let steps = [("a", FileChange::Removed, 100), ("a", FileChange::Written, 150)];
        assert_eq!(due(&steps), Some(2100));
        assert_eq!(due(&[steps[0], steps[1], ("a", FileChange::Closed, 200)]), Some(2100));
    }

    #[test]
    fn lost_changes_close_open_files() {
        let mut debounce = after(&[("a", FileChange::Written, 0)]);
        debounce.record_lost(ms(700));
        assert_eq!(debounce.due(), Some(ms(900)));
    }
}
