//! What the merged run was asked for, and whether a part of it is missing.

use jiff::Timestamp;
use rtf_model::{Manifest, RunStarted};

use super::{MergeInput, MergeProblem, count, started};

/// What the runs were asked for together.
#[derive(Debug)]
pub(super) struct MergedManifest {
    pub manifest: Manifest,
    /// Parts of divisions that are not among the runs.
    pub missing: Vec<MergeProblem>,
}

/// Runs that were asked for the same but for their part.
struct Division {
    /// Without a part.
    manifest: Manifest,
    of: Option<u32>,
    parts: Vec<u32>,
    tests: u32,
}

/// Joins what the runs were asked for; `tests` is how many they have together.
pub(super) fn join(parts: &[MergeInput], tests: usize) -> MergedManifest {
    let divisions = divisions(parts);
    let missing = divisions.iter().filter_map(Division::missing).collect();
    let flaky_fails = divisions.iter().any(|division| division.manifest.flaky_fails);
    let no_skips = divisions.iter().any(|division| division.manifest.no_skips);
    // What was asked for in different ways cannot be asked for again as one.
    let manifest = match divisions.as_slice() {
        [one] => Manifest { shard_assignment: None, ..one.manifest.clone() },
        _ => Manifest { flaky_fails, no_skips, ..Manifest::default() },
    };
    let selected_from =
        if manifest.selected_from > count(tests) { manifest.selected_from } else { 0 };
    let ids = parts.iter().filter_map(started).map(RunStarted::id).collect();
    MergedManifest { manifest: Manifest { selected_from, parts: ids, ..manifest }, missing }
}

fn divisions(parts: &[MergeInput]) -> Vec<Division> {
    let mut divisions: Vec<Division> = Vec::new();
    for run in parts.iter().filter_map(started) {
        let shard = run.manifest.shard.as_deref().and_then(|shard| shard.split_once('/'));
        let shard = shard.and_then(|(part, of)| Some((part.parse().ok()?, of.parse().ok()?)));
        let (part, of) = shard.unzip();
        // The merged run has one suite at a time.
        let asked = Manifest {
            shard: None,
            jobs: None,
            revision: None,
            origin: None,
            parts: Vec::new(),
            ..(*run.manifest).clone()
        };
        let manifest = match (of, asked.selected_from) {
            (Some(_), 0) => Manifest { selected_from: run.tests, ..asked },
            _ => asked,
        };
        let same = |division: &&mut Division| division.manifest == manifest && division.of == of;
        match divisions.iter_mut().find(same) {
            Some(division) => {
                division.parts.extend(part);
                division.tests += run.tests;
            }
            None => {
                let (parts, tests) = (part.into_iter().collect(), run.tests);
                divisions.push(Division { manifest, of, parts, tests });
            }
        }
    }
    divisions
}

impl Division {
    /// A part in which no test is makes no run: that all tests are there shows
    /// that none is missing. Filters hide how many there should be.
    fn missing(&self) -> Option<MergeProblem> {
        let of = self.of?;
        let all = self.manifest.filters.is_empty() && self.manifest.only.is_none();
        let parts: Vec<_> = (1..=of).filter(|part| !self.parts.contains(part)).collect();
        let complete = parts.is_empty() || (all && self.tests >= self.manifest.selected_from);
        (!complete).then_some(MergeProblem::Missing { parts, of })
    }
}

/// The time of day that is the earliest; of those that are none, the first.
pub(super) fn earliest<'a>(times: impl Iterator<Item = &'a str>) -> String {
    let instant =
        |time: &&str| time.parse::<Timestamp>().map_or((true, Timestamp::MAX), |at| (false, at));
    times.min_by_key(instant).unwrap_or_default().to_owned()
}
