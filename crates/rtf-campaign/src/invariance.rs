//! Whether results depend on how episodes are run: the same episodes in other ways, compared with one
//! after the other. That is the only way without chance: which episodes run at the same time depends on
//! the load of the machine.

use std::collections::BTreeMap;

use rtf_statistics::{holm, paired};
use serde::Serialize;

use crate::comparison::ComparedEpisode;

/// The largest relative difference of a number that different orders of arithmetic explain.
const ARITHMETIC: f64 = 1e-3;
/// The most episodes that are listed.
const LISTED: usize = 10;

/// A way to run the episodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Variation {
    /// As before.
    Again,
    /// Several at a time.
    ManySlots,
    /// The last one first.
    OtherOrder,
    /// On two workers.
    TwoWorkers,
    /// Several at a time; vector environments that are synchronous are asynchronous, and the other way
    /// round.
    OtherMode,
}

impl Variation {
    pub const ALL: [Self; 5] =
        [Self::Again, Self::OtherOrder, Self::ManySlots, Self::TwoWorkers, Self::OtherMode];
}

/// What is different from the first time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VariationResult {
    pub variation: Variation,
    /// How many episodes have a result both times.
    pub episodes: usize,
    /// How many of them have another result, and the first ones.
    pub changed: usize,
    pub examples: Vec<u64>,
    /// How many begin with another observation, of those whose test reported it both times.
    pub begin_differently: usize,
    /// How many have another value of a measurement.
    pub measure_differently: usize,
    /// McNemar's test, adjusted by Holm's method; `None` if results are exact.
    pub p_value: Option<f64>,
    /// Whether the variation changes results.
    pub changes_results: bool,
}

/// The probable cause of different results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// The first observation of an episode is no function of its seed.
    SeedIgnored,
    /// All numbers differ a little.
    BatchArithmetic,
    /// An episode depends on those that run at the same time.
    SharedBetweenSlots,
    /// An episode depends on those that ran before it.
    StateOutlivesEpisodes,
    /// The environments depend on how they are run: in one process or in several.
    SharedInProcess,
    /// Workers that run at the same time affect each other.
    SharedBetweenWorkers,
    /// Results are not the same twice.
    Chance,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Invariance {
    /// Whether the same way twice gives the same results, so that any change counts.
    pub is_exact: bool,
    pub variations: Vec<VariationResult>,
    pub causes: Vec<Cause>,
}

impl Invariance {
    /// Whether results depend on how the episodes are run.
    #[must_use]
    pub fn any_change(&self) -> bool {
        !self.causes.is_empty()
    }
}

/// The episodes of the first time and of a variation.
struct Compared {
    result: VariationResult,
    /// Episodes that passed the first time only, and the second time only.
    discordant: [u64; 2],
    /// The largest relative difference of a measurement.
    largest: f64,
}

impl Compared {
    fn is_same(&self) -> bool {
        let VariationResult { changed, begin_differently, measure_differently, .. } = self.result;
        (changed, begin_differently, measure_differently) == (0, 0, 0)
    }
}

/// Compares each variation with the first time. `confirmation`: the first way once more, because a few
/// results can be the same by luck. `alpha`: the probability of any wrong claim about results that are not
/// the same twice.
#[must_use]
pub fn judge(
    first: &[ComparedEpisode],
    variations: &[(Variation, Vec<ComparedEpisode>)],
    confirmation: Option<&[ComparedEpisode]>,
    alpha: f64,
) -> Invariance {
    let mut all: Vec<Compared> =
        variations.iter().map(|(variation, second)| compare(*variation, first, second)).collect();
    let again = all.iter().find(|it| it.result.variation == Variation::Again);
    let is_exact = again.is_some_and(Compared::is_same)
        && confirmation.is_none_or(|third| compare(Variation::Again, first, third).is_same());
    if is_exact {
        all.iter_mut().for_each(|it| it.result.changes_results = it.result.changed > 0);
    } else {
        let p_values = all.iter().map(|it| paired::mcnemar(it.discordant[0], it.discordant[1]));
        let p_values: Vec<f64> = p_values.map(|it| it.p_value).collect();
        for (it, adjusted) in all.iter_mut().zip(holm(&p_values)) {
            it.result.p_value = Some(adjusted);
            it.result.changes_results = adjusted <= alpha;
        }
    }
    let causes = causes(&all, is_exact);
    Invariance { is_exact, variations: all.into_iter().map(|it| it.result).collect(), causes }
}

fn compare(
    variation: Variation,
    first: &[ComparedEpisode],
    second: &[ComparedEpisode],
) -> Compared {
    let second: BTreeMap<u64, &ComparedEpisode> = second.iter().map(|it| (it.id, it)).collect();
    let mut result = VariationResult {
        variation,
        episodes: 0,
        changed: 0,
        examples: Vec::new(),
        begin_differently: 0,
        measure_differently: 0,
        p_value: None,
        changes_results: false,
    };
    let (mut discordant, mut largest) = ([0, 0], 0.0_f64);
    for one in first {
        let Some(other) = second.get(&one.id) else { continue };
        let (Some(before), Some(after)) = (one.passed, other.passed) else { continue };
        result.episodes += 1;
        if before != after {
            result.changed += 1;
            discordant[usize::from(after)] += 1;
            if result.examples.len() < LISTED {
                result.examples.push(one.id);
            }
        }
        let both = one.first_observation.as_ref().zip(other.first_observation.as_ref());
        result.begin_differently += usize::from(both.is_some_and(|(a, b)| a != b));
        let difference = largest_difference(one, other);
        result.measure_differently += usize::from(difference > 0.0);
        largest = largest.max(difference);
    }
    Compared { result, discordant, largest }
}

/// The largest relative difference of a measurement.
fn largest_difference(one: &ComparedEpisode, other: &ComparedEpisode) -> f64 {
    let both = one.values.iter().filter_map(|(key, a)| Some((*a, *other.values.get(key)?)));
    let relative = |(a, b): (f64, f64)| match (a - b).abs() {
        0.0 => 0.0,
        distance => distance / a.abs().max(b.abs()),
    };
    both.map(relative).fold(0.0, f64::max)
}

/// What probably explains the changes, the most certain cause only.
fn causes(all: &[Compared], is_exact: bool) -> Vec<Cause> {
    if all.iter().any(|it| it.result.begin_differently > 0) {
        return vec![Cause::SeedIgnored];
    }
    let changes = |wanted| {
        let mut of_kind = all.iter().filter(|it| it.result.variation == wanted);
        of_kind.any(|it| it.result.changes_results)
    };
    if changes(Variation::Again) {
        return vec![Cause::Chance];
    }
    let is_arithmetic = |it: &Compared| {
        let is_batch = it.result.variation == Variation::ManySlots;
        is_exact && is_batch && it.result.measure_differently > 0 && it.largest < ARITHMETIC
    };
    let mut causes = Vec::new();
    if changes(Variation::OtherOrder) {
        causes.push(Cause::StateOutlivesEpisodes);
    } else if changes(Variation::ManySlots) {
        let arithmetic = all.iter().any(is_arithmetic);
        causes.push(if arithmetic { Cause::BatchArithmetic } else { Cause::SharedBetweenSlots });
    } else if changes(Variation::OtherMode) {
        causes.push(Cause::SharedInProcess);
    } else if changes(Variation::TwoWorkers) {
        causes.push(Cause::SharedBetweenWorkers);
    }
    causes
}

#[cfg(test)]
mod tests;
