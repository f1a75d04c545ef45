//! Several versions: which of them differ from the first one, and by how much.
//!
//! - `matched`: episodes in pairs, or as independent samples, and the tests of both.
//! - `conditions`: the same by the values of a parameter.

mod conditions;
mod matched;

use std::collections::BTreeMap;

use rtf_model::Parameter;
use rtf_statistics::{CONFIDENCE, Difference, PairCounts, Rate, holm, rate};
use serde::Serialize;

pub use conditions::{ByCondition, Condition, ConditionComparison, UnknownParameter};
use matched::Matched;

/// A measurement: the test, the name and the unit.
pub type MeasurementKey = (String, String, String);

/// An episode of a version: its result, and what it measured. Of several values of a measurement,
/// the first one counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ComparedEpisode {
    pub id: u64,
    /// `None`: the episode cannot be found in the other version.
    pub seed: Option<u64>,
    pub parameters: Vec<Parameter>,
    /// `None` without a result.
    pub passed: Option<bool>,
    /// The same text for the same first observation, if it is known.
    pub first_observation: Option<String>,
    /// Finite values.
    pub values: BTreeMap<MeasurementKey, f64>,
}

/// How versions are compared.
#[derive(Clone, Copy, Debug)]
pub struct Options<'a> {
    /// The probability of any wrong claim.
    pub alpha: f64,
    /// The parameter whose values are the conditions.
    pub by: Option<&'a str>,
    /// Selects the permutations.
    pub seed: u64,
}

/// The first version and the others.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    pub alpha: f64,
    pub versions: Vec<VersionRate>,
    /// Each further version, compared with the first one.
    pub comparisons: Vec<VersionComparison>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by: Option<ByCondition>,
}

/// How often a version passed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct VersionRate {
    pub passed: u64,
    pub failed: u64,
    pub without_result: u64,
    /// With its Wilson interval at 95 % confidence; `None` if no episode has a result.
    pub rate: Option<Rate>,
}

impl VersionRate {
    fn of<'a>(episodes: impl Iterator<Item = &'a ComparedEpisode>) -> Self {
        let (mut passed, mut failed, mut without_result) = (0, 0, 0);
        for episode in episodes {
            match episode.passed {
                Some(true) => passed += 1,
                Some(false) => failed += 1,
                None => without_result += 1,
            }
        }
        Self { passed, failed, without_result, rate: rate(passed, passed + failed, CONFIDENCE) }
    }
}

/// Whether two versions are compared episode by episode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pairing {
    /// Both have the same episodes.
    Pairs,
    /// Independent: an episode has no seed.
    WithoutSeeds,
    /// Independent: the ids or seeds differ.
    OtherEpisodes,
}

/// The claim about a version.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Finding {
    Worse,
    Better,
    /// Not that both are equal.
    Undecided,
}

/// A p value, and that after Holm's adjustment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Significance {
    pub p_value: f64,
    pub adjusted: f64,
}

impl From<f64> for Significance {
    fn from(p_value: f64) -> Self {
        Self { p_value, adjusted: p_value }
    }
}

/// A further version against the first one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VersionComparison {
    /// Its number, from 2.
    pub version: usize,
    pub pairing: Pairing,
    pub finding: Finding,
    pub results: ResultComparison,
    pub measurements: Vec<MeasurementComparison>,
}

/// The rate of a version minus that of the first one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ResultComparison {
    /// In pairs: how often which version passed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pairs: Option<PairCounts>,
    /// In pairs: episodes without a result in one of both.
    pub without_pair: u64,
    /// `None` if a version has no result.
    pub difference: Option<Difference>,
    /// McNemar's test in pairs, otherwise Fisher's.
    #[serde(flatten)]
    pub significance: Significance,
}

/// The mean of a measurement in both versions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeasurementComparison {
    pub test: String,
    pub name: String,
    pub unit: String,
    /// The numbers of values; in pairs, of episodes with a value in both.
    pub counts: [u64; 2],
    /// The mean in the first version.
    pub first: f64,
    /// The mean in the further version.
    pub second: f64,
    /// `None` with fewer than two values.
    pub difference: Option<Difference>,
    /// The permutation test.
    #[serde(flatten)]
    pub significance: Significance,
}

impl Comparison {
    /// Whether a version is worse than the first one.
    #[must_use]
    pub fn any_worse(&self) -> bool {
        self.comparisons.iter().any(|it| it.finding == Finding::Worse)
    }
}

/// Compares each further version with the first one.
///
/// # Errors
/// A version does not have the parameter of the conditions.
pub fn compare(
    versions: &[Vec<ComparedEpisode>],
    options: &Options<'_>,
) -> Result<Comparison, UnknownParameter> {
    let rates = versions.iter().map(|episodes| VersionRate::of(episodes.iter())).collect();
    let (first, further) = versions.split_first().map_or((&[][..], &[][..]), |(a, b)| (a, b));
    let matched: Vec<_> = further.iter().map(|second| Matched::new(first, second)).collect();
    let by = options.by.map(|name| conditions::by_parameter(name, versions, &matched));
    let compared = matched.iter().zip(2..).map(|((pairing, matched), version)| VersionComparison {
        version,
        pairing: *pairing,
        finding: Finding::Undecided,
        results: matched.results(),
        measurements: matched.measurements(options.seed),
    });
    let mut comparisons: Vec<_> = compared.collect();
    adjust(comparisons.iter_mut().map(|it| &mut it.results.significance));
    let measurements = comparisons.iter_mut().flat_map(|it| &mut it.measurements);
    adjust(measurements.map(|it| &mut it.significance));
    for comparison in &mut comparisons {
        comparison.finding = finding(&comparison.results, options.alpha);
    }
    Ok(Comparison { alpha: options.alpha, versions: rates, comparisons, by: by.transpose()? })
}

fn finding(results: &ResultComparison, alpha: f64) -> Finding {
    match results.difference {
        Some(difference) if results.significance.adjusted <= alpha => {
            match difference.value < 0.0 {
                true => Finding::Worse,
                false => Finding::Better,
            }
        }
        _ => Finding::Undecided,
    }
}

/// Adjusts the p values of a family of claims.
fn adjust<'a>(significances: impl Iterator<Item = &'a mut Significance>) {
    let significances: Vec<_> = significances.collect();
    let p_values: Vec<f64> = significances.iter().map(|it| it.p_value).collect();
    for (significance, adjusted) in significances.into_iter().zip(holm(&p_values)) {
        significance.adjusted = adjusted;
    }
}
