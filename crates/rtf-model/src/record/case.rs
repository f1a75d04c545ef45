//! The cases of an attempt of a test.

use std::collections::VecDeque;
use std::time::Duration;

use crate::{CaseFinished, CaseId, CaseStart, Micros, Verdict};

/// The state of one case.
#[derive(Clone, Debug)]
pub struct CaseRecord {
    /// How it started.
    pub start: CaseStart,
    /// Its name, after the names of the cases that contain it: `Arm/Moves`.
    pub path: String,
    /// When it started.
    pub started: Micros,
    /// When and how it finished.
    pub finished: Option<(Micros, CaseFinished)>,
    /// Whether a later attempt of it, or of a case that contains it, decides.
    pub is_superseded: bool,
}

impl CaseRecord {
    /// Number of cases that contain it.
    #[must_use]
    pub fn depth(&self) -> usize {
        // The name itself may contain a slash.
        let parents = self.path.len().saturating_sub(self.start.name.len());
        self.path[..parents].matches('/').count()
    }

    /// The verdict, `None` while it runs.
    #[must_use]
    pub fn verdict(&self) -> Option<Verdict> {
        self.finished.as_ref().map(|(_, finished)| finished.verdict)
    }

    /// Why it did not pass.
    #[must_use]
    pub fn reason(&self) -> Option<&str> {
        self.finished.as_ref().and_then(|(_, finished)| finished.reason.as_deref())
    }

    /// Its duration, `None` while it runs.
    #[must_use]
    pub fn duration(&self) -> Option<Duration> {
        let (at, finished) = self.finished.as_ref()?;
        Some(finished.duration_us.map_or_else(|| at.since(self.started), Duration::from_micros))
    }

    /// Whether it passed after its framework had run it before.
    #[must_use]
    pub fn is_flaky(&self) -> bool {
        self.start.earlier_attempts > 0 && self.verdict() == Some(Verdict::Passed)
    }

    /// Whether it finished in an earlier attempt of the test, which has its messages.
    #[must_use]
    pub fn is_carried(&self) -> bool {
        self.finished.as_ref().is_some_and(|(_, finished)| finished.carried)
    }
}

/// The announced cases of an attempt that have not started.
#[derive(Clone, Debug, Default)]
pub struct PlannedCases(VecDeque<String>);

impl PlannedCases {
    /// Adds announced names.
    pub fn announce(&mut self, names: impl IntoIterator<Item = String>) {
        self.0.extend(names);
    }

    /// Removes a top-level case that starts.
    pub fn start(&mut self, name: &str) {
        // Cases usually start in the order of their announcement.
        let announced = self.0.iter().position(|planned| planned == name);
        announced.and_then(|index| self.0.remove(index));
    }

    /// Number of cases that have not started.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether all announced cases have started.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The names, in the order of their announcement.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(String::as_str)
    }
}

/// The cases of an attempt: all that did not pass, and passed ones up to a limit.
#[derive(Clone, Debug, Default)]
pub struct AttemptCases {
    kept: Vec<CaseRecord>,
    not_run: PlannedCases,
    counts: [u64; Verdict::ALL.len()],
    omitted: u64,
    episodes: u64,
    superseded: u64,
    flaky: u64,
}

impl AttemptCases {
    /// Maximum number of passed cases that a [`super::Record`] keeps.
    pub const PASSED_KEPT: u64 = 100_000;

    /// Maximum number of finished episodes that are kept.
    pub const EPISODES_KEPT: u64 = 256;

    /// The cases that are kept, in the order in which they started; of a case that its
    /// framework ran again, all attempts.
    #[must_use]
    pub fn kept(&self) -> &[CaseRecord] {
        &self.kept
    }

    /// The cases that are kept, of each one the last attempt.
    pub fn decisive(&self) -> impl Iterator<Item = &CaseRecord> {
        self.kept.iter().filter(|case| !case.is_superseded)
    }

    /// The earlier attempts of a top-level case.
    pub fn earlier_attempts(&self, case: &CaseRecord) -> impl Iterator<Item = &CaseRecord> {
        let path = (case.start.earlier_attempts > 0).then(|| case.path.clone());
        let is_earlier = move |other: &&CaseRecord| {
            other.is_superseded
                && other.start.parent.is_none()
                && Some(&other.path) == path.as_ref()
        };
        self.kept.iter().filter(is_earlier)
    }

    /// Number of cases that passed after their framework had run them before.
    #[must_use]
    pub fn flaky(&self) -> u64 {
        self.flaky
    }

    /// The case with this id, if it is kept.
    #[must_use]
    pub fn get(&self, id: CaseId) -> Option<&CaseRecord> {
        let index = self.kept.binary_search_by_key(&id, |case| case.start.case).ok()?;
        self.kept.get(index)
    }

    /// The announced cases that have not started.
    #[must_use]
    pub fn not_run(&self) -> &PlannedCases {
        &self.not_run
    }

