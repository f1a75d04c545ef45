//! Which campaign it is, where and when it was started, and what it claims: what the history needs
//! although the campaign file may have changed.

use std::fmt::Write as _;
use std::path::Path;

use jiff::Timestamp;
use rtf_campaign::file::{Constraint, DeclaredParameter, Distribution, StoppingRule};
use rtf_campaign::{Campaign, Judge};
use rtf_model::{Origin, Revision};
use rtf_plan::suite::SourceMap;
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

use super::LoadedCampaign;
use crate::origin;
use crate::revision::RevisionQuery;

#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CampaignStart {
    /// The identity, and the machine.
    #[serde(flatten)]
    pub origin: Origin,
    /// When it started.
    pub started_at: Timestamp,
    /// The version of the program.
    pub rtf: String,
    /// The sources.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub revision: Option<Revision>,
    /// The seed of the list of episodes.
    pub seed: u64,
    /// The claimed rate, unless versions are compared.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub claim: Option<f64>,
    /// The confidence of the claim, unless the stopping rule has error rates.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub confidence: Option<f64>,
    /// When it ends.
    pub stop: StoppingRule,
    /// A hash of the parameters and constraints.
    pub space: String,
}

impl CampaignStart {
    /// Describes a campaign that starts now.
    pub fn find(loaded: &LoadedCampaign, file: &Path, working_dir: &Path) -> Self {
        let campaign = &loaded.campaign;
        let revision = RevisionQuery::start(working_dir);
        let confidence = campaign.claim().and_then(|claim| claim.confidence.as_ref());
        Self {
            origin: origin::find(),
            started_at: Timestamp::now(),
            rtf: env!("CARGO_PKG_VERSION").to_owned(),
            seed: campaign.seed,
            claim: campaign.claim().map(|claim| claim.rate),
            confidence: confidence.map(|confidence| confidence.value),
            stop: campaign.stop,
            space: space(campaign, file, &loaded.sources),
            revision: revision.finish(),
        }
    }

    /// The judge of a list of `planned` episodes. `None` if the claim is invalid.
    pub fn judge(&self, planned: usize) -> Option<Judge> {
        match self.claim {
            Some(claim) => Judge::of(claim, self.confidence, self.stop, planned),
            None => Some(Judge::of_trials(planned)),
        }
    }

    /// The confidence of the interval of the rate.
    pub fn interval_confidence(&self) -> f64 {
        match self.stop {
            StoppingRule::Sprt { alpha, .. } => 1.0 - alpha,
            _ => self.confidence.unwrap_or_default(),
        }
    }

    /// The name of the stopping rule.
    pub fn rule(&self) -> &'static str {
        match self.stop {
            StoppingRule::Fixed => "fixed",
            StoppingRule::ConfidenceSequence => "confidence-sequence",
            StoppingRule::Sprt { .. } => "sprt",
        }
    }
}

/// A hash of the parameters and constraints: rates of campaigns are comparable if it is equal.
fn space(campaign: &Campaign, file: &Path, sources: &SourceMap) -> String {
    let mut text = String::new();
    for parameter in &campaign.parameters {
        text += &parameter_text(parameter, file, sources);
        text.push('\n');
    }
    let source = sources.text(&file.to_string_lossy()).unwrap_or_default();
    for Constraint { span, .. } in &campaign.constraints {
        let require = source.get(span.range()).unwrap_or_default();
        text.extend(require.split_whitespace().flat_map(|word| [word, " "]));
        text.push('\n');
    }
    let digest = Sha256::digest(text);
    digest[..8].iter().fold(String::new(), |mut hash, byte| {
        // Writing to a string cannot fail.
        let _ = write!(hash, "{byte:02x}");
        hash
    })
}

fn parameter_text(parameter: &DeclaredParameter, file: &Path, sources: &SourceMap) -> String {
    match parameter {
        DeclaredParameter::Grid { name, values, .. } => {
            format!("{} grid {}", name.value, values.join(" "))
        }
        DeclaredParameter::File(name) => {
            let path = file.parent().unwrap_or(Path::new("")).join(&name.value);
            let rows = sources.text(&path.to_string_lossy()).map(str::to_owned);
            rows.or_else(|| std::fs::read_to_string(path).ok()).unwrap_or_default()
        }
        DeclaredParameter::Sampled { name, distribution, .. } => {
            let name = &name.value;
            match distribution {
                Distribution::Choice { values } => format!("{name} choice {}", values.join(" ")),
                Distribution::Uniform { low, high } => format!("{name} uniform {low} {high}"),
                Distribution::Normal { mean, deviation } => {
                    format!("{name} normal {mean} {deviation}")
                }
            }
        }
    }
}
