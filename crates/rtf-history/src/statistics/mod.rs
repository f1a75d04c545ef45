//! Statistics of series of results. Pure functions: no store, no clock, no randomness.
//!
//! Every function takes slices and returns structures. Values are in the unit of the measurement;
//! rates, sizes and p values have none.

pub mod change_points;
pub mod flips;
pub mod rate_changes;
pub mod robust;

pub use change_points::{
    Basis, ChangePoint, ChangePoints, Level, Segment, Size, find_change_points,
};
pub use flips::{Attempt, Flips, Outcome};
pub use rate_changes::{Counts, RateChange, find_rate_changes};
pub use robust::{LearnedLimits, TooFewValues, learn_limits};
pub use rtf_statistics::{Rate, rate};
