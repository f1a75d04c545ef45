//! Questions to the store, and their answers. The answers serialise to the JSON of
//! `rtf history`.

#![warn(missing_docs)]

mod campaigns;
mod changes;
mod columns;
mod compare;
mod compare_side;
mod export;
mod flaky;
pub mod gate;
pub mod learned;
mod matrix;
mod recent;
mod run_info;
mod scope;
mod slow;
mod test_history;
mod trend;

pub use campaigns::{CampaignChange, CampaignSeries, EpisodeLine, RatePoint, RateSegment};
pub use changes::SeriesChange;
pub use compare::{Comparison, NumberChange, TestComparison};
pub use export::{PointLine, ResultLine};
pub use flaky::{ComparedRuns, FlakyTest, FlakyTests};
pub use matrix::{MatrixRow, VerdictMatrix, letter};
pub use recent::RecentResults;
pub use run_info::{RunCounts, RunInfo};
pub use slow::SlowTest;
pub use test_history::{TestHistory, TestResult};
pub use trend::{SeriesPoint, TestSeries};