    /// Number of finished cases with this verdict, kept or not.
    #[must_use]
    pub fn of(&self, verdict: Verdict) -> u64 {
        self.counts[verdict as usize]
    }

    /// Number of finished cases that did not pass, without skipped ones.
    #[must_use]
    pub fn problems(&self) -> u64 {
        Verdict::ALL.into_iter().filter(|verdict| verdict.is_problem()).map(|v| self.of(v)).sum()
    }

    /// Number of passed cases and of episodes that are counted and not kept; the journal has them.
    #[must_use]
    pub fn omitted(&self) -> u64 {
        self.omitted
    }

    /// Number of cases: finished, open, and planned. Attempts of a case are one case.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.kept.len() as u64 - self.superseded + self.omitted + self.not_run.len() as u64
    }

    /// The path by which a host knows a case. The runner numbers repeated names: the host
    /// knows `joint#2` as `joint`, which selects both.
    #[must_use]
    pub fn selectable_path(&self, case: &CaseRecord) -> String {
        let mut path = case.path.clone();
        let mut end = path.len();
        while let Some(hash) = path[..end].rfind('#') {
            let digits = path[hash + 1..].chars().take_while(char::is_ascii_digit).count();
            let after = hash + 1 + digits;
            let is_end = matches!(path[after..].chars().next(), None | Some('/'));
            let base = &path[..hash];
            let exists = || self.kept.iter().any(|other| other.path == base);
            if digits > 0 && is_end && exists() {
                path.replace_range(hash..after, "");
            }
            end = hash;
        }
        path
    }

    pub(super) fn plan(&mut self, names: &[String]) {
        self.not_run.announce(names.iter().cloned());
    }

    pub(super) fn start(&mut self, at: Micros, start: &CaseStart) {
        let parent = start.parent.and_then(|parent| self.get(parent));
        let path = match parent {
            Some(parent) => format!("{}/{}", parent.path, start.name),
            None => start.name.clone(),
        };
        if start.parent.is_none() && start.earlier_attempts == 0 {
            self.not_run.start(&start.name);
        }
        let (start, finished, is_superseded) = (start.clone(), None, false);
        self.kept.push(CaseRecord { start, path, started: at, finished, is_superseded });
    }

    /// `passed_kept`: the number of passed cases that the run's record keeps. Returns the cases that
    /// are not kept any more.
    pub(super) fn finish(
        &mut self,
        at: Micros,
        end: &CaseFinished,
        passed_kept: &mut u64,
    ) -> Vec<CaseId> {
        let Ok(index) = self.kept.binary_search_by_key(&end.case, |case| case.start.case) else {
            return Vec::new();
        };
        self.counts[end.verdict as usize] += 1;
        self.flaky += u64::from(
            self.kept[index].start.earlier_attempts > 0 && end.verdict == Verdict::Passed,
        );
        if end.rerun {
            self.kept[index].finished = Some((at, end.clone()));
            self.supersede(index);
            return Vec::new();
        }
        if self.kept[index].start.episode.is_some() {
            if self.episodes >= Self::EPISODES_KEPT {
                return self.forget(index);
            }
            self.episodes += 1;
        } else if end.verdict == Verdict::Passed {
            if *passed_kept >= Self::PASSED_KEPT {
                self.omitted += 1;
                self.kept.remove(index);
                return Vec::new();
            }
            *passed_kept += 1;
        }
        self.kept[index].finished = Some((at, end.clone()));
        Vec::new()
    }

    /// Removes a case, and those that it contains.
    fn forget(&mut self, index: usize) -> Vec<CaseId> {
        let ids = self.inside(index);
        let is_removed = |case: &CaseRecord| ids.binary_search(&case.start.case).is_ok();
        let from = self.kept.split_off(index);
        self.kept.extend(from.into_iter().filter(|case| !is_removed(case)));
        self.omitted += ids.len() as u64;
        ids
    }

    /// A case and those that it contains, in order.
    fn inside(&self, index: usize) -> Vec<CaseId> {
        let mut ids = Vec::new();
        for (offset, CaseRecord { start, .. }) in self.kept[index..].iter().enumerate() {
            if offset == 0 || start.parent.is_some_and(|parent| ids.contains(&parent)) {
                ids.push(start.case);
            }
        }
        ids
    }

    /// Removes a case, and those that it contains, from the counts: another attempt decides.
    fn supersede(&mut self, index: usize) {
        let ids = self.inside(index);
        for case in &mut self.kept[index..] {
            if ids.binary_search(&case.start.case).is_err() {
                continue;
            }
            case.is_superseded = true;
            self.superseded += 1;
            if let Some(verdict) = case.verdict() {
                self.counts[verdict as usize] -= 1;
            }
            self.flaky -= u64::from(case.is_flaky());
        }
    }
}
