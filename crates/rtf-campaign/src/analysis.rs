//! Where a campaign fails: rates by the values of one or two parameters, and which parameters
//! matter.

use rtf_model::{Episode, Parameter};
use rtf_statistics::random::index_below;
use rtf_statistics::{CONFIDENCE, RandomStream, Rate, rate};
use serde::Serialize;

use crate::axis::Axis;
use crate::{EpisodeResult, Ledger};

const PERMUTATIONS: u32 = 999;

/// An episode and whether it passed.
pub type Sample<'a> = (&'a Episode, bool);

/// The rate of the episodes with some values of a parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cell {
    /// The value, or the range of values.
    pub values: String,
    pub episodes: u64,
    pub passed: u64,
    /// The rate with its Wilson interval at 95 % confidence; `None` without episodes.
    pub rate: Option<Rate>,
}

/// The rates by the values of a parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ByParameter {
    pub name: String,
    /// Pearson's X² of the results in the cells: 0 if all cells have the same rate.
    pub chi_square: f64,
    /// The probability of this X² or a larger one if the parameter has no effect: the results are
    /// permuted among the episodes 999 times.
    pub p_value: f64,
    /// The cells, in the order of the values.
    pub cells: Vec<Cell>,
}

/// The rates by the values of two parameters.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FailureMap {
    /// The values of the first parameter.
    pub columns: Vec<String>,
    /// The values of the second parameter, each with its cells in the order of the columns.
    pub rows: Vec<(String, Vec<Cell>)>,
}

/// The episodes with a result.
#[must_use]
pub fn samples<'a>(episodes: &'a [Episode], ledger: &Ledger) -> Vec<Sample<'a>> {
    let results = episodes.iter().zip(ledger.episodes());
    let sample = |(episode, executions): (&'a Episode, &crate::ledger::Executions)| match executions
        .result?
    {
        EpisodeResult::Passed => Some((episode, true)),
        EpisodeResult::Failed => Some((episode, false)),
        EpisodeResult::None => None,
    };
    results.filter_map(sample).collect()
}

