//! `judgement.json`: how a campaign ended.

use std::path::Path;

use jiff::Timestamp;
use rtf_campaign::Judgement;
use rtf_history::entry::CampaignEnd;
use serde::{Deserialize, Serialize};

/// The name of the file.
pub const JUDGEMENT: &str = "judgement.json";

/// The end of a campaign.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Judged {
    /// When it ended.
    pub ended_at: Timestamp,
    /// How it ended.
    pub end: CampaignEnd,
    /// The judgement of its results.
    pub judgement: Judgement,
}

impl Judged {
    /// Reads the file. `None` if the campaign was killed, or has not ended.
    pub fn read(dir: &Path) -> Option<Self> {
        let text = std::fs::read_to_string(dir.join(JUDGEMENT)).ok()?;
        serde_json::from_str(&text).ok()
    }
}
