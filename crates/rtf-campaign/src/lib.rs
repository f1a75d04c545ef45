//! Campaigns: a suite that runs many times with varied parameters, and a claim about the rate of
//! passed runs. `spec/campaign.md` is the specification.
//!
//! - [`file`](mod@file): the text of a campaign file → [`Campaign`], with every problem and its position.
//! - [`episodes`]: [`Campaign`] → [`EpisodeList`], the same on every machine and in every version.
//! - [`analysis`]: where a campaign fails.
//! - [`comparison`]: which versions differ; [`results_file`]: versions that other programs ran;
//!   [`plan`](mod@plan): how many episodes a comparison needs.
//! - [`invariance`]: whether results depend on how episodes are run.
//! - [`ranges`]: the values that parameters can have.
//! - [`shrink`](mod@shrink): the smallest change from nominal parameters that fails.
//! - [`ledger`]: which episodes have results, and which are still to be run.
//! - [`judgement`]: results of episodes → a verdict, and whether the campaign may end.
//! - [`forecast`]: how many more episodes an undecided claim needs.
//!
//! This crate starts no process. It reads the CSV files that a campaign names, and writes nothing.

pub mod analysis;
mod axis;
pub mod comparison;
pub mod episodes;
pub mod file;
pub mod forecast;
pub mod invariance;
pub mod judgement;
pub mod ledger;
pub mod plan;
pub mod ranges;
pub mod results_file;
pub mod shrink;

pub use episodes::{EpisodeList, resolve};
pub use file::{Campaign, parse};
pub use judgement::{EpisodeResult, Judge, Judgement, Verdict};
pub use ledger::Ledger;
pub use plan::plan;
pub use ranges::ParameterRange;
pub use shrink::{Change, Shrunk, ShrunkChange, shrink};
