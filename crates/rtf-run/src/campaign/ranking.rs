//! The worst episodes of a campaign, and the best ones.

use std::collections::BTreeMap;

use rtf_model::{Episode, EpisodeOutcome};
use rtf_report::episode_results::EpisodeLine;
use rtf_web::{EpisodeRanking, EpisodeRun, RankedEpisode};

/// The number of episodes at each end.
const RANKED: usize = 5;
/// The number of measurements.
const MEASUREMENTS: usize = 20;
const DURATION: &str = "duration";

/// The first result of each episode that is not the bench's.
#[derive(Debug, Default)]
pub(super) struct Ranking {
    results: BTreeMap<u64, (EpisodeLine, EpisodeRun)>,
}

/// An episode that passed or not, with the value by which it is ordered.
type Valued<'a> = (&'a EpisodeLine, &'a EpisodeRun, f64);

impl Ranking {
    /// Adds a result of an episode.
    pub fn add(&mut self, line: EpisodeLine, run: EpisodeRun) {
        if line.outcome.is_some_and(|outcome| !outcome.is_of_bench()) {
            self.results.entry(line.episode).or_insert((line, run));
        }
    }

    /// By duration and by each measurement.
    pub fn rankings(&self, episodes: &[Episode]) -> Vec<EpisodeRanking> {
        if self.results.len() < 2 {
            return Vec::new();
        }
        let seconds = |line: &EpisodeLine| std::time::Duration::from_micros(line.duration_us);
        let by_duration = self.results.values();
        let by_duration = by_duration.map(|(line, run)| (line, run, seconds(line).as_secs_f64()));
        let mut rankings = vec![ranking((DURATION, "s"), true, by_duration.collect(), episodes)];
        let mut measured: BTreeMap<(String, &str), Vec<Valued<'_>>> = BTreeMap::new();
        for (line, run) in self.results.values() {
            for it in &line.measurements {
                let Some(value) = it.value.filter(|value| value.is_finite()) else { continue };
                let values =
                    measured.entry((format!("{} {}", it.test, it.name), &it.unit)).or_default();
                // Of several values of an episode, the first one counts.
                if values.last().is_none_or(|(last, ..)| last.episode != line.episode) {
                    values.push((line, run, value));
                }
            }
        }
        for ((name, unit), values) in measured.into_iter().take(MEASUREMENTS) {
            if values.len() > 1 {
                let higher_is_worse = is_higher_worse(&values);
                rankings.push(ranking((&name, unit), higher_is_worse, values, episodes));
            }
        }
        rankings
    }
}

fn has_passed(line: &EpisodeLine) -> bool {
    line.outcome == Some(EpisodeOutcome::Passed)
}

/// Whether failed episodes have a higher value on average, or no episode failed or passed.
fn is_higher_worse(values: &[Valued<'_>]) -> bool {
    let mean = |passed: bool| {
        let values = values.iter().filter(|(line, ..)| has_passed(line) == passed);
        let (sum, count) = values.fold((0.0, 0), |(sum, count), it| (sum + it.2, count + 1_u32));
        sum / f64::from(count)
    };
    // NaN without one of them.
    mean(false).partial_cmp(&mean(true)) != Some(std::cmp::Ordering::Less)
}

fn ranking(
    (by, unit): (&str, &str),
    higher_is_worse: bool,
    mut values: Vec<Valued<'_>>,
    episodes: &[Episode],
) -> EpisodeRanking {
    values.sort_by(|(a, _, first), (b, _, second)| {
        let order = match higher_is_worse {
            true => second.total_cmp(first),
            false => first.total_cmp(second),
        };
        has_passed(a).cmp(&has_passed(b)).then(order)
    });
    let shown = |(line, run, value): &Valued<'_>| {
        let episode =
            usize::try_from(line.episode).ok().and_then(|id| episodes.get(id.checked_sub(1)?));
        let parameters = episode.map(|it| &it.parameters[..]).unwrap_or_default();
        RankedEpisode {
            episode: line.episode,
            outcome: if has_passed(line) { "passed" } else { "failed" }.to_owned(),
            value: *value,
            parameters: parameters.iter().map(|it| (it.name.clone(), it.value.clone())).collect(),
            run: (*run).clone(),
        }
    };
    let count = RANKED.min(values.len() / 2);
    EpisodeRanking {
        by: by.to_owned(),
        unit: unit.to_owned(),
        higher_is_worse,
        worst: values[..count].iter().map(shown).collect(),
        best: values.iter().rev().take(count).map(shown).collect(),
    }
}

