//! `rtf campaign invariance`: planted defects are found with their cause, and a clean test has none.

use serde_json::Value;

use crate::support::{Folder, nothing_left, number};

/// A vector of walks, one for each slot. The argument plants a defect.
const WALKS: &str = r#"import random
import time

import rtf


class Walk:
    def __init__(self, slot, defect, shared):
        self.slot, self.defect, self.shared = slot, defect, shared
        self.past = 0.0

    def reset(self, episode):
        ignores = self.defect == "seed" and self.slot == 3
        self.chance = random.Random(time.monotonic_ns() if ignores else episode.seed)
        self.steps, self.x = self.chance.randrange(3, 20), 0.0
        if self.defect == "earlier":
            self.x = self.past
        return f"{self.chance.random():.6f}"

    def step(self):
        self.x += self.chance.uniform(-1, 1)
        if self.defect == "slots":
            self.x += 0.1 * sum(walk.x for walk in self.shared if walk is not self)
        if self.defect == "arithmetic":
            self.x += 1e-6 * len(self.shared)
        if self.defect == "chance":
            self.x += random.gauss(0, 0.3)
        self.steps -= 1
        self.past = self.x
        return self.steps <= 0


class Walks(rtf.EpisodeTest):
    def run(self):
        # The walks that run at the same time.
        shared = []
        free = [Walk(slot, self.param, shared) for slot in range(self.slots)]
        running = []
        while True:
            started = self.take(len(free), wait=not running) if free else []
            if not started and not running:
                return
            for episode in started:
                walk = free.pop(0)
                running.append((episode, walk, walk.reset(episode)))
                shared.append(walk)
            for entry in [entry for entry in running if entry[1].step()]:
                episode, walk, first = entry
                running.remove(entry)
                shared.remove(walk)
                free.append(walk)
                with episode:
                    self.measure("x", walk.x, "m")
                episode.finish(abs(walk.x) < 1.0, first_observation=first)
"#;

fn invariance(defect: &str, seed: u64) -> Value {
    let folder = Folder::new();
    folder.file("Walks.py", WALKS);
    folder.file(
        "walks.xml",
        &format!("<suite name='walks'><test slots='8' param='{defect}'>Walks.py</test></suite>"),
    );
    folder.file(
        "campaign.xml",
        &format!(
            "<campaign suite='walks.xml' episodes='200' seed='{seed}'>\
             <claim require='rate &gt;= 0.1' confidence='0.6'/></campaign>"
        ),
    );
    let finished = folder.rtf(&["campaign", "invariance", "campaign.xml", "--format", "json"]);
    let document: Value = serde_json::from_str(&finished.stdout)
        .unwrap_or_else(|error| panic!("{error}: {}{}", finished.stdout, finished.stderr));
    let found = document["invariance"].clone();
    let expected = i32::from(found["causes"].as_array().is_some_and(|causes| !causes.is_empty()));
    assert_eq!(finished.code, Some(expected), "{}", finished.stderr);
    assert!(nothing_left(&folder));
    found
}

/// How many of some campaigns have this cause. `RTF_CAMPAIGNS=20` runs more of them.
fn found(defect: &str, cause: Option<&str>) -> (u64, u64) {
    let campaigns = number("RTF_CAMPAIGNS").unwrap_or(1);
    let has_cause = |seed: &u64| {
        let found = invariance(defect, *seed);
        let causes: Vec<_> = found["causes"].as_array().into_iter().flatten().collect();
        causes == cause.map(Value::from).iter().collect::<Vec<_>>()
    };
    ((0..campaigns).filter(has_cause).count() as u64, campaigns)
}

#[test]
fn an_environment_that_ignores_its_seed_is_found() {
    let (found, all) = found("seed", Some("seed-ignored"));
    assert!(found * 20 >= all * 19, "{found} of {all}");
}

#[test]
fn state_that_slots_share_is_found() {
    let (found, all) = found("slots", Some("shared-between-slots"));
    assert!(found * 20 >= all * 19, "{found} of {all}");
}

#[test]
fn a_clean_test_has_no_finding() {
    let (found, all) = found("", None);
    assert_eq!(found, all);
}

#[test]
fn state_that_an_earlier_episode_left_is_found() {
    let found = invariance("earlier", 7);
    let causes = found["causes"].as_array().map(|causes| causes.iter().collect::<Vec<_>>());
    assert_eq!(causes, Some(vec![&Value::from("state-outlives-episodes")]), "{found:#}");
    assert_eq!(found["is_exact"], true);
}

/// Nothing is claimed of results that are not the same twice, unless the difference is large.
#[test]
fn results_that_depend_on_chance_are_compared_in_pairs() {
    let found = invariance("chance", 7);
    assert_eq!(
        (&found["is_exact"], &found["causes"]),
        (&Value::from(false), &Value::from([""; 0].to_vec())),
        "{found:#}"
    );
}
