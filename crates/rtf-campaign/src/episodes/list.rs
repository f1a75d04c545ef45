//! The list of episodes as JSON lines.

use rtf_model::Episode;

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
