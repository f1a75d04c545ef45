//! Episodes of a campaign.

use serde::de::{MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::Parameter;
use crate::{FixtureProvided, SuiteId};

/// A run of a suite with its parameters.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Episode {
    /// The number, from 1.
    pub id: u64,
    /// For the suite's random numbers: from 0 to 2³¹ − 1.
    pub seed: u32,
    /// The parameters, in the order of the campaign file.
    #[serde(serialize_with = "write_parameters", deserialize_with = "read_parameters")]
    #[cfg_attr(feature = "schema", schemars(with = "std::collections::BTreeMap<String, String>"))]
    pub parameters: Vec<Parameter>,
    /// Whether a test with slots runs no other one at the same time.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub alone: bool,
    /// Texts that are not shown, because trials are blinded: the versions, the longest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub masked: Vec<String>,
}

impl Episode {
    /// An episode that may run at the same time as others.
    #[must_use]
    pub fn new(id: u64, seed: u32, parameters: Vec<Parameter>) -> Self {
        Self { id, seed, parameters, alone: false, masked: Vec::new() }
    }

    /// Replaces what is not shown.
    #[must_use]
    pub fn mask(&self, text: &str) -> String {
        masked(text, &self.masked)
    }
}

/// The episode that a case of a test with slots is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CaseEpisode {
    /// The number, from 1.
    pub id: u64,
    /// For its random numbers. The runner adds it.
    #[serde(default)]
    pub seed: u32,
}

/// What a test with slots reports about an episode that has ended.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EpisodeEnd {
    /// How many steps it took.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub steps: Option<u64>,
    /// Its duration in simulated time, in microseconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_us: Option<u64>,
    /// The same text for the same first observation, such as its hash.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_observation: Option<String>,
}

/// Replaces each of these texts.
#[must_use]
pub fn masked(text: &str, hidden: &[String]) -> String {
    let hide = |text: String, it: &String| text.replace(it, FixtureProvided::SECRET);
    hidden.iter().filter(|it| !it.is_empty()).fold(text.to_owned(), hide)
}

/// An episode starts: what happens in the suite until `episode-finished` belongs to it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EpisodeStarted {
    /// The suite.
    pub suite: SuiteId,
    /// The episode.
    pub episode: Episode,
}

fn write_parameters<S: Serializer>(
    parameters: &[Parameter],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(parameters.len()))?;
    for parameter in parameters {
        map.serialize_entry(&parameter.name, &parameter.value)?;
    }
    map.end()
}

fn read_parameters<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Parameter>, D::Error> {
    struct InOrder;
    impl<'de> Visitor<'de> for InOrder {
        type Value = Vec<Parameter>;

        fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str("an object with the values of parameters")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
            let mut parameters = Vec::new();
            while let Some((name, value)) = map.next_entry()? {
                parameters.push(Parameter { name, value });
            }
            Ok(parameters)
        }
    }
    deserializer.deserialize_map(InOrder)
}
