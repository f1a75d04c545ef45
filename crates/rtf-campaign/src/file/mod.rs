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

use std::time::Duration;

use rtf_plan::suite::{Span, Spanned};

pub use claim::Claim;
pub use constraint::Constraint;
pub use parameter::{DeclaredParameter, Design, Distribution};
pub use root::parse;
pub use stop::StoppingRule;

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
    /// How many episodes; `None` for the number of combinations.
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
    pub claim: Claim,
    pub stop: StoppingRule,
}