/// The rates by each parameter, the one with the largest effect first. `seed` selects the
/// permutations.
#[must_use]
pub fn by_parameters(samples: &[Sample<'_>], seed: u64) -> Vec<ByParameter> {
    let names = samples.first().map_or(&[][..], |(episode, _)| &episode.parameters);
    let mut all: Vec<_> =
        names.iter().map(|parameter| by_parameter(samples, &parameter.name, seed)).collect();
    all.sort_by(|a, b| b.chi_square.total_cmp(&a.chi_square));
    all
}

fn by_parameter(samples: &[Sample<'_>], name: &str, seed: u64) -> ByParameter {
    let (axis, places) = places(samples, name);
    let mut results: Vec<bool> = samples.iter().map(|(_, passed)| *passed).collect();
    let chi_square = chi_square(&places, &results, axis.labels.len());
    let mut random = RandomStream::new(seed, "permutation-of-results", name).sequence();
    let mut as_large = 0_u32;
    for _ in 0..PERMUTATIONS {
        for index in (1..results.len()).rev() {
            results.swap(index, index_below(random.next().unwrap_or_default(), index + 1));
        }
        let permuted = self::chi_square(&places, &results, axis.labels.len());
        as_large += u32::from(permuted >= chi_square * (1.0 - 1e-12));
    }
    let p_value = f64::from(1 + as_large) / f64::from(1 + PERMUTATIONS);
    let cells = (0..axis.labels.len()).map(|place| {
        let inside = || samples.iter().zip(&places).filter(|(_, at)| **at == place);
        let (episodes, passed) = (inside().count(), inside().filter(|((_, it), _)| *it).count());
        cell(axis.labels[place].clone(), episodes, passed)
    });
    ByParameter { name: name.to_owned(), chi_square, p_value, cells: cells.collect() }
}

/// The rates by two parameters. `None` if one of them does not exist.
#[must_use]
pub fn failure_map(samples: &[Sample<'_>], x: &str, y: &str) -> Option<FailureMap> {
    let known = |name: &str| {
        let (episode, _) = samples.first()?;
        episode.parameters.iter().any(|parameter| parameter.name == name).then_some(())
    };
    known(x).and(known(y))?;
    let ((columns, columns_of), (rows, rows_of)) = (places(samples, x), places(samples, y));
    let mut counts = vec![vec![(0, 0); columns.labels.len()]; rows.labels.len()];
    for ((_, passed), (row, column)) in samples.iter().zip(rows_of.iter().zip(&columns_of)) {
        let (all, green) = &mut counts[*row][*column];
        *all += 1;
        *green += usize::from(*passed);
    }
    let row = |(label, counts): (String, Vec<(usize, usize)>)| {
        let cells = columns.labels.iter().zip(counts);
        (label, cells.map(|(column, (all, green))| cell(column.clone(), all, green)).collect())
    };
    let rows = rows.labels.clone().into_iter().zip(counts).map(row).collect();
    Some(FailureMap { rows, columns: columns.labels })
}

/// The values of a parameter, and the place of each episode among them.
fn places(samples: &[Sample<'_>], name: &str) -> (Axis, Vec<usize>) {
    let values = samples.iter().map(|(episode, _)| value(&episode.parameters, name));
    let values: Vec<&str> = values.map(Option::unwrap_or_default).collect();
    let axis = Axis::new(&values);
    let places = values.iter().map(|text| axis.place(text)).collect();
    (axis, places)
}

/// The value of a parameter.
pub(crate) fn value<'a>(parameters: &'a [Parameter], name: &str) -> Option<&'a str> {
    let is_named = |parameter: &&Parameter| parameter.name == name;
    parameters.iter().find(is_named).map(|parameter| parameter.value.as_str())
}

fn cell(values: String, episodes: usize, passed: usize) -> Cell {
    let (episodes, passed) = (episodes as u64, passed as u64);
    Cell { values, episodes, passed, rate: rate(passed, episodes, CONFIDENCE) }
}

#[expect(clippy::cast_precision_loss, reason = "numbers of episodes are far below 2^53")]
fn chi_square(places: &[usize], results: &[bool], cells: usize) -> f64 {
    let mut counts = vec![(0_u64, 0_u64); cells];
    for (place, passed) in places.iter().zip(results) {
        counts[*place].0 += 1;
        counts[*place].1 += u64::from(*passed);
    }
    let passed = results.iter().filter(|passed| **passed).count();
    let total = passed as f64 / results.len().max(1) as f64;
    let term = |(all, green): &(u64, u64)| {
        let (all, green) = (*all as f64, *green as f64);
        (green - all * total).powi(2) / (all * total * (1.0 - total))
    };
    counts.iter().filter(|(all, _)| *all > 0).map(term).filter(|it| it.is_finite()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 200 episodes that fail if `a` is above 0.75; `b` has no effect.
    fn episodes() -> Vec<(Episode, bool)> {
        let parameter = |name: &str, value: String| Parameter { name: name.to_owned(), value };
        let episode = |id: u32| {
            let a = f64::from(id) / 200.0;
            let words = ["10", "9", "wood"];
            let b = words[id as usize % 3].to_owned();
            let parameters = vec![parameter("b", b), parameter("a", a.to_string())];
            (Episode { id: id.into(), seed: 0, parameters, masked: Vec::new() }, a <= 0.75)
        };
        (1..=200).map(episode).collect()
    }

    fn samples(episodes: &[(Episode, bool)]) -> Vec<Sample<'_>> {
        episodes.iter().map(|(episode, passed)| (episode, *passed)).collect()
    }

    #[test]
    fn the_parameter_with_an_effect_comes_first() {
        let episodes = episodes();
        let found = by_parameters(&samples(&episodes), 7);
        assert_eq!((found[0].name.as_str(), found[1].name.as_str()), ("a", "b"));
        assert!(found[0].p_value <= 0.001, "{found:?}");
        assert!(found[1].p_value > 0.05, "{found:?}");
        let counts: Vec<_> = found[0].cells.iter().map(|it| (it.episodes, it.passed)).collect();
        assert_eq!(counts.iter().map(|(all, _)| all).sum::<u64>(), 200);
        assert_eq!(counts.iter().map(|(_, passed)| passed).sum::<u64>(), 150);
        assert_eq!((counts[0].0, counts[0].1, counts[5].1), (34, 34, 0));
        let labels: Vec<_> = found[1].cells.iter().map(|it| it.values.as_str()).collect();
        assert_eq!(labels, ["9", "10", "wood"], "numbers come first, in their order");
    }

    #[test]
    fn a_map_has_the_rates_of_two_parameters() {
        let episodes = episodes();
        let map = failure_map(&samples(&episodes), "a", "b").unwrap();
        assert_eq!((map.columns.len(), map.rows.len()), (6, 3));
        let all: u64 = map.rows.iter().flat_map(|(_, cells)| cells).map(|it| it.episodes).sum();
        assert_eq!(all, 200);
        assert!(map.rows.iter().all(|(_, cells)| cells[5].passed == 0));
        assert_eq!(failure_map(&samples(&episodes), "a", "c"), None);
        assert_eq!(failure_map(&[], "a", "b"), None);
    }

    #[test]
    fn without_failures_nothing_has_an_effect() {
        let episodes = episodes();
        let passed: Vec<_> = episodes.iter().map(|(episode, _)| (episode, true)).collect();
        let found = by_parameters(&passed, 7);
        assert!(found.iter().all(|it| it.chi_square == 0.0 && it.p_value == 1.0), "{found:?}");
        assert!(by_parameters(&[], 7).is_empty());
    }
}
