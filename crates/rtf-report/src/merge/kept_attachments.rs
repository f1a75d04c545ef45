//! Which attachments the merged run keeps: those of attempts that did not pass, and of a sample
//! of those that passed. The others stay in the stream, marked as omitted.

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::hash::Hasher;
use std::str::FromStr;

use rtf_model::{EventKind, TestId, Verdict};
use siphasher::sip::SipHasher13;

/// Which attachments the merged run keeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Keep {
    #[default]
    All,
    /// Those of some attempts.
    Some {
        /// Whether attempts that did not pass are among them.
        failed: bool,
        /// How many attempts that passed, of those that attached a file.
        sample: usize,
    },
}

/// A text names no choice of attachments.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected `all`, `failed`, `sample:NUMBER` or several of them, found `{found}`")]
pub struct UnknownKeep {
    pub found: String,
}

impl FromStr for Keep {
    type Err = UnknownKeep;

    fn from_str(text: &str) -> Result<Self, UnknownKeep> {
        let (mut all, mut failed, mut sample) = (false, false, None);
        for word in text.split_whitespace() {
            match word.strip_prefix("sample:").map(str::parse) {
                Some(Ok(number)) if sample.is_none() => sample = Some(number),
                None if word == "all" => all = true,
                None if word == "failed" => failed = true,
                _ => return Err(UnknownKeep { found: word.to_owned() }),
            }
        }
        match (all, failed, sample) {
            (false, false, None) => Err(UnknownKeep { found: text.to_owned() }),
            (true, ..) => Ok(Self::All),
            (false, ..) => Ok(Self::Some { failed, sample: sample.unwrap_or_default() }),
        }
    }
}

/// An attempt of a test, with the ids of its run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct AttemptId {
    /// The run's place.
    part: usize,
    pub test: TestId,
    pub repetition: u32,
    attempt: u32,
}

/// An attempt that attached a file, and its verdict if it has one.
#[derive(Clone, Copy, Debug)]
pub(super) struct AttachingAttempt {
    pub id: AttemptId,
    pub verdict: Option<Verdict>,
}

/// The attempts of a run that have not finished.
#[derive(Debug, Default)]
pub(super) struct OpenAttempts {
    part: usize,
    /// With whether they have attached a file.
    open: BTreeMap<TestId, (AttemptId, bool)>,
}

impl OpenAttempts {
    pub fn of(part: usize) -> Self {
        Self { part, open: BTreeMap::new() }
    }

    /// Follows an event with the ids of the run; answers which attempt has finished, if it had
    /// attached a file.
    pub fn follow(&mut self, kind: &EventKind) -> Option<AttachingAttempt> {
        match *kind {
            EventKind::TestStarted { test, repetition, attempt } => {
                let id = AttemptId { part: self.part, test, repetition, attempt };
                self.open.insert(test, (id, false));
                None
            }
            EventKind::Attached { test, .. } => {
                self.open.get_mut(&test).into_iter().for_each(|(_, attaches)| *attaches = true);
                None
            }
            EventKind::TestFinished(ref finished) => {
                let (id, attaches) = self.open.remove(&finished.test)?;
                attaches.then_some(AttachingAttempt { id, verdict: Some(finished.verdict) })
            }
            _ => None,
        }
    }

    /// The attempts that never finish: the run has ended.
    pub fn unfinished(self) -> impl Iterator<Item = AttachingAttempt> {
        let open = self.open.into_values().filter(|(_, attaches)| *attaches);
        open.map(|(id, _)| AttachingAttempt { id, verdict: None })
    }
}

/// The attempts whose attachments are kept, while the runs are read for the first time.
#[derive(Debug, Default)]
pub(super) struct KeptAttempts {
    keep: Keep,
    /// With those of the sample.
    kept: HashSet<AttemptId>,
    /// The attempts that passed, with the smallest hashes.
    sample: BTreeSet<(u64, AttemptId)>,
}

impl KeptAttempts {
    pub fn of(keep: Keep) -> Self {
        Self { keep, ..Self::default() }
    }

    /// Adds an attempt if its attachments are kept. Its name, the names of suite and test and the
    /// number of the episode or repetition, is the same however the tests were divided.
    pub fn add(&mut self, attempt: &AttachingAttempt, name: (&str, &str, u64)) {
        let Keep::Some { failed, sample } = self.keep else { return };
        if attempt.verdict != Some(Verdict::Passed) {
            self.kept.extend(failed.then_some(attempt.id));
        } else if sample > 0 {
            self.sample.insert((hash(name, attempt.id.attempt), attempt.id));
            self.kept.insert(attempt.id);
            let surplus = (self.sample.len() > sample).then(|| self.sample.pop_last()).flatten();
            if let Some((_, id)) = surplus {
                self.kept.remove(&id);
            }
        }
    }

    /// Marks an attachment that is not kept.
    pub fn mark(&self, attempts: &OpenAttempts, kind: &mut EventKind) {
        if let (Keep::Some { .. }, EventKind::Attached { test, attachment, .. }) = (self.keep, kind)
        {
            let attempt = attempts.open.get(test);
            attachment.omitted |= !attempt.is_some_and(|(id, _)| self.kept.contains(id));
        }
    }
}

/// Hashes an attempt to the same number on every machine and in every version.
fn hash((suite, test, number): (&str, &str, u64), attempt: u32) -> u64 {
    let mut hasher = SipHasher13::new();
    hasher.write(suite.as_bytes());
    // A separator that no UTF-8 name contains.
    hasher.write_u8(0xff);
    hasher.write(test.as_bytes());
    hasher.write_u8(0xff);
    hasher.write(&number.to_le_bytes());
    hasher.write(&attempt.to_le_bytes());
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_choose_attachments() {
        let some = |failed, sample| Ok(Keep::Some { failed, sample });
        for (text, wanted) in [
            ("all", Ok(Keep::All)),
            ("failed all", Ok(Keep::All)),
            ("failed", some(true, 0)),
            ("failed sample:20", some(true, 20)),
            (" sample:3  failed ", some(true, 3)),
            ("sample:0", some(false, 0)),
            ("", Err("")),
            ("passed", Err("passed")),
            ("sample", Err("sample")),
            ("sample:", Err("sample:")),
            ("sample:-1", Err("sample:-1")),
            ("sample:1 sample:2", Err("sample:2")),
        ] {
            let wanted = wanted.map_err(|found| UnknownKeep { found: found.to_owned() });
            assert_eq!(text.parse::<Keep>(), wanted, "{text}");
        }
    }

    #[test]
    fn the_sample_is_the_same_however_the_tests_were_divided() {
        let names: Vec<_> = (0..200).map(|number| format!("test-{number}")).collect();
        let sample = |parts: usize| {
            let mut kept = KeptAttempts::of("sample:20".parse().unwrap());
            for (number, name) in names.iter().enumerate() {
                let (part, test) = (number % parts, TestId((number / parts) as u32));
                let id = AttemptId { part, test, repetition: 1, attempt: 1 };
                let attempt = AttachingAttempt { id, verdict: Some(Verdict::Passed) };
                kept.add(&attempt, ("suite", name, 1));
            }
            let ids = kept.sample.iter().map(|(_, id)| id.test.index() * parts + id.part);
            ids.collect::<BTreeSet<_>>()
        };
        assert_eq!(sample(1).len(), 20);
        assert_eq!(sample(1), sample(7));
        assert_eq!(hash(("arm", "MoveTest", 1), 1), HASH, "in every version");
    }

    /// Computed by another implementation.
    const HASH: u64 = 17_623_555_025_035_928_104;
}