#[cfg(test)]
mod tests {
    use rtf_model::Parameter;
    use rtf_report::episode_results::EpisodeMeasurement;

    use super::*;

    /// Twelve episodes, of which every fourth fails; the error of failed ones is `error` larger.
    fn ranking(error: f64) -> (Ranking, Vec<Episode>) {
        let mut ranking = Ranking::default();
        let mut episodes = Vec::new();
        for id in 1..=12_u64 {
            let failed = id % 4 == 0;
            let (name, value) = ("payload".to_owned(), id.to_string());
            episodes.push(Episode {
                id,
                seed: 0,
                parameters: vec![Parameter { name, value }],
                masked: Vec::new(),
            });
            let value = Some(f64::from(id as u32) + if failed { error } else { 0.0 });
            let (test, name, unit) = ("Carry".to_owned(), "error".to_owned(), "rad".to_owned());
            let line = EpisodeLine {
                episode: id,
                outcome: Some(match failed {
                    true => EpisodeOutcome::Failed,
                    false => EpisodeOutcome::Passed,
                }),
                duration_us: 1_000_000 * id,
                measurements: vec![EpisodeMeasurement { test, name, unit, value }],
                ..EpisodeLine::default()
            };
            let bench = EpisodeLine { outcome: Some(EpisodeOutcome::Error), ..line.clone() };
            ranking.add(bench, run(0));
            ranking.add(line, run(id));
        }
        (ranking, episodes)
    }

    fn run(id: u64) -> EpisodeRun {
        EpisodeRun { run: format!("run {id}"), test: Some(0), attempt: None }
    }

    fn ids(episodes: &[RankedEpisode]) -> Vec<u64> {
        assert!(episodes.iter().all(|it| it.run == run(it.episode)), "{episodes:?}");
        assert!(episodes.iter().all(|it| it.parameters["payload"] == it.episode.to_string()));
        episodes.iter().map(|it| it.episode).collect()
    }

    #[test]
    fn failed_episodes_are_the_worst_and_values_decide_among_equal_results() {
        let (ranking, episodes) = ranking(50.0);
        let found = ranking.rankings(&episodes);
        let names: Vec<_> = found.iter().map(|it| (&*it.by, &*it.unit)).collect();
        assert_eq!(names, [("duration", "s"), ("Carry error", "rad")]);
        for it in &found {
            assert!(it.higher_is_worse);
            assert_eq!(ids(&it.worst), [12, 8, 4, 11, 10], "{}", it.by);
            assert_eq!(ids(&it.best), [1, 2, 3, 5, 6], "{}", it.by);
        }
    }

    #[test]
    fn a_measurement_that_is_lower_in_failed_episodes_is_better_if_it_is_higher() {
        let (ranking, episodes) = ranking(-50.0);
        let found = &ranking.rankings(&episodes)[1];
        assert!(!found.higher_is_worse);
        assert_eq!(ids(&found.worst), [4, 8, 12, 1, 2]);
        assert_eq!(ids(&found.best), [11, 10, 9, 7, 6]);
    }

    #[test]
    fn one_episode_has_no_ranking() {
        let mut ranking = Ranking::default();
        let outcome = Some(EpisodeOutcome::Passed);
        ranking.add(EpisodeLine { episode: 1, outcome, ..EpisodeLine::default() }, run(1));
        assert!(ranking.rankings(&[]).is_empty());
    }
}
