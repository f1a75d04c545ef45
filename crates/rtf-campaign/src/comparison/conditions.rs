//! Versions compared by the values of a parameter.

use rtf_statistics::Difference;
use serde::Serialize;
use thiserror::Error;

use super::matched::Matched;
use super::{ComparedEpisode, Pairing, Significance, VersionRate, adjust};
use crate::analysis::value;
use crate::axis::Axis;

/// The comparisons for each value of a parameter. Their p values are exploratory: adjusted among
/// all of them, apart from the claims about the versions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ByCondition {
    pub parameter: String,
    /// In the order of the values.
    pub conditions: Vec<Condition>,
}

/// The episodes with some values.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Condition {
    /// The value, or the range of values.
    pub values: String,
    /// Each further version, compared with the first one.
    pub comparisons: Vec<ConditionComparison>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConditionComparison {
    /// The number of the further version, from 2.
    pub version: usize,
    pub first: VersionRate,
    pub second: VersionRate,
    /// `None` if a version has no result.
    pub difference: Option<Difference>,
    #[serde(flatten)]
    pub significance: Significance,
}

/// A version has no such parameter.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("version {version} has no parameter `{name}`")]
pub struct UnknownParameter {
    /// The number of the version, from 1.
    pub version: usize,
    pub name: String,
    /// The parameters that it has.
    pub known: Vec<String>,
}

/// Compares the versions for each value of a parameter. Versions in pairs with the first one have
/// its values.
pub(super) fn by_parameter(
    name: &str,
    versions: &[Vec<ComparedEpisode>],
    matched: &[(Pairing, Matched<'_>)],
) -> Result<ByCondition, UnknownParameter> {
    let mut values = Vec::new();
    for (index, episodes) in versions.iter().enumerate() {
        let is_paired = index > 0 && matched[index - 1].1.is_paired();
        for episode in episodes.iter().filter(|_| !is_paired) {
            let unknown = || UnknownParameter {
                version: index + 1,
                name: name.to_owned(),
                known: episode.parameters.iter().map(|it| it.name.clone()).collect(),
            };
            values.push(value(&episode.parameters, name).ok_or_else(unknown)?);
        }
    }
    let axis = Axis::new(&values);
    let condition = |(place, label): (usize, &String)| {
        let is_met = |episode: &ComparedEpisode| {
            axis.place(value(&episode.parameters, name).unwrap_or_default()) == place
        };
        let comparison = |((_, matched), version): (&(Pairing, Matched<'_>), usize)| {
            let matched = matched.within(is_met);
            let ([first, second], results) = (matched.rates(), matched.results());
            let (difference, significance) = (results.difference, results.significance);
            ConditionComparison { version, first, second, difference, significance }
        };
        let comparisons = matched.iter().zip(2..).map(comparison).collect();
        Condition { values: label.clone(), comparisons }
    };
    let mut conditions: Vec<_> = axis.labels.iter().enumerate().map(condition).collect();
    let comparisons = conditions.iter_mut().flat_map(|it| &mut it.comparisons);
    adjust(comparisons.filter(|it| it.difference.is_some()).map(|it| &mut it.significance));
    Ok(ByCondition { parameter: name.to_owned(), conditions })
}
