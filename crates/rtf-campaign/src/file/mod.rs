//! The campaign file: text → [`Campaign`].
//!
//! `spec/campaign.xsd` is its schema.

mod claim;
pub mod constraint;
mod parameter;
mod real;
mod root;
mod schema;
mod stop;
mod versions;

use std::time::Duration;

use rtf_model::masked;
use rtf_plan::suite::{Span, Spanned};

pub use claim::Claim;
pub use constraint::Constraint;
pub use parameter::{DeclaredParameter, Design, Distribution};
pub use root::parse;
pub use stop::StoppingRule;
pub use versions::Versions;

/// What a campaign decides.
#[derive(Clone, Debug, PartialEq)]
pub enum Goal {
    /// Whether the rate of passed episodes is high enough.
    Claim(Claim),
    /// Which versions differ.
    Versions(Versions),
}

/// The contents of a campaign file.
#[derive(Clone, Debug)]
pub struct Campaign {
    /// The position of the `<campaign>` tag.
    pub span: Span,
    /// `None` for the name of the file.
    pub name: Option<Spanned<String>>,
    /// The suite file, relative to the campaign file.
    pub suite: Spanned<String>,
    /// The description, white space folded.
    pub description: String,
    /// How many episodes, or blocks of trials; `None` for the number of combinations.
    pub episodes: Option<u32>,
    /// Selects one of the possible lists of episodes.
    pub seed: u64,
    /// How often an episode is repeated whose result is the bench's.
    pub repeats: u32,
    /// How long it may run.
    pub budget: Option<Duration>,
    /// The parameters, in order.
    pub parameters: Vec<DeclaredParameter>,
    pub constraints: Vec<Constraint>,
    pub goal: Goal,
    pub stop: StoppingRule,
}

impl Campaign {
    /// The claim, unless versions are compared.
    #[must_use]
    pub fn claim(&self) -> Option<&Claim> {
        match &self.goal {
            Goal::Claim(claim) => Some(claim),
            Goal::Versions(_) => None,
        }
    }

    /// What an episode of a list is called: `episode 7`, or `trial 7 of 40, block 4`.
    #[must_use]
    pub fn episode_label(&self, id: u64, total: usize) -> String {
        match self.versions() {
            None => format!("episode {id}"),
            Some(versions) => format!("trial {id} of {total}, block {}", versions.block(id)),
        }
    }

    /// Replaces the versions of blinded trials.
    #[must_use]
    pub fn mask(&self, text: &str) -> String {
        masked(text, &self.versions().map(Versions::masked).unwrap_or_default())
    }

    /// What its episodes are called.
    #[must_use]
    pub fn noun(&self) -> &'static str {
        if self.versions().is_some() { "trial" } else { "episode" }
    }

    /// The versions that are tried in each condition.
    #[must_use]
    pub fn versions(&self) -> Option<&Versions> {
        match &self.goal {
            Goal::Versions(versions) => Some(versions),
            Goal::Claim(_) => None,
        }
    }
}
