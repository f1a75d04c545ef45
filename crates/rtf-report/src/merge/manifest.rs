//! What the merged run was asked for, and whether a part of it is missing.

use jiff::Timestamp;
use rtf_model::{Manifest, RunStarted};

use super::{MergeProblem, count};

/// The beginnings of the runs, as far as the merged run needs them.
#[derive(Debug, Default)]
pub(super) struct JoinedManifests {
    divisions: Vec<Division>,
    ids: Vec<String>,
    /// The time of day that is the earliest; of those that are none, the first.
    pub started_at: String,
    /// That of the first run.
    pub working_dir: String,
}

/// Runs that were asked for the same but for their part.
#[derive(Debug)]
struct Division {
    /// Without a part.
    manifest: Manifest,
    of: Option<u32>,
    parts: Vec<u32>,
    tests: u32,
}

impl JoinedManifests {
    pub fn add(&mut self, run: &RunStarted) {
        if self.ids.is_empty() {
            self.started_at = run.started_at.clone();
            self.working_dir = run.working_dir.clone();
        } else if instant(&run.started_at) < instant(&self.started_at) {
            self.started_at = run.started_at.clone();
        }
        self.ids.push(run.id());
        self.add_to_division(run);
    }

    /// The places of an earlier run and of this one, if they are the same run.
    pub fn same_run(&self, place: usize) -> Option<[usize; 2]> {
        let id = self.ids.get(place)?;
        let first = self.ids.iter().position(|other| other == id)?;
        (first < place).then_some([first, place])
    }

    fn add_to_division(&mut self, run: &RunStarted) {
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
        match self.divisions.iter_mut().find(same) {
            Some(division) => {
                division.parts.extend(part);
                division.tests += run.tests;
            }
            None => {
                let (parts, tests) = (part.into_iter().collect(), run.tests);
                self.divisions.push(Division { manifest, of, parts, tests });
            }
        }
    }

    /// Parts of divisions that are not among the runs.
    pub fn missing(&self) -> impl Iterator<Item = MergeProblem> {
        self.divisions.iter().filter_map(Division::missing)
    }

    /// The manifest of the merged run, which has this number of tests.
    pub fn manifest(&self, tests: usize) -> Manifest {
        let any = |is_set: fn(&Manifest) -> bool| {
            self.divisions.iter().any(|division| is_set(&division.manifest))
        };
        // What was asked for in different ways cannot be asked for again as one.
        let manifest = match self.divisions.as_slice() {
            [one] => Manifest { shard_assignment: None, ..one.manifest.clone() },
            _ => Manifest {
                flaky_fails: any(|manifest| manifest.flaky_fails),
                no_skips: any(|manifest| manifest.no_skips),
                ..Manifest::default()
            },
        };
        let selected_from =
            if manifest.selected_from > count(tests) { manifest.selected_from } else { 0 };
        Manifest { selected_from, parts: self.ids.clone(), ..manifest }
    }
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

/// Orders times of day; what is none comes last.
fn instant(time: &str) -> (bool, Timestamp) {
    time.parse().map_or((true, Timestamp::MAX), |at| (false, at))
}
