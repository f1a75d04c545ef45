//! The list of episodes as JSON lines.

use rtf_model::Parameter;
use serde::de::{MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A run of the suite with its parameters.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Episode {
    /// The number, from 1.
    pub id: u64,
    /// For the suite's random numbers: from 0 to 2³¹ − 1.
    pub seed: u32,
    /// The parameters, in the order of the campaign file.
    #[serde(serialize_with = "write_parameters", deserialize_with = "read_parameters")]
    pub parameters: Vec<Parameter>,
}

/// All episodes of a campaign.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EpisodeList {
    /// The episodes, in the order of their ids.
    pub episodes: Vec<Episode>,
}

impl EpisodeList {
    /// Returns the list as it is stored: a line of JSON for each episode.
    #[must_use]
    pub fn to_json_lines(&self) -> String {
        let mut lines = String::new();
        for episode in &self.episodes {
            // Numbers and texts always serialise.
            lines += &serde_json::to_string(episode).unwrap_or_default();
            lines.push('\n');
        }
        lines
    }

    /// Reads a stored list.
    ///
    /// # Errors
    /// A line is not an episode: its number, from 1, and the reason.
    pub fn from_json_lines(text: &str) -> Result<Self, (usize, serde_json::Error)> {
        let lines = text.lines().zip(1..);
        let episode = |(line, number)| serde_json::from_str(line).map_err(|error| (number, error));
        Ok(Self { episodes: lines.map(episode).collect::<Result<_, _>>()? })
    }
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
